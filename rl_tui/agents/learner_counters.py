"""The progress of a learner in numbers, to be read between the calls that advance it."""

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


# The live counters


EPISODES_LOGGED: Final = 8192
Number = TypeVar("Number", np.float64, np.int64)


def newest(ring: npt.NDArray[Number], count: int) -> npt.NDArray[Number]:
    """Return the last of ``count`` numbers, oldest first: number k is in ``ring`` at k modulo its room."""
    room = len(ring)
    return ring[np.arange(max(0, count - room), count) % room]


class Episodes(NamedTuple):
    """Finished episodes, oldest first, [n] each: undiscounted return, length in steps, and whether the last
    pair was the best arm of a bandit.
    """

    returns: FloatArray
    lengths: IntArray
    optimal: BoolArray


class LearnerCounters:
    """The counters, the last step and the episode under way of a learner."""

    def __init__(self) -> None:
        self.algorithm: str
        """The id of the algorithm."""
        self.plans: bool
        """Whether that is a planner, which takes no steps in the world."""
        self._position = new_position(0)
        self._log = new_episode_log(EPISODES_LOGGED)
        self._record = new_record()
        self.world_since = 0
        """After how many steps the world last became another one."""

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
        """The state in which the next step starts."""
        return int(self._position.state[0])

    @property
    def episode_step(self) -> int:
        """Steps taken in the episode under way."""
        return int(self._position.episode_step[0])

    @property
    def first_reward_episode(self) -> int:
        """The first episode (from 1) with a non-zero reward, 0 while there is none."""
        return int(self._position.first_reward_episode[0])

    @property
    def last_step(self) -> LastStep | None:
        """The last step with all its numbers, None before the first in this world."""
        last = read_record(self._record)
        return None if last is None or last.step <= self.world_since else last

    @property
    def begins_episode(self) -> bool:
        """Whether an episode or a sweep has just ended, or nothing has happened yet.

        Where one was given up in the middle, none has ended.
        """
        last = read_record(self._record)
        return last is None or last.episode == self.episodes

    @property
    def counters(self) -> Counters:
        """A frozen copy of the counters, with the last step and the rewards and updates up to it."""
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
        """Return where the agent is: after an episode's last step still where that step led.

        Of a planner it is the state backed up last. Where a planner has taken over from an agent, or the
        other way round, the last step tells nothing about that.
        """
        if last is not None and self.plans:
            is_under_way = self.episode_step > 0 or self.episodes == last.episode
            return last.state if last.planned and is_under_way else self.state
        if last is None or self.episode_step > 0:
            return self.state
        return last.next_state if last.terminated or last.truncated else self.state

    def drain_episodes(self) -> Episodes:
        """Return copies of the episodes finished since the last call, and forget them."""
        count = int(self._log.finished[0])
        self._log.finished[0] = 0
        return Episodes(
            self._log.returns[:count].copy(),
            self._log.lengths[:count].copy(),
            self._log.optimal[:count].copy(),
        )
