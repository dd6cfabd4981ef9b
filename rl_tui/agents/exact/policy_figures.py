"""Exact metrics of a policy, such as its return and the length of its episodes.

A policy is an array, [P]: the probability of each state–action pair, with sum 1 in every state.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Final, NamedTuple, TypeVar

import numpy as np

from rl_tui.agents.exact.backward_induction import model_of
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain, Solution
from rl_tui.agents.exact.small_worlds.many_policies import (
    ChainOf,
    ValuesOfPolicies,
    distinct_policies,
    returns_of,
    values_of,
)
from rl_tui.agents.hyperparameters import Ties
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Expected visits to each state


# Up to so many states the matrix is dense
MOST_DENSE: Final = 400

Step = Callable[[FloatArray], FloatArray]
"""From where the agent stands, [S] probabilities, to where it does a step later if the episode goes on."""


class _Entries(NamedTuple):
    """The entries of the matrix of a step: how likely it leads from ``source`` to ``target``, [n] each."""

    source: IntArray
    target: IntArray
    chance: FloatArray


def expected_visits(mdp: TabularMDP, policy: FloatArray, steps: int) -> FloatArray:
    """Return in how many of the first ``steps`` steps, on average, each state is where the agent stands, [S].

    One pass serves every sum over an episode: the average of a figure of each state, weighted so, is its
    expected sum. ``policy``, [P], is followed from the start distribution.
    """
    now = np.zeros(mdp.states)
    np.add.at(now, mdp.start_state, mdp.start_probability)
    entries = _entries(mdp, policy)
    if mdp.states > MOST_DENSE:
        return _one_by_one(_sparse(entries, mdp.states), now, steps)
    matrix = _dense(entries, mdp.states)
    if mdp.states * steps.bit_length() < steps:
        return _by_doubling(matrix, now, steps)
    return _one_by_one(matrix.dot, now, steps)


def _one_by_one(step: Step, now: FloatArray, steps: int) -> FloatArray:
    visits = np.zeros_like(now)
    for done in range(steps):
        later = step(now)
        if np.array_equal(later, now):  # what has come to rest, to the last bit, rests for ever
            return visits + (steps - done) * now
        visits += now
        now = later
    return visits


def _by_doubling(matrix: FloatArray, now: FloatArray, steps: int) -> FloatArray:
    """Return (1 + M + M² + …) x of so many terms, in twos: (1 + M) x, and from there on by steps of M²."""
    visits = np.zeros_like(now)
    while steps:
        if steps % 2:
            visits += now
            now = matrix @ now
        now = now + matrix @ now
        matrix = matrix @ matrix
        steps //= 2
    return visits


def _entries(mdp: TabularMDP, policy: FloatArray) -> _Entries:
    chance = policy[mdp.outcome_pair] * model_of(mdp, mdp.reward).weight
    goes_on = np.flatnonzero(chance)
    source = mdp.pair_state[mdp.outcome_pair[goes_on]]
    return _Entries(source, mdp.next_state[goes_on], chance[goes_on])


def _dense(entries: _Entries, size: int) -> FloatArray:
    places = entries.target * size + entries.source
    matrix = np.bincount(places, weights=entries.chance, minlength=size * size)
    return matrix.astype(np.float64).reshape(size, size)


def _sparse(entries: _Entries, size: int) -> Step:
    # scipy takes a quarter of a second to import and most worlds never need it
    from scipy.sparse import csr_matrix

    step: Step = csr_matrix((entries.chance, (entries.target, entries.source)), shape=(size, size)).dot
    return step


# Policies as arrays


SUM_TOLERANCE: Final = 1e-9

Choice = int | Mapping[int, float]
"""What is done in a state: one pair, or the probability of each of some pairs."""


def uniform_policy(space: FiniteSpace) -> FloatArray:
    """Return the policy, [P], that picks uniformly among all legal actions."""
    return uniform_over(space, np.ones(space.pairs, dtype=np.bool_))


def uniform_over(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    """Return the policy that picks uniformly among ``chosen`` pairs, at least one a live state.

    Both are [P], or [B, P] for as many policies.
    """
    first, count = _live_states(space)
    share = 1.0 / np.add.reduceat(chosen, first, axis=-1, dtype=np.float64)
    return np.where(chosen, np.repeat(share, count, axis=-1), 0.0)


def greedy_policy(space: FiniteSpace, q: FloatArray, ties: Ties) -> FloatArray:
    """Return the policy that is greedy for ``q``; both are [P], or [B, P] for as many policies.

    Ties are exact equality, as the agent itself compares: ``random`` picks among them uniformly, ``first``
    takes the first action.
    """
    tied = best_pairs(space, q)
    return uniform_over(space, tied) if ties == "random" else _first_of(space, tied)


def best_pairs(space: FiniteSpace, of_pairs: FloatArray, slack: float = 0.0) -> BoolArray:
    """Return which pairs have the greatest of the numbers ``of_pairs`` of their state: all ties.

    Both are [P], or [B, P] for as many sets of numbers. Those that have less by at most ``slack``, 0 or more,
    count as well.
    """
    first, count = _live_states(space)
    greatest = np.maximum.reduceat(of_pairs, first, axis=-1)
    return np.asarray(of_pairs >= np.repeat(greatest, count, axis=-1) - slack)


def softened(space: FiniteSpace, policy: FloatArray, epsilon: float) -> FloatArray:
    """Return the policy, [P], that takes a uniformly random action ``epsilon`` of the time, else ``policy``.

    ``epsilon`` is in [0, 1]. The random action may be the one that ``policy`` takes (equation 2.2 and the
    ε-soft policies of section 5.4).
    """
    return (1.0 - epsilon) * policy + epsilon * uniform_policy(space)


def policy_of_choices(space: FiniteSpace, choices: Mapping[int, Choice]) -> FloatArray:
    """Return the policy, [P], that does in each state what ``choices`` says: a pair, or the chance of each.

    A state that is not among them picks uniformly among its legal actions. Chances are scaled to sum to
    exactly 1. Raises ValueError where a pair is not one of its state, or chances are below 0 or do not sum
    to 1 (±1e-9).
    """
    policy = uniform_policy(space)
    for state, choice in choices.items():
        chances = choice if isinstance(choice, Mapping) else {choice: 1.0}
        own, total = space.pairs_of(state), sum(chances.values())
        if not all(pair in own for pair in chances):
            raise ValueError(f"state {state}: not all of {list(chances)} are its pairs")
        if not all(chance >= 0.0 for chance in chances.values()) or not abs(total - 1.0) <= SUM_TOLERANCE:
            raise ValueError(f"state {state}: {list(chances.values())} are no probabilities that sum to 1")
        policy[own.start : own.stop] = 0.0
        for pair, chance in chances.items():
            policy[pair] = chance / total
    return policy


def _first_of(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    first, count = _live_states(space)
    before: IntArray = np.cumsum(chosen, axis=-1) - chosen
    return np.where(chosen & (before == np.repeat(before[..., first], count, axis=-1)), 1.0, 0.0)


def _live_states(space: FiniteSpace) -> tuple[IntArray, IntArray]:
    """Return the first pair of every state that owns any, and how many it owns."""
    count = np.diff(space.first_pair)
    live = count > 0
    return space.first_pair[:-1][live], count[live]


# Metrics of a policy


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
