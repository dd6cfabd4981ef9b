"""A frozen copy of what a learner counts, for those who must not touch the learner."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from rl_tui.agents.last_step import LastStep
from rl_tui.worlds.mdp.space import FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Counters:
    """How far a learner has come, and the episode that its last step belongs to.

    For a planner a step is the backup of one state, an episode a sweep over all of them.
    """

    state: int
    """Where the agent is, of a planner the state backed up last. After the last step of an episode it is the
    state in which the episode ended, unless the beginning of the next one is shown."""
    step_from: int | None = None
    """The state in which the next step starts: another one if an episode has ended; None: no learner yet."""
    step: int = 0
    """Steps taken."""
    episodes: int = 0
    """Finished episodes."""
    episode_step: int = 0
    """Steps taken in the episode under way; 0 when one has just ended."""
    episode_return: float = 0.0
    """Undiscounted return so far in the episode under way."""
    rewards: FloatArray = field(default_factory=lambda: np.empty(0))
    """[N], the rewards of the last step's episode, oldest first, at most the last 256; none for a planner."""
    discounted_return: float = 0.0
    """Σ γᵏ r of the last step's episode from its start, with the γ in force at each step; 0 for a planner."""
    td_errors: FloatArray = field(default_factory=lambda: np.empty(0))
    """[U], the TD errors of the last updates, oldest first, at most 256; none before the first. A step counts
    with the one update that :class:`LastStep` tells of, or with none where nothing was learned."""
    updated_pairs: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    """[U], the pairs that those updates moved."""
    last_step: LastStep | None = None
    """The last step with all its numbers; None before the first."""
    is_at_beginning: bool = False
    """Whether ``state`` is where the next episode begins, after one has ended."""

    @property
    def has_just_ended(self) -> bool:
        """Whether the last step ended its episode, or its sweep; one that was given up has not ended."""
        last = self.last_step
        return last is not None and last.episode == self.episodes and not self.episode_step

    def at_beginning(self) -> Counters:
        """Return these with the agent where the next episode begins, if one has just ended."""
        if self.step_from is None or not self.has_just_ended:
            return self
        return replace(self, state=self.step_from, is_at_beginning=True)
