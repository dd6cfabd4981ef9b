"""Where a learner stands, as arrays that the compiled loop moves, and why the loop returns."""

from __future__ import annotations

from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

REWARDS_KEPT: Final = 256
# In place of the pair that a person takes, where the agent chooses
NOT_FORCED: Final = -1


class Position(NamedTuple):
    """Where a learner stands, as arrays so that the kernel can move it: of one number but for two.

    ``step`` and ``episodes`` count what is done; ``state`` is where the next step starts;
    ``first_reward_episode`` is the first episode (from 1) with a non-zero reward, 0 while there is none.
    ``forced`` is the pair that a person takes in place of the agent, −1 where the agent chooses.

    What the last step's episode has brought is kept until the next step: ``rewards``, [REWARDS_KEPT], the
    last of its rewards, that of its step k (from 0) at k modulo the room for them; ``discounted``, [2], its
    discounted return so far and the discount due on the next reward.
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
    """Return where a learner stands before its first step, in ``state``."""
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
    """Add the last ``new`` rewards to the discounted return of their episode, now of ``episode_step`` steps.

    Those of an earlier episode are left out. Adding up many at once costs less than adding each as it comes.
    """
    total, discount = position.discounted[0], position.discounted[1]
    if new >= episode_step:
        total, discount = 0.0, 1.0
    for step in range(max(episode_step - new, 0), episode_step):
        total += discount * position.rewards[step % REWARDS_KEPT]
        discount *= gamma
    position.discounted[0] = total
    position.discounted[1] = discount


class EpisodeLog(NamedTuple):
    """Episodes ended since the last drain: ``finished[0]`` counts them.

    Each has its return, its length, and whether its last pair was the best arm of a bandit.
    """

    finished: IntArray
    returns: FloatArray
    lengths: IntArray
    optimal: BoolArray


def new_episode_log(episodes: int) -> EpisodeLog:
    """Return an empty log with room for ``episodes``."""
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
    """Why the loop came back."""

    DONE = 0  # the steps or episodes that were asked for
    EPISODES_FULL = 1  # the episode log is full: drain it and go on
    DIVERGED = 2  # an estimate left ±1e12 or is not a number
    ENDLESS_EPISODE = 3  # an episode went beyond 10⁷ steps
    MEMORY_FULL = 4  # an episode is longer than the algorithm can remember
    CONVERGED = 5  # a planner is done
    WORLD_FAILED = 6  # the environment that is stepped broke down
    NOTICED = 7  # something that is watched for came about in the last step


# As numbers, for compiled code
DONE: Final = Stop.DONE.value
EPISODES_FULL: Final = Stop.EPISODES_FULL.value
DIVERGED: Final = Stop.DIVERGED.value
ENDLESS_EPISODE: Final = Stop.ENDLESS_EPISODE.value
MEMORY_FULL: Final = Stop.MEMORY_FULL.value
CONVERGED: Final = Stop.CONVERGED.value
NOTICED: Final = Stop.NOTICED.value
