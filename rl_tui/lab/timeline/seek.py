"""The way of a run to another moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rl_tui.lab.run.run import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run, RunState
    from rl_tui.lab.timeline.checkpoints import Checkpoints


@dataclass(frozen=True, slots=True)
class Goal:
    """A moment of the branch with number ``branch``: after ``step`` steps, or where ``episode`` begins."""

    branch: int
    step: int | None = None
    episode: int | None = None

    def start_in(self, checkpoints: Checkpoints) -> RunState | None:
        """Return the best of ``checkpoints`` to set out from, None for the seed."""
        if self.step is not None:
            return checkpoints.before_step(self.step)
        return checkpoints.before_episode(self.episode or 1)

    def is_ahead_of(self, run: Run) -> bool:
        """Tell whether ``run`` comes there, or stands there, if it goes on."""
        if self.step is not None:
            return run.step <= self.step
        finished = (self.episode or 1) - 1
        episodes = run.learner.episodes
        return episodes < finished or (episodes == finished and run.begins_episode)


class Journey:
    """``run`` on its way to ``goal``, at most to step ``end``."""

    def __init__(self, run: Run, goal: Goal, end: int) -> None:
        self.run = run
        self.goal = goal
        self.origin = run.step
        self._end = end if goal.step is None else min(goal.step, end)

    @property
    def last_step(self) -> int:
        """The step it goes to at most."""
        return self._end

    @property
    def last_episode(self) -> int:
        """How many episodes are finished at the goal."""
        return UNLIMITED if self.goal.episode is None else self.goal.episode - 1

    @property
    def done(self) -> bool:
        """Whether it is there, or can go no further."""
        return self.run.step >= self._end or self.run.learner.episodes >= self.last_episode

    @property
    def progress(self) -> tuple[int, int]:
        """How many steps are done, and of how many."""
        return self.run.step - self.origin, self._end - self.origin
