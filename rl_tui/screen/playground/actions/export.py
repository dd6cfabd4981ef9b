"""Exports of a run for other programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from rl_tui.common.errors import UserError
from rl_tui.common.files import free_name, write_new
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.edited_world import drawn_recipe
from rl_tui.runs.export.recipe_line import entries_until, recipe_line
from rl_tui.runs.library import episodes_of
from rl_tui.runs.recipe import JournalEntry, Recipe, WorldChange, begin
from rl_tui.runs.training.seeded_runs import OnProgress, no_progress
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.board.wanted import in_force
from rl_tui.screen.dialogs.export import (
    COMMAND,
    KINDS,
    PICTURE,
    POLICY,
    Q_ARRAY,
    Q_CSV,
    RETURNS,
    SCRIPT,
    CommandLine,
    Working,
    ask_new_file,
    export_choice,
    lane_shown,
)
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.world import World

Write = Callable[[Path, OnProgress], None]


class ExportActions(Subject):
    """The export of the snapshot from when the dialog was opened."""

    def why_not(self, deed: str) -> str:
        """Return why nothing can be exported."""
        return "this is a kiosk: nothing is written here" if self.screen.in_kiosk else ""

    def choose(self) -> None:
        """Ask what to export."""
        snapshot = self.snapshot
        if snapshot is not None:
            self.ask(export_choice(snapshot, self.glyphs), partial(self._export, snapshot))

    def _export(self, snapshot: Snapshot, what: str) -> None:
        try:
            if what == COMMAND:
                self._show_command(snapshot)
            elif what == SCRIPT:
                self._ask_file(snapshot, what, _of_text(script_of(snapshot)))
            else:
                writers: dict[str, Callable[[Snapshot, Path, OnProgress], None]] = {
                    Q_CSV: _write_q_csv,
                    Q_ARRAY: _write_q_array,
                    RETURNS: _write_returns,
                    POLICY: self._write_policy,
                    PICTURE: self._write_picture,
                }
                is_slow = what == RETURNS or (what in (Q_CSV, Q_ARRAY) and snapshot.agent.part is not None)
                self._ask_file(snapshot, what, partial(writers[what], snapshot), takes_time=is_slow)
        except UserError as fault:
            self._say_fault(str(fault))

    def _show_command(self, snapshot: Snapshot) -> None:
        world = _first_world(snapshot) or begin(snapshot.recipe).world
        line = recipe_line(*_run_of(snapshot), world.space.action_names)
        hint = "It trains this agent for the scenario's number of episodes."
        if step := snapshot.counters.step:
            hint = f"It repeats this run exactly, up to step {step:,}."
        self._ask_command(snapshot, line, hint)

    def _ask_command(self, snapshot: Snapshot, line: str, hint: str) -> None:
        def write(_: str) -> None:
            self._ask_file(snapshot, COMMAND, _of_text(f"{line}\n"))

        self.ask(CommandLine(line, hint), write)

    def _write_policy(self, snapshot: Snapshot, path: Path, _: OnProgress) -> None:
        from rl_tui.runs.export.tables import evaluate_line, policy_text

        line = evaluate_line(in_force(snapshot), str(path))
        write_new(path, policy_text(snapshot.world.space, snapshot.answers.drawn))
        self._ask_command(snapshot, line, "It prints the value of your drawn policy in each state.")

    def _write_picture(self, snapshot: Snapshot, path: Path, _: OnProgress) -> None:
        write_new(path, self.screen.app.export_screenshot(title="rl-tui", simplify=True))

    def _ask_file(self, snapshot: Snapshot, what: str, write: Write, *, takes_time: bool = False) -> None:
        title, _, ending = KINDS[what]

        def write_to(chosen: float | str) -> None:
            path = Path(str(chosen))
            if takes_time:
                working = Working(title, partial(write, path))
                self.screen.app.push_screen(working, partial(self._say_written, path))
            else:
                # After the dialog has closed, so that a picture does not show it
                self.screen.call_after_refresh(self._write_now, path, write)

        agent = "" if what == POLICY else f"-{snapshot.agent.algorithm}"
        name = free_name(f"{snapshot.recipe.scenario.id}{agent}", ending)
        self.ask(ask_new_file(title, name, self.glyphs), write_to)

    def _write_now(self, path: Path, write: Write) -> None:
        try:
            write(path, no_progress)
        except UserError as fault:
            self._say_fault(str(fault))
        else:
            self._say_written(path, "")

    def _say_written(self, path: Path, fault: str | None) -> None:
        if fault is None:
            self.screen.notify("Stopped: nothing was written.")
        elif fault:
            self._say_fault(fault)
        else:
            self.screen.notify(f"written: {path.absolute()}", markup=False)

    def _say_fault(self, fault: str) -> None:
        self.screen.notify(fault, severity="error", markup=False)


def _of_text(text: str) -> Write:
    return lambda path, _: write_new(path, text)


def _write_q_csv(snapshot: Snapshot, path: Path, on_progress: OnProgress) -> None:
    from rl_tui.runs.export.tables import write_q_csv

    write_q_csv(path, snapshot.world.space, *_estimates(snapshot, on_progress))


def _write_q_array(snapshot: Snapshot, path: Path, on_progress: OnProgress) -> None:
    from rl_tui.runs.export.tables import write_q_array

    write_q_array(path, snapshot.world.space, _estimates(snapshot, on_progress)[0])


def _write_returns(snapshot: Snapshot, path: Path, on_progress: OnProgress) -> None:
    from rl_tui.runs.export.tables import write_returns

    write_returns(path, *_run_of(snapshot), _first_world(snapshot), on_progress)


def script_of(snapshot: Snapshot) -> str:
    """Return the script for the current settings.

    Raises:
        UserError: There is no script for this run.
    """
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
        lane=lane_shown(snapshot),
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
