"""Where a learner stands, as arrays that the compiled loop moves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import Transition, Update
from rl_tui.agents.compiled import inlined
from rl_tui.agents.last_step import LastStep
from rl_tui.worlds.space import BoolArray, FloatArray, IntArray


class Position(NamedTuple):
    """Where a learner stands, each an array of one number so that the kernel can move it.

    ``step`` and ``episodes`` count what is done; ``state`` is where the next step starts;
    ``first_reward_episode`` is the first episode (from 1) with a non-zero reward, 0 while there is none.
    """

    step: IntArray
    episodes: IntArray
    state: IntArray
    episode_step: IntArray
    episode_return: FloatArray
    first_reward_episode: IntArray


def new_position(state: int) -> Position:
    """Return where a learner stands before its first step, in ``state``."""
    whole = (np.zeros(1, dtype=np.int64) for _ in range(5))
    step, episodes, at, episode_step, first_reward_episode = whole
    at[0] = state
    return Position(step, episodes, at, episode_step, np.zeros(1), first_reward_episode)


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
    """The last step in two arrays: the whole fields of :class:`LastStep`, [12], and the real ones, [9]."""

    whole: IntArray
    real: FloatArray


def new_record() -> LastRecord:
    """Return the record of no step."""
    return LastRecord(np.zeros(12, dtype=np.int64), np.zeros(9, dtype=np.float64))


@inlined
def record_transition(
    last: LastRecord,
    step: int,
    episode: int,
    explored: bool,
    epsilon: float,
    outcome: int,
    transition: Transition,
) -> None:
    """Note what the agent did and what the environment answered; ``outcome`` is −1 where it is not known."""
    last.whole[0] = step
    last.whole[1] = episode
    last.whole[2] = transition.state
    last.whole[3] = transition.pair
    last.whole[4] = explored
    last.whole[5] = outcome
    last.whole[6] = transition.next_state
    last.whole[7] = transition.terminated
    last.whole[8] = transition.truncated
    last.real[0] = epsilon
    last.real[1] = transition.reward


@inlined
def record_update(last: LastRecord, update: Update, gamma: float) -> None:
    """Note what was learned from it."""
    last.whole[9] = update.pair
    last.whole[10] = update.others
    last.whole[11] = update.table
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
    )
