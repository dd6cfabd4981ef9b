"""The way of a run to another step or episode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rl_tui.runs.recipe import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.runs.run import Run


class Target:
    """A place on a branch: the state after ``step`` steps, or where ``episode`` (from 1) begins.

    ``branch`` is the number of the branch, and ``end`` how far it has come: no target lies further.
    """

    def __init__(self, branch: int, end: int, *, step: int | None = None, episode: int | None = None) -> None:
        self.branch = branch
        """The number of the branch."""
        self.step = None if step is None else max(0, min(step, end))
        """How many steps were taken there; None where it is the beginning of an episode."""
        self.last_step = end if self.step is None else self.step
        """The step at which a seek ends at the latest."""
        self.last_episode = UNLIMITED if episode is None else max(0, episode - 1)
        """How many episodes are finished there."""

    def is_ahead_of(self, step: int, episodes: int, begins_episode: bool) -> bool:
        """Return True if a run that stands there is at the target, or comes there when it advances."""
        if self.step is not None:
            return step <= self.step
        return episodes < self.last_episode or (episodes == self.last_episode and begins_episode)


@dataclass(frozen=True, slots=True, eq=False)
class Seek:
    """The way of a run to another place."""

    run: Run
    """The run that is brought to the target."""
    target: Target
    """Where it is brought."""
    origin: int
    """The step from which it started."""

    @property
    def done(self) -> bool:
        """Whether the run has reached the target, or the end of the branch."""
        run, target = self.run, self.target
        return run.step >= target.last_step or run.learner.episodes >= target.last_episode

    @property
    def progress(self) -> tuple[int, int]:
        """How many steps are done, and of how many at most."""
        return self.run.step - self.origin, self.target.last_step - self.origin
