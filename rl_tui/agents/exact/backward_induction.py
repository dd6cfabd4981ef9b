"""Values of a finite horizon, step by step from its end (Sutton & Barto, 2nd ed., equations 4.4 and 4.10)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled_for
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, machine_code
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP, smallest_mdp

# Sweeps by whole arrays, where there is no compiler. They add in the order of the kernels, for the same bits:
# the first outcome of every pair, then the second of those that have one; likewise the pairs of every state


class Model(NamedTuple):
    """What a sweep over all states reads: the expected reward of each pair, [P], and outcomes' weights, [O].

    The ``weight`` of an outcome is that of the value of the state it leads to: 0 where the episode ends.
    """

    first_pair: IntArray
    first_outcome: IntArray
    next_state: IntArray
    pair_reward: FloatArray
    weight: FloatArray


class Rank(NamedTuple):
    """The k-th part of each owner that has so many: the owners, and their k-th parts, [n] each."""

    owners: IntArray
    parts: IntArray


Sweep = Callable[[FloatArray], FloatArray]
"""Returns the values of all states, [S], one step earlier than those it is given, [S]."""


def following(model: Model, policy: FloatArray) -> Sweep:
    """Return the sweep that follows ``policy``, [P] (equation 4.4)."""
    outcomes = list(_ranks(model.first_outcome))
    pairs = [_of_those_taken(rank, policy) for rank in _ranks(model.first_pair)]

    def sweep(later: FloatArray) -> FloatArray:
        total = _pair_values(model, outcomes, later)
        values = np.zeros(len(later))
        for owners, parts in pairs:
            values[owners] += policy[parts] * total[parts]
        return values

    return sweep


def optimising(model: Model) -> Sweep:
    """Return the sweep that takes the best pair of each state (equation 4.10)."""
    outcomes, pairs = list(_ranks(model.first_outcome)), list(_ranks(model.first_pair))

    def sweep(later: FloatArray) -> FloatArray:
        total = _pair_values(model, outcomes, later)
        values = np.zeros(len(later))
        for number, (owners, parts) in enumerate(pairs):
            better = (total[parts] > values[owners]) | (number == 0)
            values[owners[better]] = total[parts[better]]
        return values

    return sweep


def seconds_of(model: Model) -> float:
    """Return how long a sweep takes, roughly: some operations for each rank, and some for each outcome."""
    ranks = int(np.diff(model.first_outcome).max(initial=0)) + int(np.diff(model.first_pair).max(initial=0))
    return 8e-6 * ranks + 2e-8 * len(model.next_state)


def _pair_values(model: Model, outcomes: list[Rank], later: FloatArray) -> FloatArray:
    total = model.pair_reward.copy()
    for owners, parts in outcomes:
        total[owners] += model.weight[parts] * later[model.next_state[parts]]
    return total


def _of_those_taken(rank: Rank, policy: FloatArray) -> Rank:
    taken = policy[rank.parts] > 0.0
    return Rank(rank.owners[taken], rank.parts[taken])


def _ranks(first: IntArray) -> Iterator[Rank]:
    """Yield the first parts, the second ones, and so on; owner n has those ``first[n]`` .. ``first[n+1]``."""
    counts = np.diff(first)
    for number in range(int(counts.max(initial=0))):
        owners = np.flatnonzero(counts > number)
        yield Rank(owners, first[owners] + number)


# Seconds. To import numba takes half a second, and to compile a sweep two more
FIRST_LOOK: Final = 0.3
WORTH_COMPILING: Final = 3.0


def policy_values(
    mdp: TabularMDP, policy: FloatArray, steps: int, reward: FloatArray | None = None
) -> FloatArray:
    """Return the expected sum of rewards, [S], of ``policy``, [P], over at most ``steps`` steps.

    ``reward``, [O], takes the place of the world's own.
    """
    model = model_of(mdp, mdp.reward if reward is None else reward)
    return _swept(_follow, (model, policy), lambda: following(model, policy), mdp.states, steps)


def best_values(mdp: TabularMDP, gamma: float, steps: int) -> FloatArray:
    """Return the highest expected discounted sum of rewards, [S], over at most ``steps`` steps.

    It is that of the best policy that may look at the clock.
    """
    model = model_of(mdp, mdp.reward, gamma)
    return _swept(_optimise, (model,), lambda: optimising(model), mdp.states, steps)


def _swept(
    kernel: Callable[..., None],
    args: tuple[Any, ...],
    new_sweep: Callable[[], Sweep],
    states: int,
    steps: int,
) -> FloatArray:
    """Return the values, [S], after ``steps`` sweeps.

    The kernel does them where its machine code is there. Else whole arrays do, with the same bits; but after
    a while, if many are left and values still move, it is worth to have machine code.
    """
    v, later = np.zeros((2, states))
    left = steps
    if SHARED not in COMPILED_LOOPS:
        sweep, seconds = new_sweep(), seconds_of(args[0])
        while left and not (seconds * (steps - left) > FIRST_LOOK and seconds * left > WORTH_COMPILING):
            v = sweep(later)
            left -= 1
            if np.array_equal(v, later):  # what has come to rest, to the last bit, rests for ever
                return v
            later = v.copy()
    if left:
        machine_code(kernel)(*args, left, v, later)
    return v


def model_of(mdp: TabularMDP, reward: FloatArray, gamma: float = 1.0) -> Model:
    """Return what sweeps over the states of ``mdp`` read, with these rewards, [O]."""
    total = np.add.reduceat(mdp.probability, mdp.first_outcome[:-1])
    probability = mdp.probability / total[mdp.outcome_pair]
    return Model(
        mdp.first_pair,
        mdp.first_outcome,
        mdp.next_state,
        np.add.reduceat(probability * reward, mdp.first_outcome[:-1]),
        gamma * np.where(mdp.terminated, 0.0, probability),
    )


def _no_policy() -> tuple[Any, ...]:
    mdp = smallest_mdp()
    return model_of(mdp, mdp.reward), np.zeros(mdp.pairs), 0, *np.zeros((2, mdp.states))


def _no_steps() -> tuple[Any, ...]:
    mdp = smallest_mdp()
    return model_of(mdp, mdp.reward), 0, *np.zeros((2, mdp.states))


@compiled_for(_no_policy)
def _follow(
    model: Model,
    policy: FloatArray,
    steps: int,
    v: FloatArray,
    later: FloatArray,
) -> None:
    """Leave the values of ``policy``, ``steps`` steps earlier than ``later``, in ``v``, both [S]."""
    for _ in range(steps):
        moved = False
        for state in range(len(v)):
            value = 0.0
            for pair in range(model.first_pair[state], model.first_pair[state + 1]):
                if policy[pair] > 0.0:
                    total = model.pair_reward[pair]
                    for outcome in range(model.first_outcome[pair], model.first_outcome[pair + 1]):
                        total += model.weight[outcome] * later[model.next_state[outcome]]
                    value += policy[pair] * total
            v[state] = value
            moved = moved or value != later[state]
        # What has come to rest, to the last bit, rests for ever
        if not moved:
            break
        for state in range(len(v)):
            later[state] = v[state]


@compiled_for(_no_steps)
def _optimise(
    model: Model,
    steps: int,
    v: FloatArray,
    later: FloatArray,
) -> None:
    """Leave the best values, ``steps`` steps earlier than ``later``, in ``v``, both [S]."""
    for _ in range(steps):
        moved = False
        for state in range(len(v)):
            highest = 0.0
            for pair in range(model.first_pair[state], model.first_pair[state + 1]):
                total = model.pair_reward[pair]
                for outcome in range(model.first_outcome[pair], model.first_outcome[pair + 1]):
                    total += model.weight[outcome] * later[model.next_state[outcome]]
                if pair == model.first_pair[state] or total > highest:
                    highest = total
            v[state] = highest
            moved = moved or highest != later[state]
        if not moved:
            break
        for state in range(len(v)):
            later[state] = v[state]
