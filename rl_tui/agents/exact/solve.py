"""The exact answer of a world, and exact figures of any policy in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.agents.exact.backward_induction import best_values, policy_values
from rl_tui.agents.exact.ending_ties import ending_ties
from rl_tui.agents.exact.exact_model import ExactModel, exact_model
from rl_tui.agents.exact.policy_evaluation import ending_probability, evaluate, policy_value
from rl_tui.agents.exact.policy_iteration import Optimum, policy_iteration
from rl_tui.agents.exact.solution import NoExactAnswer, Solution
from rl_tui.agents.hyperparameters import Ties
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

TIE: Final = 1e-9


@dataclass(frozen=True, slots=True)
class PolicyFigures:
    """What a policy is worth from the start.

    ``value_at_start`` is discounted and of an unlimited horizon, ``expected_return`` undiscounted and within
    the time limit (of an unlimited horizon without one), ``greedy_ends`` the probability that the policy ends
    (likewise). An endless part that pays nothing adds 0; one that pays makes the value (at γ = 1) and the
    return None. So is each of the three that rounding would spoil.
    """

    value_at_start: float | None
    expected_return: float | None
    greedy_ends: float | None


def solve(mdp: TabularMDP, gamma: float) -> Solution:
    """Return the optimal values and policy of ``mdp`` for ``gamma`` in [0, 1], exact to 1e-9.

    Raises NoExactAnswer, in one line, where γ = 1 leaves no best value or γ < 1 is too near to 1 to compute
    it.
    """
    if not 0.0 <= gamma <= 1.0:
        raise ValueError(f"gamma is {gamma}; expected a number in [0, 1]")
    model = exact_model(mdp)
    optimum = policy_iteration(model, gamma)
    advantage = optimum.advantage
    best = advantage >= np.repeat(model.best(advantage), model.pairs_each) - TIE
    best[optimum.policy] = True  # where values are so large that rounding is more than that
    greedy = ending_ties(model, best) if gamma == 1.0 else best
    discounts_nothing = gamma == 1.0 or bool(mdp.terminated.all())
    return Solution(
        gamma=gamma,
        v=optimum.v[:-1].astype(np.float64),
        q=(optimum.v[model.pair_state] + advantage).astype(np.float64),
        best=best,
        greedy=greedy,
        value_at_start=mdp.average_at_start(optimum.v),
        expected_return=expected_return(mdp, uniform_over(mdp, greedy)),
        best_expected_return=_best_expected_return(model, optimum if discounts_nothing else None),
        iterations=optimum.iterations,
    )


def figures(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyFigures:
    """Return what ``policy``, [P] probabilities that sum to 1 in each state, is worth from the start."""
    model = exact_model(mdp)
    return PolicyFigures(
        value_at_start=_if_exact(lambda: policy_value(model, policy, gamma).at_start),
        expected_return=expected_return(mdp, policy),
        greedy_ends=chance_of_ending(mdp, policy),
    )


def expected_return(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Return the expected undiscounted return of ``policy``, [P], from the start, within the time limit.

    Without a time limit the horizon is unlimited: None where the policy may come to a part of the world that
    it never leaves and that goes on paying, or where rounding would spoil the answer.
    """
    if mdp.time_limit:
        return mdp.average_at_start(policy_values(mdp, policy, mdp.time_limit))
    return _if_exact(lambda: evaluate(mdp, policy, 1.0).at_start)


def chance_of_ending(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Return the probability that an episode of ``policy``, [P], ends, within the time limit if there is one.

    None where rounding would spoil the answer.
    """
    if mdp.time_limit:
        return _ends_in_time(mdp, policy)
    return _if_exact(lambda: ending_probability(exact_model(mdp), policy))


def best_expected_return(mdp: TabularMDP) -> float | None:
    """Return the expected return of the best policy that may look at the clock, within the time limit.

    Without a time limit that of the best policy that ends with probability 1; None where γ = 1 has no answer.
    """
    return _best_expected_return(exact_model(mdp), None)


def greedy_policy(space: FiniteSpace, q: FloatArray, ties: Ties) -> FloatArray:
    """Return the policy, [P], that is greedy for ``q``, [P].

    Ties are exact equality, as the agent itself compares: ``random`` picks among them uniformly, ``first``
    takes the first action.
    """
    first, count = _live_states(space)
    tied = q == np.repeat(np.maximum.reduceat(q, first), count)
    return uniform_over(space, tied) if ties == "random" else _first_of(space, tied)


def uniform_over(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    """Return the policy, [P], that picks uniformly among ``chosen`` pairs, [P], at least one a live state."""
    first, count = _live_states(space)
    share = 1.0 / np.add.reduceat(chosen, first, dtype=np.float64)
    return np.where(chosen, np.repeat(share, count), 0.0)


def _best_expected_return(model: ExactModel, undiscounted: Optimum | None) -> float | None:
    """Return :func:`best_expected_return`; ``undiscounted`` is the optimum at γ = 1 if it is at hand."""
    mdp = model.mdp
    if mdp.time_limit:
        return mdp.average_at_start(best_values(mdp, 1.0, mdp.time_limit))
    try:
        optimum = undiscounted or policy_iteration(model, 1.0)
    except NoExactAnswer:
        return None
    return mdp.average_at_start(optimum.v)


def _if_exact(answer: Callable[[], float | None]) -> float | None:
    try:
        return answer()
    except NoExactAnswer:
        return None


def _ends_in_time(mdp: TabularMDP, policy: FloatArray) -> float:
    ends = mdp.terminated.astype(np.float64)
    chance = mdp.average_at_start(policy_values(mdp, policy, mdp.time_limit, ends))
    return min(1.0, max(0.0, chance))


def _first_of(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    first, count = _live_states(space)
    before: IntArray = np.cumsum(chosen) - chosen
    return np.where(chosen & (before == np.repeat(before[first], count)), 1.0, 0.0)


def _live_states(space: FiniteSpace) -> tuple[IntArray, IntArray]:
    """Return the first pair of every state that owns any, and how many it owns."""
    count = np.diff(space.first_pair)
    live = count > 0
    return space.first_pair[:-1][live], count[live]
