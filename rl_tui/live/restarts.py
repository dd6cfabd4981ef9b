"""Restarts of a watched program, on request or after a save."""

from __future__ import annotations

from collections.abc import Callable

from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.programs.watched.program_history import ProgramHistory
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import ProgramFile, WatchedProgram


class Reload:
    """A restart. Raises UserError without a process.

    After the file `is_saved`, the results are to be compared with those of `before`.
    """

    def __init__(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool) -> None:
        self.is_saved = is_saved
        self.is_watched = False
        """True once it has replaced the previous run."""
        self.program = WatchedProgram(request)
        """The new process."""
        results = before.newest.results
        self._step, self._episodes = before.newest.step, before.newest.episodes
        self._return = results.greedy_return
        self._mean = results.return_last_100

    def is_ready(self) -> bool:
        """Return True when ready for the first step. Raises UserError if it failed."""
        self.program.listen()
        self.program.check()
        is_there = bool(self.program.log.environments) and self.program.is_settled
        return is_there and self.program.world is not None  # a world that is too large is refused here

    def compared(self, now: ProgramHistory, *, is_over: bool) -> str:
        """Compare the results with the previous run, or return "" until it is as long.

        Both are compared after equally many episodes, because a better agent takes fewer steps, or steps if
        no episode had ended.
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
            return f"restarted from its seed: {where}{mine} there is nothing to compare"
        word = "better than" if after > then else "worse than" if after < then else "the same as"
        return f"{where}, {word} before: {which} is {after:.4g}{mine}; it was {then:.4g}{before}"


class Restarts:
    """Restarts the program in `file`, and calls `go_over_to` when ready."""

    def __init__(self, file: ProgramFile, go_over_to: Callable[[WatchedProgram], None]) -> None:
        self.file = file
        """File of the program."""
        self.words = ""
        """Result of the last save, usually empty."""
        self._go_over_to = go_over_to
        self.newest: Reload | None = None
        """The last restart, until it is shown and compared."""

    @property
    def is_awaited(self) -> bool:
        """True while a restart is not ready."""
        newest = self.newest
        return newest is not None and not (newest.is_watched or newest.is_saved)

    def begin(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool = False) -> None:
        """Restart after the run `before`. Raises UserError without a process."""
        self.close()
        self.newest = Reload(request, before, is_saved=is_saved)

    def wait(self) -> None:
        """Wait until the restart has replaced the run."""
        try:
            if self.newest is not None:
                self.newest.program.wait_for_environment()
        except UserError as fault:
            self._give_up(fault)
        self.look()

    def look_at_file(self, request: ProgramRequest, before: ProgramHistory) -> bool:
        """Restart if the file was saved. Return True for news."""
        if not self.file.was_saved():
            return False
        fault = self.file.fault()
        try:
            if not fault:
                self.begin(request, before, is_saved=True)
                self.words = "saved: it restarts, and appears when it has created its environment"
        except UserError as error:
            fault = str(error)
        if fault:
            self.words = f"not restarted: {fault}"
        return True

    def look(self) -> bool:
        """Switch to the restarted program once ready. Return True for news."""
        newest = self.newest
        if newest is None or newest.is_watched:
            return False
        try:
            if not newest.is_ready():
                return False
        except UserError as fault:
            self._give_up(fault)
            return True
        self.file.read_again()
        self.words = "restarted from its seed" if newest.is_saved else ""
        self.newest = newest if newest.is_saved else None
        newest.is_watched = True
        self._go_over_to(newest.program)
        return True

    def compare(self, now: ProgramHistory, *, is_over: bool) -> bool:
        """Return True once the new run is as long and compared."""
        newest = self.newest
        words = newest.compared(now, is_over=is_over) if newest is not None and newest.is_watched else ""
        if words:
            self.words, self.newest = words, None
        return bool(words)

    def close(self) -> None:
        """End a program that is not shown yet."""
        if self.newest is not None and not self.newest.is_watched:
            self.newest.program.end()
        self.newest = None

    def _give_up(self, fault: UserError) -> None:
        self.close()
        self.words = str(fault)
