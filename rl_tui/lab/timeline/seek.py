"""The way of a run to another step or episode."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rl_tui.lab.run.recipe import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run, RunState
    from rl_tui.lab.timeline.checkpoints import Checkpoints


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

    def best_of(self, checkpoints: Checkpoints) -> RunState | None:
        """Return the checkpoint that is nearest before the target, None for the seed."""
        if self.step is not None:
            return checkpoints.before_step(self.step)
        return checkpoints.before_episode(self.last_episode + 1)

    def is_ahead_of(self, run: Run) -> bool:
        """Return True if ``run`` stands at the target, or comes there when it advances."""
        if self.step is not None:
            return run.step <= self.step
        episodes = run.learner.episodes
        return episodes < self.last_episode or (episodes == self.last_episode and run.begins_episode)


class Seek:
    """The way of ``run``, from where it stands, to ``target``."""

    def __init__(self, run: Run, target: Target) -> None:
        self.run = run
        """The run that is brought to the target."""
        self.target = target
        """Where it is brought."""
        self.origin = run.step
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
