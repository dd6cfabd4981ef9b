"""Where a learner stands, as arrays that the compiled loop moves."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import Experience, Update
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.last_step import LastStep
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


class LastRecord(NamedTuple):
    """The last step in two arrays: the whole fields of :class:`LastStep`, [15], and the real ones, [9]."""

    whole: IntArray
    real: FloatArray


def new_record() -> LastRecord:
    """Return the record of no step."""
    return LastRecord(np.zeros(15, dtype=np.int64), np.zeros(9, dtype=np.float64))


@compiled
def record_experience(
    last: LastRecord,
    step: int,
    episode: int,
    episode_step: int,
    by_hand: bool,
    explored: bool,
    epsilon: float,
    outcome: int,
    experience: Experience,
) -> None:
    """Record one step in the environment; ``outcome`` is −1 where it is not known.

    It is called and not inlined, so that all loops share one.
    """
    last.whole[0] = step
    last.whole[1] = episode
    last.whole[2] = experience.state
    last.whole[3] = experience.pair
    last.whole[4] = explored
    last.whole[5] = outcome
    last.whole[6] = experience.next_state
    last.whole[7] = experience.terminated
    last.whole[8] = experience.truncated
    last.whole[12] = episode_step
    last.whole[13] = by_hand
    last.real[0] = epsilon
    last.real[1] = experience.reward


@compiled
def record_update(last: LastRecord, update: Update, gamma: float) -> None:
    """Record what was learned from it."""
    last.whole[9] = update.pair
    last.whole[10] = update.others
    last.whole[11] = update.table
    last.whole[14] = update.bootstrap_state
    last.real[2] = update.before
    last.real[3] = update.step_size
    last.real[4] = gamma
    last.real[5] = update.gathered
    last.real[6] = update.discount
    last.real[7] = update.bootstrap
    last.real[8] = update.after


def read_record(last: LastRecord) -> LastStep | None:
    """Return the recorded step, None before the first."""
    whole, real = last.whole.tolist(), last.real.tolist()
    step, episode, state, pair, explored, outcome, next_state, terminated, truncated = whole[:9]
    if step == 0:
        return None
    return LastStep(
        step=step,
        episode=episode,
        state=state,
        pair=pair,
        explored=bool(explored),
        epsilon=real[0],
        outcome=outcome,
        reward=real[1],
        next_state=next_state,
        terminated=bool(terminated),
        truncated=bool(truncated),
        updated_pair=whole[9],
        others=whole[10],
        table=whole[11],
        before=real[2],
        step_size=real[3],
        gamma=real[4],
        gathered=real[5],
        discount=real[6],
        bootstrap=real[7],
        after=real[8],
        episode_step=whole[12],
        by_hand=bool(whole[13]),
        bootstrap_state=whole[14],
    )
