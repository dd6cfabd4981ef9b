"""The questions and messages of an export."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import ClassVar, Final

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.widgets import Static

from rl_tui.common.errors import UserError
from rl_tui.common.files import new_path
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.training.seeded_runs import OnProgress
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.theme.glyphs import Glyphs

COMMAND, SCRIPT, Q_CSV, Q_ARRAY, RETURNS, PICTURE = "command", "script", "q-csv", "q-npy", "returns", "svg"
POLICY: Final = "policy"
_SECRET: Final = "Careful: the file reveals the true means of the arms."
KINDS: Final = {
    COMMAND: ("Command", "The rl-tui train command that repeats this run, to copy.", ".txt"),
    SCRIPT: ("Python script", "A plain program with Gymnasium and NumPy only, to read and change.", ".py"),
    Q_CSV: ("Q-table as CSV", "A row for each state, a column for each action, and their visits.", "-q.csv"),
    Q_ARRAY: (
        *("Q-table as .npy", "The same for NumPy: states × actions, NaN where an action is not available."),
        "-q.npy",
    ),
    RETURNS: (
        *("Returns as CSV", "Undiscounted return and length of every episode. The run is repeated for it."),
        "-returns.csv",
    ),
    POLICY: (
        *("Drawn policy as JSON", "The policy you drew, for rl-tui evaluate. The command is shown."),
        "-policy.json",
    ),
    PICTURE: ("Screen as SVG", "A picture of the screen, without this window.", ".svg"),
}
"""Per kind: its name, a sentence, and the end of file names."""
_LOOKS_AT_PROGRESS: Final = 0.1


def lane_shown(snapshot: Snapshot) -> str:
    """Return the shown run: ``1 of 2`` or ""."""
    group = snapshot.run_group
    return f"{group.shown + 1} of {len(group.lanes)}" if group.lanes else ""


def export_choice(snapshot: Snapshot, glyphs: Glyphs) -> Choice:
    """Return the kinds of export."""
    lane, timeline, row = lane_shown(snapshot), snapshot.timeline, snapshot.agent.row
    branch = timeline.current.name if len(timeline.branches) > 1 else ""
    only = " and ".join(filter(None, (lane and f"run {lane}", branch)))
    run = f"Only {only} is exported." if only else ""
    left_out = {
        RETURNS: f"{counted(snapshot.counters.episodes, 'episode')}. The unfinished episode is left out.",
        Q_ARRAY: "Visits are left out.",
        SCRIPT: _SECRET if snapshot.world.is_bandit else "",
    }
    refused = {}
    if not len(snapshot.results.curve.episode):
        refused[RETURNS] = f"{row.name} plays no episodes" if row.planner else "no episode has finished yet"
    candidates = []
    for what, (name, sentence, _) in KINDS.items():
        if what != POLICY or snapshot.answers.drawn.choices:
            about = filter(None, (sentence, left_out.get(what), "" if what == PICTURE else run))
            candidates.append(Candidate(what, name, tuple(about), refused.get(what, "")))
    return Choice(f"Export · run {lane}" if lane else "Export", candidates, "", glyphs)


def ask_new_file(title: str, name: str, glyphs: Glyphs) -> Prompt:
    """Ask for a new file, proposing ``name``."""
    hint = "The name of a new file, in this folder unless you name another."
    return Prompt(glyphs.spelled(title), hint, name, lambda text: str(new_path(text)), "write")


class CommandLine(Dialog[str]):
    """A command to copy. The answer is the command if a file is wanted."""

    CSS = """
    #command { height: auto; max-height: 60vh; }
    #command Static { height: auto; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "c", "copy", "copy", id="copy_command", tooltip="Copy the command, if the terminal allows it."
        ),
        Binding("w,enter", "write", "write", id="write_command", tooltip="Write the command to a file."),
    ]

    def __init__(self, line: str, hint: str) -> None:
        super().__init__()
        self._line = line
        self._hint = hint

    def compose(self) -> ComposeResult:
        """Yield command and hint."""
        with self.box("Command", "c: copy   w: write to a file   esc: close"):
            with VerticalScroll(id="command"):
                yield Static(Text(self._line, overflow="fold"), markup=False)
            yield Static(self._hint, classes="hint", markup=False)

    def on_mount(self) -> None:
        """Focus the command to scroll it."""
        self.query_one("#command").focus()

    def action_copy(self) -> None:
        """Copy through the terminal (OSC 52), which may forbid it."""
        self.app.copy_to_clipboard(self._line)
        self.notify("Copied. If you cannot paste, press w to write a file.")

    def action_write(self) -> None:
        """Answer the command, to be written."""
        self.dismiss(self._line)


class BrokenOffError(Exception):
    """The result is not needed any more."""


Work = Callable[[OnProgress], None]


class Working(Dialog[str]):
    """Work in a thread. Escape cancels it.

    The answer is an error message, empty after success. ``work`` must often call its argument, which raises
    after cancelling.
    """

    def __init__(self, title: str, work: Work) -> None:
        super().__init__()
        self._title = title
        self._job = work
        self._progress = (0, 0)
        self._unwanted = False

    def compose(self) -> ComposeResult:
        """Yield the progress."""
        with self.box(self._title, "esc: cancel"):
            yield Static("0 %", id="progress", markup=False)

    def on_mount(self) -> None:
        """Start the work and show its progress."""
        self.set_interval(_LOOKS_AT_PROGRESS, self._show)
        self.run_worker(self._work(), name="export")

    def on_unmount(self) -> None:
        """Cancel the work."""
        self._unwanted = True

    async def _work(self) -> None:
        fault = ""
        try:
            await asyncio.to_thread(self._job, self._note)
        except BrokenOffError:
            return
        except UserError as error:
            fault = str(error)
        if self.is_attached and not self._unwanted:
            self.dismiss(fault)

    def _note(self, done: int, wanted: int) -> None:
        self._progress = (done, wanted)
        if self._unwanted:
            raise BrokenOffError

    def _show(self) -> None:
        done, wanted = self._progress
        self.query_one("#progress", Static).update(f"{done / max(wanted, 1):.0%} of {wanted:,} steps")
