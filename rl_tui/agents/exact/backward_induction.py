"""Values of a finite horizon, step by step from its end (Sutton & Barto, 2nd ed., equations 4.4 and 4.10)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.kernels.compiled import compiled_for
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, fastest, machine_code
from rl_tui.worlds.mdp.smallest import smallest_mdp
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Outcomes that are looked at: interpreted, some 1.2 million a second. To import numba takes half a second,
# and to compile a sweep two more
FIRST_VISITS: Final = 150_000
WORTH_READING: Final = 500_000
WORTH_COMPILING: Final = 3_000_000


class Model(NamedTuple):
    """What a sweep over all states reads: the expected reward of each pair, [P], and outcomes' weights, [O].

    The ``weight`` of an outcome is that of the value of the state it leads to: 0 where the episode ends.
    """

    first_pair: IntArray
    first_outcome: IntArray
    next_state: IntArray
    pair_reward: FloatArray
    weight: FloatArray


def policy_values(
    mdp: TabularMDP, policy: FloatArray, steps: int, reward: FloatArray | None = None
) -> FloatArray:
    """Return the expected sum of rewards, [S], of ``policy``, [P], over at most ``steps`` steps.

    ``reward``, [O], takes the place of the world's own.
    """
    return _swept(_follow, (_model(mdp, mdp.reward if reward is None else reward), policy), mdp, steps)


def best_values(mdp: TabularMDP, gamma: float, steps: int) -> FloatArray:
    """Return the highest expected discounted sum of rewards, [S], over at most ``steps`` steps.

    It is that of the best policy that may look at the clock.
    """
    return _swept(_optimise, (_model(mdp, mdp.reward, gamma),), mdp, steps)


def _swept(kernel: Callable[..., Any], args: tuple[Any, ...], mdp: TabularMDP, steps: int) -> FloatArray:
    """Return what ``kernel`` leaves in ``v`` after ``steps`` sweeps.

    Interpreted it takes the first of them. Where much is left then, and the values still move, machine code
    does the rest, with the same bits.
    """
    v, later = np.zeros((2, mdp.states))
    outcomes = len(mdp.next_state)
    first = steps if SHARED in COMPILED_LOOPS else min(steps, FIRST_VISITS // outcomes + 1)
    moves = fastest(kernel)(*args, first, v, later)
    left = steps - first
    if moves and left:
        (machine_code if _pays(left * outcomes) else fastest)(kernel)(*args, left, v, later)
    return v


def _pays(visits: int) -> bool:
    """Return whether machine code is worth what it takes to come by, for so many ``visits`` of outcomes."""
    return visits > WORTH_COMPILING or (visits > WORTH_READING and was_compiled(SHARED))


def _model(mdp: TabularMDP, reward: FloatArray, gamma: float = 1.0) -> Model:
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
    return _model(mdp, mdp.reward), np.zeros(mdp.pairs), 0, *np.zeros((2, mdp.states))


def _no_steps() -> tuple[Any, ...]:
    mdp = smallest_mdp()
    return _model(mdp, mdp.reward), 0, *np.zeros((2, mdp.states))


@compiled_for(_no_policy)
def _follow(
    model: Model,
    policy: FloatArray,
    steps: int,
    v: FloatArray,
    later: FloatArray,
) -> bool:
    """Leave the values of ``policy`` in ``v`` and return whether they moved in the last step.

    ``v`` and ``later``, both [S], come as zeros, or as a call for earlier steps has left them.
    """
    moved = False
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
    return moved


@compiled_for(_no_steps)
def _optimise(
    model: Model,
    steps: int,
    v: FloatArray,
    later: FloatArray,
) -> bool:
    """Leave the best values in ``v`` and return whether they moved in the last step, as :func:`_follow`."""
    moved = False
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
    return moved
