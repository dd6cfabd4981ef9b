"""A program that is started again, because its file was saved or a person asked for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rl_tui.common.words import counted
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
