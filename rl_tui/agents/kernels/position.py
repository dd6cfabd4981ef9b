"""The position of a learner in arrays, and the reasons to stop."""

from __future__ import annotations

from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

REWARDS_KEPT: Final = 256
# No pair is forced: the agent chooses
NOT_FORCED: Final = -1


class Position(NamedTuple):
    """The position of a learner. Arrays of one element let kernels change them.

    Args:
        state: Start of the next step.
        first_reward_episode: From 1; 0 before a non-zero reward.
        forced: Pair that a person takes, or −1.
        rewards: Rewards of the last step's episode, [REWARDS_KEPT]: step k (from 0) is at k modulo the size.
        discounted: Discounted return of that episode so far, and the discount of its next reward, [2].
    """

    step: IntArray
    episodes: IntArray
    state: IntArray
    episode_step: IntArray
    episode_return: FloatArray
    first_reward_episode: IntArray
    forced: IntArray
    rewards: FloatArray
    discounted: FloatArray


def new_position(state: int) -> Position:
    """Return the position before the first step."""
    step, episodes, at, episode_step, first_reward_episode, forced = (
        np.full(1, number, dtype=np.int64) for number in (0, 0, state, 0, 0, NOT_FORCED)
    )
    return Position(
        step,
        episodes,
        at,
        episode_step,
        np.zeros(1),
        first_reward_episode,
        forced,
        np.zeros(REWARDS_KEPT),
        np.zeros(2),
    )


@compiled
def discount_rewards(position: Position, gamma: float, new: int, episode_step: int) -> None:
    """Add the last `new` rewards to the discounted return of this episode, all at once for speed."""
    total, discount = position.discounted[0], position.discounted[1]
    if new >= episode_step:
        total, discount = 0.0, 1.0
    for step in range(max(episode_step - new, 0), episode_step):
        total += discount * position.rewards[step % REWARDS_KEPT]
        discount *= gamma
    position.discounted[0] = total
    position.discounted[1] = discount


class EpisodeLog(NamedTuple):
    """Episodes finished since the last drain; ``finished[0]`` counts them.

    Each has a return, a length, and whether its last pair was the best arm of a bandit.
    """

    finished: IntArray
    returns: FloatArray
    lengths: IntArray
    optimal: BoolArray


def new_episode_log(episodes: int) -> EpisodeLog:
    """Return an empty log with room for `episodes`."""
    return EpisodeLog(
        np.zeros(1, dtype=np.int64),
        np.zeros(episodes, dtype=np.float64),
        np.zeros(episodes, dtype=np.int64),
        np.zeros(episodes, dtype=np.bool_),
    )


# Why the loop returns


LARGEST_ESTIMATE: Final = 1e12
LONGEST_EPISODE: Final = 10_000_000


class Stop(IntEnum):
    """Reason why the loop stopped."""

    DONE = 0  # requested steps or episodes are done
    EPISODES_FULL = 1  # the episode log is full: drain it and continue
    DIVERGED = 2  # an estimate left ±1e12 or is NaN
    ENDLESS_EPISODE = 3  # an episode exceeded 10⁷ steps
    MEMORY_FULL = 4  # an episode exceeds the algorithm's memory
    CONVERGED = 5  # a planner is finished
    WORLD_FAILED = 6  # the simulated environment failed
    NOTICED = 7  # a watched event happened in the last step


# As numbers, for compiled code
DONE: Final = Stop.DONE.value
EPISODES_FULL: Final = Stop.EPISODES_FULL.value
DIVERGED: Final = Stop.DIVERGED.value
ENDLESS_EPISODE: Final = Stop.ENDLESS_EPISODE.value
MEMORY_FULL: Final = Stop.MEMORY_FULL.value
CONVERGED: Final = Stop.CONVERGED.value
NOTICED: Final = Stop.NOTICED.value
