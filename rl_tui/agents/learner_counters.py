"""The progress of a learner in numbers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from rl_tui.agents.kernels.after_update import new_record, read_record
from rl_tui.agents.kernels.position import new_episode_log, new_position
from rl_tui.agents.last_step import LastStep
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# A frozen copy


@dataclass(frozen=True, slots=True, eq=False)
class Counters:
    """Progress of a learner, and the episode of its last step (for a planner, the sweep)."""

    state: int
    """Current state; for a planner, the state backed up last. After an episode it is its final state, unless
    the next start is shown.
    """
    step_from: int | None = None
    """Start of the next step, which differs after the end of an episode. None without a learner."""
    step: int = 0
    """Steps taken."""
    episodes: int = 0
    """Finished episodes."""
    episode_step: int = 0
    """Steps of the current episode; 0 just after an end."""
    episode_return: float = 0.0
    """Undiscounted return of the current episode so far."""
    rewards: FloatArray = field(default_factory=lambda: np.empty(0))
    """Rewards of the last step's episode, oldest first, at most 256, [N]. Empty for a planner."""
    discounted_return: float = 0.0
    """Σ γᵏ r of the last step's episode, with the γ of each step; 0 for a planner."""
    td_errors: FloatArray = field(default_factory=lambda: np.empty(0))
    """TD errors of recent updates, oldest first, at most 256, [U]. A step contributes at most the one update
    in :class:`LastStep`.
    """
    updated_pairs: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    """Pairs of these updates, [U]."""
    last_step: LastStep | None = None
    """The last step with all its numbers, or None before the first."""
    is_at_beginning: bool = False
    """True if `state` is the start of the next episode, after an end."""

    @property
    def has_just_ended(self) -> bool:
        """True if the last step ended its episode or sweep (not if abandoned)."""
        last = self.last_step
        return last is not None and last.episode == self.episodes and not self.episode_step

    def at_beginning(self) -> Counters:
        """Return a copy at the next start, if an episode has just ended."""
        if self.step_from is None or not self.has_just_ended:
            return self
        return replace(self, state=self.step_from, is_at_beginning=True)


# The live counters


EPISODES_LOGGED: Final = 8192
Number = TypeVar("Number", np.float64, np.int64)


def newest(ring: npt.NDArray[Number], count: int) -> npt.NDArray[Number]:
    """Return the last of `count` numbers from the ring buffer, oldest first."""
    room = len(ring)
    return ring[np.arange(max(0, count - room), count) % room]


class Episodes(NamedTuple):
    """Finished episodes, oldest first, [n] each: undiscounted return, steps, and if the last pair was the
    best arm.
    """

    returns: FloatArray
    lengths: IntArray
    optimal: BoolArray


class LearnerCounters:
    """Counters, last step and current episode."""

    def __init__(self) -> None:
        self.algorithm: str
        """Id of the algorithm."""
        self.plans: bool
        """True for a planner, which takes no steps in the world."""
        self._position = new_position(0)
        self._log = new_episode_log(EPISODES_LOGGED)
        self._record = new_record()
        self.world_since = 0
        """Number of steps at the last change of the world."""

    @property
    def step(self) -> int:
        """Steps taken."""
        return int(self._position.step[0])

    @property
    def episodes(self) -> int:
        """Finished episodes."""
        return int(self._position.episodes[0])

    @property
    def state(self) -> int:
        """Start of the next step."""
        return int(self._position.state[0])

    @property
    def episode_step(self) -> int:
        """Steps of the current episode."""
        return int(self._position.episode_step[0])

    @property
    def first_reward_episode(self) -> int:
        """First episode (from 1) with a non-zero reward, or 0."""
        return int(self._position.first_reward_episode[0])

    @property
    def last_step(self) -> LastStep | None:
        """The last step, or None before the first in this world."""
        last = read_record(self._record)
        return None if last is None or last.step <= self.world_since else last

    @property
    def begins_episode(self) -> bool:
        """True before the first step, and after the end of an episode or sweep (not if abandoned)."""
        last = read_record(self._record)
        return last is None or last.episode == self.episodes

    @property
    def counters(self) -> Counters:
        """A frozen copy."""
        position, record, last = self._position, self._record, self.last_step
        rewards = 0 if last is None or last.planned or self.plans else last.episode_step
        updates = int(record.updates[0])
        return Counters(
            state=self._shown_state(last),
            step_from=self.state,
            step=self.step,
            episodes=self.episodes,
            episode_step=self.episode_step,
            episode_return=float(position.episode_return[0]),
            rewards=newest(position.rewards, rewards),
            discounted_return=float(position.discounted[0]) if rewards else 0.0,
            td_errors=newest(record.td_errors, updates),
            updated_pairs=newest(record.pairs, updates),
            last_step=last,
        )

    def _shown_state(self, last: LastStep | None) -> int:
        if last is not None and self.plans:
            is_under_way = self.episode_step > 0 or self.episodes == last.episode
            return last.state if last.planned and is_under_way else self.state
        if last is None or self.episode_step > 0:
            return self.state
        return last.next_state if last.terminated or last.truncated else self.state

    def drain_episodes(self) -> Episodes:
        """Return the episodes finished since the last call, and clear them."""
        count = int(self._log.finished[0])
        self._log.finished[0] = 0
        return Episodes(
            self._log.returns[:count].copy(),
            self._log.lengths[:count].copy(),
            self._log.optimal[:count].copy(),
        )
