"""Writing a run for other programs."""

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

Write = Callable[[Path], None]
SlowWrite = Callable[[Path, OnProgress], None]


class ExportActions(Subject):
    """Exporting: what is written is the moment that was shown when x was pressed."""

    def why_not(self, deed: str) -> str:
        """Return why nothing can be written."""
        return "this is a kiosk: nothing is written here" if self.screen.in_kiosk else ""

    def choose(self) -> None:
        """Choose what to write."""
        snapshot = self.snapshot
        if snapshot is None:
            return
        self.ask(export_choice(snapshot, self.glyphs), partial(self._export, snapshot))

    def _export(self, snapshot: Snapshot, what: str) -> None:
        export = {
            COMMAND: self._export_command,
            SCRIPT: self._export_script,
            Q_CSV: self._export_q_csv,
            Q_ARRAY: self._export_q_array,
            RETURNS: self._export_returns,
            POLICY: self._export_policy,
            PICTURE: self._export_picture,
        }[what]
        try:
            export(snapshot)
        except UserError as fault:
            self._say_fault(str(fault))

    def _export_command(self, snapshot: Snapshot) -> None:
        world = _first_world(snapshot) or begin(snapshot.recipe).world
        line = recipe_line(*_run_of(snapshot), world.space.action_names)
        step = snapshot.counters.step
        again = f"It does this run again, bit for bit, up to step {step:,}."
        self._ask_command(
            snapshot, line, again if step else "It trains this agent as long as the scenario says."
        )

    def _export_script(self, snapshot: Snapshot) -> None:
        self._ask_file(snapshot, "Python script", ".py", partial(write_new, text=script_of(snapshot)))

    def _export_q_csv(self, snapshot: Snapshot) -> None:
        from rl_tui.runs.export.tables import write_q_csv

        def write(path: Path, on_progress: OnProgress) -> None:
            write_q_csv(path, snapshot.world.space, *_estimates(snapshot, on_progress))

        self._export_estimates(snapshot, "Q-table as CSV", "-q.csv", write)

    def _export_q_array(self, snapshot: Snapshot) -> None:
        from rl_tui.runs.export.tables import write_q_array

        def write(path: Path, on_progress: OnProgress) -> None:
            q, _ = _estimates(snapshot, on_progress)
            write_q_array(path, snapshot.world.space, q)

        self._export_estimates(snapshot, "Q-table as .npy", "-q.npy", write)

    def _export_estimates(self, snapshot: Snapshot, title: str, ending: str, write: SlowWrite) -> None:
        if snapshot.agent.part is None:
            self._ask_file(snapshot, title, ending, lambda path: write(path, no_progress))
        else:
            self._ask_file(snapshot, title, ending, write, takes_time=True)

    def _export_returns(self, snapshot: Snapshot) -> None:
        from rl_tui.runs.export.tables import write_returns

        def write(path: Path, on_progress: OnProgress) -> None:
            write_returns(path, *_run_of(snapshot), _first_world(snapshot), on_progress)

        self._ask_file(snapshot, "Returns as CSV", "-returns.csv", write, takes_time=True)

    def _export_policy(self, snapshot: Snapshot) -> None:
        from rl_tui.runs.export.tables import evaluate_line, policy_text

        text = policy_text(snapshot.world.space, snapshot.answers.drawn)

        def write(path: Path) -> None:
            line = evaluate_line(in_force(snapshot), str(path))
            write_new(path, text)
            self._ask_command(snapshot, line, "It prints what the policy you drew is worth in each state.")

        self._ask_file(snapshot, "Drawn policy as JSON", "-policy.json", write, is_of_agent=False)

    def _ask_command(self, snapshot: Snapshot, line: str, hint: str) -> None:
        def write(_: str) -> None:
            self._ask_file(snapshot, "Command", ".txt", partial(write_new, text=f"{line}\n"))

        self.ask(CommandLine(line, hint), write)

    def _export_picture(self, snapshot: Snapshot) -> None:
        def write(path: Path) -> None:
            write_new(path, self.screen.app.export_screenshot(title="rl-tui", simplify=True))

        self._ask_file(snapshot, "Screen as SVG", ".svg", write)

    def _ask_file(
        self,
        snapshot: Snapshot,
        title: str,
        ending: str,
        write: Callable[..., None],
        *,
        takes_time: bool = False,
        is_of_agent: bool = True,
    ) -> None:
        """Ask for a new file, offering a name, and have it written: a SlowWrite where it takes time."""

        def write_to(chosen: float | str) -> None:
            path = Path(str(chosen))
            if takes_time:
                working = Working(title, partial(write, path))
                self.screen.app.push_screen(working, partial(self._say_written, path))
            else:
                # What is asked is closed by then, so that a picture does not show it
                self.screen.call_after_refresh(self._write_now, path, write)

        agent = f"-{snapshot.agent.algorithm}" if is_of_agent else ""
        name = free_name(f"{snapshot.recipe.scenario.id}{agent}", ending)
        self.ask(ask_new_file(title, name, self.glyphs), write_to)

    def _write_now(self, path: Path, write: Write) -> None:
        try:
            write(path)
        except UserError as fault:
            self._say_fault(str(fault))
        else:
            self._say_written(path, "")

    def _say_written(self, path: Path, fault: str | None) -> None:
        if fault is None:
            self.screen.notify("broken off: nothing was written")
        elif fault:
            self._say_fault(fault)
        else:
            self.screen.notify(f"written: {path.absolute()}", markup=False)

    def _say_fault(self, fault: str) -> None:
        self.screen.notify(fault, severity="error", markup=False)


def script_of(snapshot: Snapshot) -> str:
    """Return the script of what is in force; raises UserError where there can be none."""
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
    """Return Q and visits; of a large world, of which a snapshot has a part, the run is done again."""
    from rl_tui.runs.export.tables import estimates_again

    if snapshot.agent.part is None:
        return snapshot.agent.q, snapshot.agent.visits
    return estimates_again(*_run_of(snapshot), _first_world(snapshot), on_progress)
