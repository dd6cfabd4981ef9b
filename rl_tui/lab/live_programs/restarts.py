"""Starting a program again: where its file was saved, or a person asked for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rl_tui.common.errors import UserError
from rl_tui.lab.live_programs.program_file import ProgramFile
from rl_tui.lab.live_programs.reload import Reload

if TYPE_CHECKING:
    from rl_tui.lab.live_programs.history_of_program import ProgramHistory
    from rl_tui.lab.live_programs.watched_program import WatchedProgram
    from rl_tui.lab.programs.program_process import ProgramRequest


class Restarts:
    """Starts the program in ``file`` again; ``go_over_to`` is called once it stands before its first step."""

    def __init__(self, file: ProgramFile, go_over_to: Callable[[WatchedProgram], None]) -> None:
        self.file = file
        """The file of the program."""
        self.words = ""
        """What became of the last time that the file was saved; mostly empty."""
        self._go_over_to = go_over_to
        self._newest: Reload | None = None

    @property
    def is_awaited(self) -> bool:
        """Whether a person has asked for a start that is still under way."""
        newest = self._newest
        return newest is not None and not (newest.is_watched or newest.is_saved)

    def begin(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool = False) -> None:
        """Start ``request``; ``before`` is the run until now. Raises UserError where there is no process."""
        self.close()
        self._newest = Reload(request, before, is_saved=is_saved)

    def wait(self) -> None:
        """Wait until what was started has taken its place."""
        try:
            if self._newest is not None:
                self._newest.wait()
        except UserError as fault:
            self._give_up(fault)
        self.look()

    def look_at_file(self, request: ProgramRequest, before: ProgramHistory) -> bool:
        """Start ``request`` again where its file was saved; return whether there is something to tell."""
        if not self.file.was_saved():
            return False
        fault = self.file.fault()
        try:
            if not fault:
                self.begin(request, before, is_saved=True)
                self.words = "saved: it is started again, and shown once it has made its environment"
        except UserError as error:
            fault = str(error)
        if fault:
            self.words = f"not started again: {fault}"
        return True

    def look(self) -> bool:
        """Go over to what was started once it stands before its first step; return whether it is news."""
        newest = self._newest
        if newest is None or newest.is_watched:
            return False
        try:
            if not newest.is_ready():
                return False
        except UserError as fault:
            self._give_up(fault)
            return True
        self.file.read_again()
        self.words = "started again from its seed" if newest.is_saved else ""
        self._newest = newest if newest.is_saved else None
        self._go_over_to(newest.taken())
        return True

    def compare(self, now: ProgramHistory, *, is_over: bool) -> bool:
        """Say what became better, once it has come as far as before; return whether it has just done so."""
        newest = self._newest
        words = newest.compared(now, is_over=is_over) if newest is not None and newest.is_watched else ""
        if words:
            self.words, self._newest = words, None
        return bool(words)

    def close(self) -> None:
        """End what was started and has not taken its place."""
        if self._newest is not None:
            self._newest.close()
            self._newest = None

    def _give_up(self, fault: UserError) -> None:
        self.close()
        self.words = str(fault)
