"""Exports of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from rl_tui.common.files import free_name, write_new
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.edited_world import drawn_recipe
from rl_tui.runs.export.recipe_line import entries_until, recipe_line
from rl_tui.runs.library import episodes_of
from rl_tui.runs.recipe import JournalEntry, Recipe, WorldChange, begin
from rl_tui.runs.training.seeded_runs import OnProgress, no_progress
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.board.wanted import in_force
from rl_tui.screen.dialogs import export
from rl_tui.screen.frame.message_line import complain, complaining
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.world import World

Write = Callable[[Path, OnProgress], None]


class ExportActions(Subject):
    """The export of the snapshot when the dialog was opened."""

    def why_not(self, deed: str) -> str:
        """Explain why nothing can be exported."""
        return "this is a kiosk: nothing is written here" if self.screen.in_kiosk else ""

    def choose(self) -> None:
        """Ask what to export."""
        snapshot = self.snapshot
        if snapshot is not None:
            self.ask(export.export_choice(snapshot, self.glyphs), partial(self._export, snapshot))

    def _export(self, snapshot: Snapshot, what: str) -> None:
        with complaining(self.screen.app):
            if what == export.COMMAND:
                self._show_command(snapshot)
            elif what == export.SCRIPT:
                self._ask_file(snapshot, what, _of_text(script_of(snapshot)))
            else:
                writers = {export.POLICY: self._write_policy, export.PICTURE: self._write_picture}
                write = partial(writers.get(what, partial(_write_table, what)), snapshot)
                is_slow = what == export.RETURNS or (
                    what in (export.Q_CSV, export.Q_ARRAY) and snapshot.agent.part is not None
                )
                self._ask_file(snapshot, what, write, takes_time=is_slow)

    def _show_command(self, snapshot: Snapshot) -> None:
        world = _first_world(snapshot) or begin(snapshot.recipe).world
        line = recipe_line(*_run_of(snapshot), world.space.action_names)
        hint = "It trains this agent for the scenario's number of episodes."
        if step := snapshot.counters.step:
            hint = f"It repeats this run exactly, up to step {step:,}."
        self._ask_command(snapshot, line, hint)

    def _ask_command(self, snapshot: Snapshot, line: str, hint: str) -> None:
        def write(_: str) -> None:
            self._ask_file(snapshot, export.COMMAND, _of_text(f"{line}\n"))

        self.ask(export.CommandLine(line, hint), write)

    def _write_policy(self, snapshot: Snapshot, path: Path, _: OnProgress) -> None:
        from rl_tui.runs.export.tables import evaluate_line, policy_text

        line = evaluate_line(in_force(snapshot), str(path))
        write_new(path, policy_text(snapshot.world.space, snapshot.answers.drawn))
        self._ask_command(snapshot, line, "It prints the value of your drawn policy in each state.")

    def _write_picture(self, snapshot: Snapshot, path: Path, _: OnProgress) -> None:
        write_new(path, self.screen.app.export_screenshot(title="rl-tui", simplify=True))

    def _ask_file(self, snapshot: Snapshot, what: str, write: Write, *, takes_time: bool = False) -> None:
        title, _, ending = export.KINDS[what]

        def write_to(chosen: float | str) -> None:
            path = Path(str(chosen))
            if takes_time:
                working = export.Working(title, partial(write, path))
                self.screen.app.push_screen(working, partial(self._say_written, path))
            else:
                # After the dialog has closed, so that a picture does not show it
                self.screen.call_after_refresh(self._write_now, path, write)

        agent = "" if what == export.POLICY else f"-{snapshot.agent.algorithm}"
        name = free_name(f"{snapshot.recipe.scenario.id}{agent}", ending)
        self.ask(export.ask_new_file(title, name, self.glyphs), write_to)

    def _write_now(self, path: Path, write: Write) -> None:
        with complaining(self.screen.app):
            write(path, no_progress)
            self._say_written(path, "")

    def _say_written(self, path: Path, fault: str | None) -> None:
        if fault is None:
            self.screen.notify("Stopped: nothing was written.")
        elif fault:
            complain(self.screen.app, fault)
        else:
            self.screen.notify(f"written: {path.absolute()}", markup=False)


def _of_text(text: str) -> Write:
    return lambda path, _: write_new(path, text)


def _write_table(what: str, snapshot: Snapshot, path: Path, on_progress: OnProgress) -> None:
    from rl_tui.runs.export import tables

    if what == export.RETURNS:
        tables.write_returns(path, *_run_of(snapshot), _first_world(snapshot), on_progress)
    elif what == export.Q_ARRAY:
        tables.write_q_array(path, snapshot.world.space, _estimates(snapshot, on_progress)[0])
    else:
        tables.write_q_csv(path, snapshot.world.space, *_estimates(snapshot, on_progress))


def script_of(snapshot: Snapshot) -> str:
    """Return the script for the current settings. Raises UserError if there is none for this run."""
    from rl_tui.runs.export.script import script

    recipe, journal, step = _run_of(snapshot)
    changes = [entry.change for entry in entries_until(journal, step)]
    drawn = drawn_recipe(in_force(snapshot), [each for each in changes if isinstance(each, WorldChange)])
    return script(
        drawn,
        episodes_of(recipe.scenario),
        snapshot.world,
        changed=bool(changes),
        episodes_of_run=snapshot.counters.episodes,
        lane=export.lane_shown(snapshot),
    )


def _run_of(snapshot: Snapshot) -> tuple[Recipe, Sequence[JournalEntry], int]:
    return snapshot.recipe, snapshot.timeline.current.journal, snapshot.counters.step


def _first_world(snapshot: Snapshot) -> World | None:
    return None if snapshot.world_changes else snapshot.world


def _estimates(snapshot: Snapshot, on_progress: OnProgress) -> tuple[FloatArray, IntArray]:
    """Return Q and visits, by repeating the run of a large world."""
    from rl_tui.runs.export.tables import estimates_again

    if snapshot.agent.part is None:
        return snapshot.agent.q, snapshot.agent.visits
    return estimates_again(*_run_of(snapshot), _first_world(snapshot), on_progress)
