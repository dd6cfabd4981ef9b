"""Values of a finite horizon, step by step from its end (Sutton & Barto, 2nd ed., equations 4.4 and 4.10)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from rl_tui.agents.exact.array_sweeps import Model, Sweep, following, optimising, seconds_of
from rl_tui.agents.kernels.compiled import compiled_for
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, machine_code
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

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
