"""Starting a program again: where its file was saved, or a person asked for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.lab.live_programs.program_file import ProgramFile
from rl_tui.lab.live_programs.watched_program import WatchedProgram

if TYPE_CHECKING:
    from rl_tui.lab.live_programs.history_of_program import ProgramHistory
    from rl_tui.lab.programs.program_process import ProgramRequest


class Reload:
    """The program of ``request``, started again; ``before`` is what the run until now had achieved.

    ``is_saved`` says that its file was saved, so that a person wants to know what became better. Raises
    UserError where no process can be started.
    """

    def __init__(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool) -> None:
        self.is_saved = is_saved
        self.is_watched = False
        """Whether it has taken the place of the run until now."""
        self._program = WatchedProgram(request)
        results = before.newest.results
        self._step, self._episodes = before.newest.step, before.newest.episodes
        self._return = results.greedy_return
        self._mean = results.return_last_100

    def is_ready(self) -> bool:
        """Return whether it stands before its first step. Raises UserError where it came to nothing."""
        self._program.listen()
        self._program.check()
        is_there = bool(self._program.log.environments) and self._program.is_settled
        return is_there and self._program.world is not None  # a world that is too large is refused here

    def wait(self) -> None:
        """Wait until it stands there. Raises UserError where it came to nothing."""
        self._program.wait_for_environment()

    def taken(self) -> WatchedProgram:
        """Return the program, which is somebody else's from now on."""
        self.is_watched = True
        return self._program

    def compared(self, now: ProgramHistory, *, is_over: bool) -> str:
        """Return what became better or worse; empty as long as it has not come as far as before.

        That is as many episodes, since a better agent takes fewer steps; as many steps where none had ended.
        """
        newest, episodes = now.newest, self._episodes
        has_come_as_far = newest.episodes >= episodes if episodes else newest.step >= self._step
        if not self._step or not (has_come_as_far or is_over):
            return ""
        results, mine, before = newest.results, "", ""
        if has_come_as_far:
            kept = now.shown
            now.show(now.begin_of_episode(episodes + 1) if episodes else self._step)
            results, now.shown = now.shown.results, kept
            where = f"after {counted(episodes, 'episode')}" if episodes else f"at step {self._step:,}"
        else:
            where, mine = "at its end", f" after {counted(newest.episodes, 'episode')}"
            before = f" after {counted(episodes, 'episode')}" if episodes else f" at step {self._step:,}"
        which, then, after = "the greedy policy's exact return", self._return, results.greedy_return
        if then is None or after is None:
            which, then, after = "the mean of the last 100 returns", self._mean, results.return_last_100
        if then is None or after is None:
            return f"started again from its seed: {where}{mine} there is nothing to compare"
        word = "better than" if after > then else "worse than" if after < then else "the same as"
        return f"{word} before {where}: {which} is {after:.4g}{mine}, it was {then:.4g}{before}"

    def close(self) -> None:
        """End it, unless it is somebody else's by now."""
        if not self.is_watched:
            self._program.end()


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
