"""A program that is started again, because its file was saved or a person asked for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
        self._step, self._return = before.newest.step, results.greedy_return
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
        """Return what became better or worse after as many steps as before; empty before that."""
        if not self._step:
            return ""
        if now.newest.step < self._step:
            ended = f"it ended at step {now.newest.step:,}, before the step {self._step:,} to compare it at"
            return f"started again from its seed: {ended}" if is_over else ""
        moment = now.newest
        if now.newest.step > self._step:
            kept = now.shown
            now.show(self._step)
            moment, now.shown = now.shown, kept
        results = moment.results
        which, before, after = "the greedy policy's exact return", self._return, results.greedy_return
        if before is None or after is None:
            which, before, after = "the mean of the last 100 returns", self._mean, results.return_last_100
        if before is None or after is None:
            return f"started again from its seed: {self._step:,} steps, nothing to compare"
        word = "better" if after > before else "worse" if after < before else "the same"
        return f"{word} than before at step {self._step:,}: {which} is {after:.4g}, it was {before:.4g}"

    def close(self) -> None:
        """End it, unless it is somebody else's by now."""
        if not self.is_watched:
            self._program.end()
