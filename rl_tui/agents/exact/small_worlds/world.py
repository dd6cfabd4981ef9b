"""A small world as the kernels read it: live states are numbered anew, numbers may be of two doubles."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import model_of
from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray, exact_model
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_STATES: Final = 512
"""The live states that a small world has at most."""
# What a return comes to stays far from overflow, where 0 times a value would be no 0 any more
_LARGEST_RETURN: Final = 1e250
_WORLDS_KEPT: Final = 4


class UnlimitedWorld(NamedTuple):
    """What the kernels read of a world of N live states and P pairs over an unlimited horizon.

    Live state n owns the pairs ``first_pair``[n] .. ``first_pair``[n+1], and pair p the ways
    ``first_way``[p] .. ``first_way``[p+1], one for each ``target`` other than its own state; N as a target
    stands for every end. The probability of a way is ``weight`` + ``weight_rest``, the expected reward of a
    pair ``reward`` + ``reward_rest``, and ``pays`` says whether any reward of it is not 0. An episode begins
    in the live state ``start`` with the probability ``start_probability``, [K] each.
    """

    first_pair: IntArray
    first_way: IntArray
    target: IntArray
    weight: FloatArray
    weight_rest: FloatArray
    reward: FloatArray
    reward_rest: FloatArray
    pays: BoolArray
    start: IntArray
    start_probability: FloatArray


class LimitedWorld(NamedTuple):
    """What they read of it within a time limit.

    Pair p has the outcomes ``first_outcome``[p] .. ``first_outcome``[p+1] that do not end the episode, each
    with its ``landing`` and ``chance``, and the expected ``reward``: the numbers of
    :func:`~rl_tui.agents.exact.backward_induction.model_of`. The others are those of :class:`UnlimitedWorld`.
    """

    first_pair: IntArray
    first_outcome: IntArray
    landing: IntArray
    chance: FloatArray
    reward: FloatArray
    start: IntArray
    start_probability: FloatArray


class SmallWorld(NamedTuple):
    """A small world as the kernels read it."""

    unlimited: UnlimitedWorld
    limited: LimitedWorld


def small_world(mdp: TabularMDP) -> SmallWorld | None:
    """Return ``mdp`` as the kernels read it, None where it is too large for them."""
    largest = float(np.abs(mdp.reward).max()) * max(mdp.time_limit, 1)
    is_small = np.count_nonzero(np.diff(mdp.first_pair)) <= MOST_STATES and largest < _LARGEST_RETURN
    return as_small_world(mdp) if is_small else None


@lru_cache(maxsize=_WORLDS_KEPT)
def as_small_world(mdp: TabularMDP) -> SmallWorld:
    """Return ``mdp`` as the kernels read it; that of the last few is kept."""
    model = exact_model(mdp)
    number = np.full(mdp.states + 1, len(model.live))
    number[model.live] = np.arange(len(model.live))
    first_way, target, probability = _ways(model, number)
    weight, weight_rest = _two_doubles(probability)
    reward, reward_rest = _two_doubles(
        np.add.reduceat(model.probability * model.reward, mdp.first_outcome[:-1])
    )
    within_limit = model_of(mdp, mdp.reward)
    goes_on = within_limit.weight > 0.0
    first_pair = np.append(mdp.first_pair[model.live], mdp.pairs)
    start = number[mdp.start_state], mdp.start_probability
    pays = np.logical_or.reduceat(mdp.reward != 0.0, mdp.first_outcome[:-1])
    return SmallWorld(
        UnlimitedWorld(first_pair, first_way, target, weight, weight_rest, reward, reward_rest, pays, *start),
        LimitedWorld(
            first_pair,
            _offsets(model.outcome_pair[goes_on], mdp.pairs),
            number[mdp.next_state[goes_on]],
            within_limit.weight[goes_on],
            within_limit.pair_reward,
            *start,
        ),
    )


def _ways(model: ExactModel, number: IntArray) -> tuple[IntArray, IntArray, ExtendedArray]:
    """Return where the ways of each pair begin, [P+1], and the target and probability of each way.

    ``number``, [S+1], is what the states and the end are called.
    """
    source, target = number[model.pair_state[model.outcome_pair]], number[model.landing]
    width = int(number[-1]) + 1
    way = model.outcome_pair * width + target
    order = np.argsort(way, kind="stable")
    order = order[(source != target)[order]]
    way = way[order]
    first = np.flatnonzero(np.diff(way, prepend=-1))
    probability: ExtendedArray = np.zeros(0, dtype=np.longdouble)
    if len(first):
        probability = np.add.reduceat(model.probability[order], first)
    return _offsets(way[first] // width, model.mdp.pairs), way[first] % width, probability


def _offsets(owner: IntArray, owners: int) -> IntArray:
    """Return where the parts of each owner begin, [owners + 1]; ``owner``, [n], rises."""
    return np.searchsorted(owner, np.arange(owners + 1))


def _two_doubles(values: ExtendedArray) -> tuple[FloatArray, FloatArray]:
    first = values.astype(np.float64)
    return first, (values - first).astype(np.float64)
