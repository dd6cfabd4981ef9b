"""Exact length of episodes after learning."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray, exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain
from rl_tui.agents.exact.policy_figures import softened, uniform_over
from rl_tui.worlds.mdp.space import BoolArray, FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

_MOST_ROUNDS: Final = 100
_AS_GOOD: Final = 1e-9
"""Tolerance below the best action within which another is equally good."""
_SURE: Final = 1.0 - 1e-9


def learned_length(mdp: TabularMDP, gamma: float, planned: float, epsilon: float) -> float:
    """Compute the mean length of an episode after learning, without time limit.

    `planned` is the exploration in the values (0 for Q-learning, `epsilon` for SARSA), `epsilon` that of the
    agent. The length is infinite if an episode may never end or rounding spoils the result, 0 without values.
    """
    model = exact_model(mdp)
    try:
        best = best_actions(model, gamma, planned)
    except NoExactAnswer:
        return 0.0
    policy = _exploring(model, best, epsilon)
    chain = PolicyChain(model, policy)
    if chain.chance_of_ending() < _SURE:
        return np.inf
    can_end = (model.steps_to([model.end], policy > 0.0) >= 0) & model.is_live
    length = np.zeros(model.end + 1, dtype=np.longdouble)
    try:
        chain.solve(1.0, can_end, length, np.ones_like(model.reward))
    except NoExactAnswer:
        return np.inf
    return float(mdp.average_at_start(length))


def best_actions(model: ExactModel, gamma: float, epsilon: float) -> BoolArray:
    """Find the best actions, `[P]`, by policy iteration among ε-soft policies (section 5.4).

    Raises NoExactAnswer.
    """
    best = np.ones(model.mdp.pairs, dtype=np.bool_)
    v: ExtendedArray = np.zeros(model.end + 1, dtype=np.longdouble)
    for _ in range(_MOST_ROUNDS):
        PolicyChain(model, _exploring(model, best, epsilon)).solve(gamma, model.is_live, v)
        advantage = model.advantage(v, gamma)
        highest = np.repeat(model.best(advantage), model.pairs_each)
        before, best = best, advantage >= highest - _AS_GOOD * max(1.0, float(np.abs(v).max()))
        if np.array_equal(before, best):
            break
    return best


def _exploring(model: ExactModel, best: BoolArray, epsilon: float) -> FloatArray:
    return softened(model.mdp, uniform_over(model.mdp, best), epsilon)
