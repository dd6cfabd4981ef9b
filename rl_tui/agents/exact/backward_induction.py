"""Values of a finite horizon, step by step from its end (Sutton & Barto, 2nd ed., equations 4.4 and 4.10)."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def policy_values(
    mdp: TabularMDP, policy: FloatArray, steps: int, reward: FloatArray | None = None
) -> FloatArray:
    """Return the expected sum of rewards, [S], of ``policy``, [P], over at most ``steps`` steps.

    ``reward``, [O], takes the place of the world's own.
    """
    pair_reward, weight = _expectation(mdp, mdp.reward if reward is None else reward)
    v, later = np.zeros((2, mdp.states))
    _follow(mdp.first_pair, mdp.first_outcome, mdp.next_state, pair_reward, weight, policy, steps, v, later)
    return v


def best_values(mdp: TabularMDP, gamma: float, steps: int) -> FloatArray:
    """Return the highest expected discounted sum of rewards, [S], over at most ``steps`` steps.

    It is that of the best policy that may look at the clock.
    """
    pair_reward, weight = _expectation(mdp, mdp.reward)
    v, later = np.zeros((2, mdp.states))
    _optimise(mdp.first_pair, mdp.first_outcome, mdp.next_state, pair_reward, gamma * weight, steps, v, later)
    return v


def _expectation(mdp: TabularMDP, reward: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the expected reward of each pair, [P], and the weight of each outcome's next value, [O]."""
    total = np.add.reduceat(mdp.probability, mdp.first_outcome[:-1])
    probability = mdp.probability / total[mdp.outcome_pair]
    return (
        np.add.reduceat(probability * reward, mdp.first_outcome[:-1]),
        np.where(mdp.terminated, 0.0, probability),
    )


@compiled
def _follow(
    first_pair: IntArray,
    first_outcome: IntArray,
    next_state: IntArray,
    pair_reward: FloatArray,
    weight: FloatArray,
    policy: FloatArray,
    steps: int,
    v: FloatArray,
    later: FloatArray,
) -> None:
    """Leave the values of ``policy`` in ``v``; ``v`` and ``later``, both [S], come as zeros."""
    for _ in range(steps):
        moved = False
        for state in range(len(v)):
            value = 0.0
            for pair in range(first_pair[state], first_pair[state + 1]):
                if policy[pair] > 0.0:
                    total = pair_reward[pair]
                    for outcome in range(first_outcome[pair], first_outcome[pair + 1]):
                        total += weight[outcome] * later[next_state[outcome]]
                    value += policy[pair] * total
            v[state] = value
            moved = moved or value != later[state]
        # What has come to rest, to the last bit, rests for ever
        if not moved:
            break
        for state in range(len(v)):
            later[state] = v[state]


@compiled
def _optimise(
    first_pair: IntArray,
    first_outcome: IntArray,
    next_state: IntArray,
    pair_reward: FloatArray,
    weight: FloatArray,
    steps: int,
    v: FloatArray,
    later: FloatArray,
) -> None:
    """Leave the best values in ``v``; ``v`` and ``later``, both [S], come as zeros."""
    for _ in range(steps):
        moved = False
        for state in range(len(v)):
            highest = 0.0
            for pair in range(first_pair[state], first_pair[state + 1]):
                total = pair_reward[pair]
                for outcome in range(first_outcome[pair], first_outcome[pair + 1]):
                    total += weight[outcome] * later[next_state[outcome]]
                if pair == first_pair[state] or total > highest:
                    highest = total
            v[state] = highest
            moved = moved or highest != later[state]
        if not moved:
            break
        for state in range(len(v)):
            later[state] = v[state]
