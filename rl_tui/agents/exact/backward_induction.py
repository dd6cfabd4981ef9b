"""Values over a finite horizon, computed backwards (Sutton & Barto, 2nd ed., equations 4.4 and 4.10)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled_for
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, machine_code
from rl_tui.common.packages import is_installed
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP, smallest_mdp

# Sweeps with whole arrays. They add in the order of the kernels to get the same bits: the first outcome of
# every pair, then every second one, and so on; pairs of states likewise


class Model(NamedTuple):
    """Expected reward of each pair, [P], and factor of the next value, [O]; 0 at an end."""

    first_pair: IntArray
    first_outcome: IntArray
    next_state: IntArray
    pair_reward: FloatArray
    weight: FloatArray


class Rank(NamedTuple):
    """The k-th parts of all owners that have one, [n] each."""

    owners: IntArray
    parts: IntArray


Sweep = Callable[[FloatArray], FloatArray]
"""Maps state values, [S], to the values one step earlier, [S]."""


def following(model: Model, policy: FloatArray) -> Sweep:
    """Return the sweep that follows `policy`, [P] (equation 4.4)."""
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
    """Return the sweep that takes the best pairs (equation 4.10)."""
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
    """Estimate the duration of a sweep in seconds."""
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
    counts = np.diff(first)
    for number in range(int(counts.max(initial=0))):
        owners = np.flatnonzero(counts > number)
        yield Rank(owners, first[owners] + number)


# In seconds. Importing numba takes 0.5 s, compiling a sweep 2 s more
FIRST_LOOK: Final = 0.3
WORTH_COMPILING: Final = 3.0


def policy_values(
    mdp: TabularMDP, policy: FloatArray, steps: int, reward: FloatArray | None = None
) -> FloatArray:
    """Compute the expected sum of rewards, [S], of `policy`, [P], in `steps` steps.

    `reward`, [O], replaces the world's own.
    """
    model = model_of(mdp, mdp.reward if reward is None else reward)
    return _swept(_follow, (model, policy), lambda: following(model, policy), mdp.states, steps)


def best_values(mdp: TabularMDP, gamma: float, steps: int) -> FloatArray:
    """Compute the best expected discounted sum of rewards, [S], in `steps` steps.

    The policy may depend on the remaining time.
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
    # By whole arrays, or machine code after a while, with the same bits
    v, later = np.zeros((2, states))
    left = steps
    if SHARED not in COMPILED_LOOPS:
        sweep, seconds = new_sweep(), seconds_of(args[0])
        may_compile = seconds * steps > WORTH_COMPILING and is_installed("numba")
        while left and not (
            may_compile and seconds * (steps - left) > FIRST_LOOK and seconds * left > WORTH_COMPILING
        ):
            v = sweep(later)
            left -= 1
            if np.array_equal(v, later):  # values equal to the last bit never change again
                return v
            later = v.copy()
    if left:
        machine_code(kernel)(*args, left, v, later)
    return v


def model_of(mdp: TabularMDP, reward: FloatArray, gamma: float = 1.0) -> Model:
    """Return the data for sweeps over `mdp` with rewards, [O]."""
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
    """Write the values `steps` steps before `later` to `v`, both [S]."""
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
        # Values equal to the last bit never change again
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
    """Write the best values `steps` steps before `later` to `v`, both [S]."""
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
