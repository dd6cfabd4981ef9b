"""Exact figures of any policy: what it earns, how long its episodes last, and whether they end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np

from rl_tui.agents.exact.backward_induction import policy_values
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.expected_visits import expected_visits
from rl_tui.agents.exact.policy_evaluation import PolicyChain, PolicyValue
from rl_tui.agents.exact.solution import NoExactAnswer
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
    expected_return: float | None
    steps: float | None
    ends: float | None


def figures(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyFigures:
    """Return what ``policy``, [P], is worth for ``gamma`` in [0, 1]."""
    chain = PolicyChain(exact_model(mdp), policy)
    value = _if_exact(lambda: chain.value(gamma))
    at_start = value.at_start if value else None
    undiscounted = value if gamma == 1.0 else None
    episode = _within_limit(mdp, policy) if mdp.time_limit else _unlimited(chain, undiscounted)
    return PolicyFigures(value.v if value else None, at_start, *episode)


def expected_return(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Return the expected undiscounted return of ``policy``, [P], from the start, within the time limit.

    Without a time limit the horizon is unlimited: None where the policy may come to a part of the world that
    it never leaves and that goes on paying, or where rounding would spoil the answer. Small worlds have it by
    machine code, quickly enough to be asked again and again while a run goes on.
    """
    if mdp.time_limit:
        return mdp.average_at_start(policy_values(mdp, policy, mdp.time_limit))
    return _if_exact(lambda: PolicyChain(exact_model(mdp), policy).value(1.0).at_start)


def chance_of_ending(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Return the probability that an episode of ``policy``, [P], ends, within the time limit if there is one.

    None where rounding would spoil the answer.
    """
    if mdp.time_limit:
        return _within_limit(mdp, policy).ends
    return _if_exact(PolicyChain(exact_model(mdp), policy).chance_of_ending)


def _within_limit(mdp: TabularMDP, policy: FloatArray) -> _Episode:
    """Return the figures of an episode that is cut short at the time limit."""
    visits = expected_visits(mdp, policy, mdp.time_limit)
    total = np.add.reduceat(mdp.probability, mdp.first_outcome[:-1])
    pairs = visits[mdp.pair_state] * policy / total
    happens = pairs[mdp.outcome_pair] * mdp.probability
    ends = float(np.dot(happens, mdp.terminated))
    steps = min(float(mdp.time_limit), float(visits.sum()))
    return _Episode(float(np.dot(happens, mdp.reward)), steps, min(1.0, ends))


def _unlimited(chain: PolicyChain, undiscounted: PolicyValue | None) -> _Episode:
    """Return the figures of an episode that goes on until it ends; ``undiscounted`` if it is at hand."""
    return _Episode(
        _if_exact(lambda: (undiscounted or chain.value(1.0)).at_start),
        _if_exact(chain.expected_length),
        _if_exact(chain.chance_of_ending),
    )


def _if_exact(answer: Callable[[], Answer]) -> Answer | None:
    try:
        return answer()
    except NoExactAnswer:
        return None
