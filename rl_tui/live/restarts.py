"""Starting a watched program again, on request or after its file was saved."""

from __future__ import annotations

from collections.abc import Callable

from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.programs.watched.program_history import ProgramHistory
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import ProgramFile, WatchedProgram


class Reload:
    """A restart of the program of `request`. `before` is the history of the previous run. `is_saved` is
    True if the file was saved, so that the results are to be compared.

    Raises:
        UserError: No process can be started.
    """

    def __init__(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool) -> None:
        self.is_saved = is_saved
        self.is_watched = False
        """True once it has replaced the previous run."""
        self._program = WatchedProgram(request)
        results = before.newest.results
        self._step, self._episodes = before.newest.step, before.newest.episodes
        self._return = results.greedy_return
        self._mean = results.return_last_100

    def is_ready(self) -> bool:
        """Return True if it is ready for its first step. Raises UserError if it failed."""
        self._program.listen()
        self._program.check()
        is_there = bool(self._program.log.environments) and self._program.is_settled
        return is_there and self._program.world is not None  # a world that is too large is refused here

    def wait(self) -> None:
        """Wait until it is ready. Raises UserError if it failed."""
        self._program.wait_for_environment()

    def taken(self) -> WatchedProgram:
        """Return the program, which the caller owns from now on."""
        self.is_watched = True
        return self._program

    def compared(self, now: ProgramHistory, *, is_over: bool) -> str:
        """Compare the results with the previous run, or return "" until it is as long. Both are compared
        after equally many episodes, because a better agent takes fewer steps. If no episode had ended, both
        are compared after equally many steps.
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
        return f"{word} before {where}: {which} is {after:.4g}{mine}, it was {then:.4g}{before}"

    def close(self) -> None:
        """End the program, unless the caller owns it."""
        if not self.is_watched:
            self._program.end()


class Restarts:
    """Restarts the program in `file`. `go_over_to` is called when the new one is ready."""

    def __init__(self, file: ProgramFile, go_over_to: Callable[[WatchedProgram], None]) -> None:
        self.file = file
        """File of the program."""
        self.words = ""
        """Result of the last save, usually empty."""
        self._go_over_to = go_over_to
        self._newest: Reload | None = None

    @property
    def is_awaited(self) -> bool:
        """True while a requested restart is not ready."""
        newest = self._newest
        return newest is not None and not (newest.is_watched or newest.is_saved)

    def begin(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool = False) -> None:
        """Restart with `request`. `before` is the current run. Raises UserError if no process can be
        started.
        """
        self.close()
        self._newest = Reload(request, before, is_saved=is_saved)

    def wait(self) -> None:
        """Wait until the restart has replaced the current run."""
        try:
            if self._newest is not None:
                self._newest.wait()
        except UserError as fault:
            self._give_up(fault)
        self.look()

    def look_at_file(self, request: ProgramRequest, before: ProgramHistory) -> bool:
        """Restart if the file was saved and return True if there is news."""
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
        """Switch to the restarted program once it is ready and return True if there is news."""
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
        self.words = "restarted from its seed" if newest.is_saved else ""
        self._newest = newest if newest.is_saved else None
        self._go_over_to(newest.taken())
        return True

    def compare(self, now: ProgramHistory, *, is_over: bool) -> bool:
        """Compare once the new run is as long as the old one and return True when it happens."""
        newest = self._newest
        words = newest.compared(now, is_over=is_over) if newest is not None and newest.is_watched else ""
        if words:
            self.words, self._newest = words, None
        return bool(words)

    def close(self) -> None:
        """End a program that has not replaced the current one."""
        if self._newest is not None:
            self._newest.close()
            self._newest = None

    def _give_up(self, fault: UserError) -> None:
        self.close()
        self.words = str(fault)
