"""A small world for the kernels, with renumbered states and double-doubles."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import model_of
from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray, exact_model
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_STATES: Final = 512
"""Largest number of live states in a small world."""
# returns stay far from overflow, where 0 times a value would not be 0
_LARGEST_RETURN: Final = 1e250
_WORLDS_KEPT: Final = 4


class UnlimitedWorld(NamedTuple):
    """A world of N live states and P pairs over an unlimited horizon.

    Live state n owns the pairs ``first_pair``[n] .. ``first_pair``[n+1], and pair p the ways ``first_way``[p]
    .. ``first_way``[p+1]. Each way has a `target` other than its own state (N is the end). Its probability is
    `weight` + `weight_rest`. The expected reward of a pair is `reward` + `reward_rest`, and `pays` is True if
    any reward is not 0. An episode starts in live state `start` with `start_probability`, [K] each.
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
    """The same world within a time limit.

    Pair p has the continuing outcomes ``first_outcome``[p] .. ``first_outcome``[p+1], each with `landing` and
    `chance`, and the expected `reward`, as in :func:`~rl_tui.agents.exact.backward_induction.model_of`.
    """

    first_pair: IntArray
    first_outcome: IntArray
    landing: IntArray
    chance: FloatArray
    reward: FloatArray
    start: IntArray
    start_probability: FloatArray


class SmallWorld(NamedTuple):
    """A small world in both forms."""

    unlimited: UnlimitedWorld
    limited: LimitedWorld


def small_world(mdp: TabularMDP) -> SmallWorld | None:
    """Return `mdp` for the kernels, or None if it is too large."""
    largest = float(np.abs(mdp.reward).max()) * max(mdp.time_limit, 1)
    is_small = np.count_nonzero(np.diff(mdp.first_pair)) <= MOST_STATES and largest < _LARGEST_RETURN
    return as_small_world(mdp) if is_small else None


@lru_cache(maxsize=_WORLDS_KEPT)
def as_small_world(mdp: TabularMDP) -> SmallWorld:
    """Return `mdp` for the kernels. The latest few are cached."""
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
    # The first way of each pair, [P+1], and target and probability of each way. New numbers of states and end
    # are in `number`, [S+1]
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
    # Return the start of each owner's parts. `owner`, [n], rises
    return np.searchsorted(owner, np.arange(owners + 1))


def _two_doubles(values: ExtendedArray) -> tuple[FloatArray, FloatArray]:
    first = values.astype(np.float64)
    return first, (values - first).astype(np.float64)
