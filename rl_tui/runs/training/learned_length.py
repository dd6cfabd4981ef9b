"""How long episodes last once an agent has learned: exactly, by linear algebra."""

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
"""What is worth less than the best action by no more than this is as good."""
_SURE: Final = 1.0 - 1e-9


def learned_length(mdp: TabularMDP, gamma: float, planned: float, epsilon: float) -> float:
    """Return the mean number of steps of an episode once values are learned; infinite if it may never end.

    They are those of the best policy that takes a uniformly random action ``planned`` of the time: 0 is what
    Q-learning comes to, ``epsilon`` what SARSA does. Then ``epsilon`` of the time a random action is taken,
    else one of the best, each as likely. Both are in [0, 1]. No time limit counts. Infinite too where it is
    so long that rounding spoils it; 0 where nothing is known, since values do not exist.
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
    """Return which pairs, [P], are as good as the best under a policy that explores so often.

    It is policy iteration among the ε-soft policies (Sutton & Barto, 2nd ed., section 5.4). Raises
    NoExactAnswer where a policy on the way has no value.
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
    """Return the policy, [P], that picks among ``best``, and among all pairs ``epsilon`` of the time."""
    return softened(model.mdp, uniform_over(model.mdp, best), epsilon)
