"""Exact figures of any policy: what it earns, how long its episodes last, and whether they end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple, TypeVar

import numpy as np

from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.expected_visits import expected_visits
from rl_tui.agents.exact.policies import greedy_policy
from rl_tui.agents.exact.policy_evaluation import PolicyChain
from rl_tui.agents.exact.small_worlds.many_policies import (
    ChainOf,
    ValuesOfPolicies,
    distinct_policies,
    returns_of,
    values_of,
)
from rl_tui.agents.exact.solution import NoExactAnswer, Solution
from rl_tui.agents.hyperparameters import Ties
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True, eq=False)
class PolicyFigures:
    """What a policy is worth.

    ``v``, [S], is discounted and of an unlimited horizon, NaN where there is no value (at γ = 1 only);
    ``value_at_start`` is its average at the start. The others are of an episode from the start within the
    time limit, of an unlimited horizon without one: ``expected_return``, undiscounted, ``steps``, its
    expected length, and ``ends``, the probability that it ends.

    An endless part that pays nothing adds 0 to value and return; one that pays makes the value (at γ = 1) and
    the return None. Without a time limit ``steps`` is None where the policy may never end. So is whatever
    rounding would spoil.
    """

    v: FloatArray | None
    value_at_start: float | None
    expected_return: float | None
    steps: float | None
    ends: float | None


class _Episode(NamedTuple):
    steps: float | None
    ends: float | None


@dataclass(frozen=True, slots=True, eq=False)
class BatchFigures:
    """Figures of B greedy policies and of the estimates they are from, [B] each; NaN where there is none.

    ``value_at_start`` and ``expected_return`` are those of :class:`PolicyFigures`, ``max_error`` the largest
    difference between estimates and Q*.
    """

    value_at_start: FloatArray
    expected_return: FloatArray
    max_error: FloatArray


def figures(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyFigures:
    """Return what ``policy``, [P], is worth for ``gamma`` in [0, 1]."""
    alone = policy[np.newaxis]
    chain_of = cache(_chains(mdp, alone))  # what one figure took serves the next
    values, returns = _values_and_returns(mdp, alone, gamma, chain_of)
    steps, ends = _within_limit(mdp, policy) if mdp.time_limit else _unlimited(chain_of(0))
    return PolicyFigures(
        values.v[0] if values.exact[0] else None, _if_there(values.at_start), _if_there(returns), steps, ends
    )


def batch_figures(
    mdp: TabularMDP, q: FloatArray, ties: Ties, gamma: float, optimum: Solution | None
) -> BatchFigures:
    """Return the figures of the estimates ``q``, [B, P], of B runs, and of the policies greedy for them.

    Each has the bits that :func:`figures` gives it. ``gamma`` is in [0, 1]; ``optimum`` is the exact answer
    for it, None where there is none. Equal policies are evaluated once.
    """
    distinct, place = distinct_policies(greedy_policy(mdp, q, ties))
    values, returns = _values_and_returns(mdp, distinct, gamma, _chains(mdp, distinct))
    error = np.full(len(q), np.nan) if optimum is None else np.abs(q - optimum.q).max(axis=1)
    return BatchFigures(values.at_start[place], returns[place], error)


def expected_return(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Return the expected undiscounted return of ``policy``, [P], from the start, within the time limit.

    Without a time limit the horizon is unlimited: None where the policy may come to a part of the world that
    it never leaves and that goes on paying, or where rounding would spoil the answer. Small worlds have it by
    machine code, quickly enough to be asked again and again while a run goes on.
    """
    return _if_there(expected_returns(mdp, policy[np.newaxis]))


def expected_returns(mdp: TabularMDP, policies: FloatArray) -> FloatArray:
    """Return what :func:`expected_return` gives each of ``policies``, [B, P]; [B], NaN in place of None.

    Equal policies are evaluated once.
    """
    distinct, place = distinct_policies(policies)
    return returns_of(mdp, distinct, _chains(mdp, distinct))[place]


def chance_of_ending(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Return the probability that an episode of ``policy``, [P], ends, within the time limit if there is one.

    None where rounding would spoil the answer.
    """
    if mdp.time_limit:
        return _within_limit(mdp, policy).ends
    return _if_exact(PolicyChain(exact_model(mdp), policy).chance_of_ending)


def _values_and_returns(
    mdp: TabularMDP, policies: FloatArray, gamma: float, chain_of: ChainOf
) -> tuple[ValuesOfPolicies, FloatArray]:
    """Return the values of ``policies``, [B, P], and what they earn undiscounted from the start, [B]."""
    values = values_of(mdp, policies, gamma, chain_of)
    if gamma == 1.0 and not mdp.time_limit:
        return values, values.at_start
    return values, returns_of(mdp, policies, chain_of)


def _chains(mdp: TabularMDP, policies: FloatArray) -> ChainOf:
    model = cache(exact_model)
    return lambda row: PolicyChain(model(mdp), policies[row])


def _within_limit(mdp: TabularMDP, policy: FloatArray) -> _Episode:
    """Return the figures of an episode that is cut short at the time limit."""
    visits = expected_visits(mdp, policy, mdp.time_limit)
    total = np.add.reduceat(mdp.probability, mdp.first_outcome[:-1])
    pairs = visits[mdp.pair_state] * policy / total
    ends = float(np.dot(pairs[mdp.outcome_pair] * mdp.probability, mdp.terminated))
    return _Episode(min(float(mdp.time_limit), float(visits.sum())), min(1.0, ends))


def _unlimited(chain: PolicyChain) -> _Episode:
    """Return the figures of an episode that goes on until it ends."""
    return _Episode(_if_exact(chain.expected_length), _if_exact(chain.chance_of_ending))


def _if_there(figure: FloatArray) -> float | None:
    """Return the one ``figure``, [1], None in place of NaN."""
    number = float(figure[0])
    return None if np.isnan(number) else number


def _if_exact(answer: Callable[[], Answer]) -> Answer | None:
    try:
        return answer()
    except NoExactAnswer:
        return None
