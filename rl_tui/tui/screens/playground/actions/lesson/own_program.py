"""A task that asks for a program: its beginning is written to a file, and what became of it is watched."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.lab.export.files import new_path, write_text
from rl_tui.lab.lessons.schema import Page, ProgramToWrite, is_file_name
from rl_tui.lab.live.commands import WatchProgram
from rl_tui.terminal.driver_choice import in_browser
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.dialogs.choice import Candidate, Choice
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.screens.playground.actions.subject import Subject

NOT_HERE: Final = "your own code runs neither in a kiosk nor where the program is served: . skips this page"
_CHECK, _NAME, _CLAIM = "check", "name", "claim"
_LONG: Final = 15.0  # seconds that a message stays that tells what to do


@dataclass(eq=False)
class OwnProgram(Subject):
    """What a learner does with the program that a page asks for; ``files`` are theirs, by page."""

    files: dict[str, Path] = field(default_factory=dict)

    def answer(self, page: Page, program: ProgramToWrite, claim: Callable[[], None]) -> None:
        """Begin the program of ``page``; once it is begun, choose what to do with it.

        ``claim`` says that its task cannot be done.
        """
        if self.screen.in_kiosk or in_browser():
            self.screen.tell(NOT_HERE)
            return
        path = self.files.get(page.id)
        if path is None:
            self._ask_name(page, program)
            return
        candidates = (
            Candidate(_CHECK, f"Check {path.name}", ("It is run to its end, in a process of its own.",)),
            Candidate(_NAME, "Another file", ("Write the beginning again, or take a file that is there.",)),
            Candidate(_CLAIM, "It cannot be done", ("No program passes this task.",)),
        )
        does: dict[str, Callable[[], None]] = {
            _CHECK: lambda: self._watch(path),
            _NAME: lambda: self._ask_name(page, program),
            _CLAIM: claim,
        }
        self.ask(Choice("Your program", candidates, "", self.glyphs), lambda chosen: does[chosen]())

    def _ask_name(self, page: Page, program: ProgramToWrite) -> None:
        hint = "A new file gets the beginning of the program; one that is there is taken as it is."
        prompt = Prompt("Your program", to_ascii(hint, self.glyphs), program.file, _read_name, "take")
        self.ask(prompt, lambda name: self._begin(page, program, Path(str(name))))

    def _begin(self, page: Page, program: ProgramToWrite, path: Path) -> None:
        """Write the skeleton where there is no such file; whatever is there stays as it is."""
        try:
            written = not path.exists()
            if written:
                write_text(path, program.skeleton)
        except (UserError, OSError) as fault:
            self.screen.notify(str(fault), severity="error", markup=False)
            return
        self.files[page.id] = path
        what = f"{path.name} is written" if written else f"{path.name} is there already, and stays as it is"
        how = "Edit it in another terminal, or press ctrl+z and come back with fg. Then A checks it."
        self.screen.notify(to_ascii(f"{what}. {how}", self.glyphs), timeout=_LONG, markup=False)

    def _watch(self, path: Path) -> None:
        self.link.send(WatchProgram(path))
        if not self.board.lesson.is_docked:
            self.board.lesson.reads = True


def _read_name(text: str) -> str:
    """Return the path of the program in the working folder; raises ValueError where it can be none."""
    name = text.strip()
    if not is_file_name(name):
        raise ValueError("a name such as my_agent.py: letters, digits, - and _, in this folder")
    path = Path(name).absolute()
    if path.is_file():
        return str(path)
    try:
        return str(new_path(str(path)))
    except UserError as fault:
        raise ValueError(str(fault)) from fault
