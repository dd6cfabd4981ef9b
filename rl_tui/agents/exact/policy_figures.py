"""Exact metrics of a policy: an array, [P], of probabilities with sum 1 in every state."""

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
from rl_tui.common.packages import is_installed
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Expected visits to each state


# Largest number of states with a dense matrix
MOST_DENSE: Final = 400

Step = Callable[[FloatArray], FloatArray]
"""Maps the distribution over states, [S], to the one after a step of continuing episodes."""


class _Entries(NamedTuple):
    source: IntArray
    target: IntArray
    chance: FloatArray


def expected_visits(mdp: TabularMDP, policy: FloatArray, steps: int) -> FloatArray:
    """Compute the expected visits to each state, [S], in `steps` steps of `policy`, [P]."""
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
        if np.array_equal(later, now):  # equal to the last bit, so it never changes again
            return visits + (steps - done) * now
        visits += now
        now = later
    return visits


def _by_doubling(matrix: FloatArray, now: FloatArray, steps: int) -> FloatArray:
    # (1 + M + M² + …) x with this many terms
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
    if not is_installed("scipy"):
        return lambda now: np.bincount(
            entries.target, weights=entries.chance * now[entries.source], minlength=size
        ).astype(np.float64, copy=False)
    # scipy takes 0.25 s to import, and most worlds never need it
    from scipy.sparse import csr_matrix

    step: Step = csr_matrix((entries.chance, (entries.target, entries.source)), shape=(size, size)).dot
    return step


# Policies as arrays


SUM_TOLERANCE: Final = 1e-9

Choice = int | Mapping[int, float]
"""What to do in a state: one pair, or the probabilities of some pairs."""


def uniform_policy(space: FiniteSpace) -> FloatArray:
    """Return the policy, [P], that takes all available actions equally."""
    return uniform_over(space, np.ones(space.pairs, dtype=np.bool_))


def uniform_over(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    """Take the `chosen` pairs, at least one in each live state, equally, [P] or [B, P]."""
    first, count = _live_states(space)
    share = 1.0 / np.add.reduceat(chosen, first, axis=-1, dtype=np.float64)
    return np.where(chosen, np.repeat(share, count, axis=-1), 0.0)


def greedy_policy(space: FiniteSpace, q: FloatArray, ties: Ties) -> FloatArray:
    """Return the greedy policy for estimates, both [P] or [B, P].

    Ties are shared evenly (``random``) or take the ``first`` action. Only equal floats tie.
    """
    tied = best_pairs(space, q)
    return uniform_over(space, tied) if ties == "random" else _first_of(space, tied)


def best_pairs(space: FiniteSpace, of_pairs: FloatArray, slack: float = 0.0) -> BoolArray:
    """Return the pairs within `slack` of the best of their state, [P] or [B, P]."""
    first, count = _live_states(space)
    greatest = np.maximum.reduceat(of_pairs, first, axis=-1)
    return np.asarray(of_pairs >= np.repeat(greatest, count, axis=-1) - slack)


def softened(space: FiniteSpace, policy: FloatArray, epsilon: float) -> FloatArray:
    """Mix `policy`, [P], with random actions (equation 2.2, ε-soft policies of section 5.4)."""
    return (1.0 - epsilon) * policy + epsilon * uniform_policy(space)


def policy_of_choices(space: FiniteSpace, choices: Mapping[int, Choice]) -> FloatArray:
    """Build a policy, [P], from choices: a pair, or probabilities. Other states act randomly.

    Raises:
        ValueError: A pair belongs to another state, or probabilities are negative or do not sum to 1 (±1e-9).
    """
    policy = uniform_policy(space)
    for state, choice in choices.items():
        chances = choice if isinstance(choice, Mapping) else {choice: 1.0}
        own, total = space.pairs_of(state), sum(chances.values())
        if not all(pair in own for pair in chances):
            raise ValueError(f"state {state}: not all of {list(chances)} are its pairs")
        if not all(chance >= 0.0 for chance in chances.values()) or not abs(total - 1.0) <= SUM_TOLERANCE:
            raise ValueError(f"state {state}: {list(chances.values())} are not probabilities that sum to 1")
        policy[own.start : own.stop] = 0.0
        for pair, chance in chances.items():
            policy[pair] = chance / total
    return policy


def _first_of(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    first, count = _live_states(space)
    before: IntArray = np.cumsum(chosen, axis=-1) - chosen
    return np.where(chosen & (before == np.repeat(before[..., first], count, axis=-1)), 1.0, 0.0)


def _live_states(space: FiniteSpace) -> tuple[IntArray, IntArray]:
    # First pair and number of pairs of every state with pairs
    count = np.diff(space.first_pair)
    live = count > 0
    return space.first_pair[:-1][live], count[live]


# Metrics of a policy


Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True, eq=False)
class PolicyFigures:
    """Exact numbers of a policy. None also means that rounding would spoil the number.

    An endless part adds 0 without rewards. With rewards, the value (at γ = 1) and the return are None.

    Args:
        v: Discounted values over an unlimited horizon, [S]; NaN if missing (γ = 1 only).
        value_at_start: Mean of `v`.
        expected_return: Undiscounted return within the time limit.
        steps: Expected length of an episode, or None if it may never end.
        ends: Probability that an episode ends.
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
    """Numbers of B greedy policies, [B], as in :class:`PolicyFigures` with NaN for None.

    The largest difference between estimates and Q* is `max_error`.
    """

    value_at_start: FloatArray
    expected_return: FloatArray
    max_error: FloatArray


def figures(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyFigures:
    """Compute the exact numbers of `policy`, [P]."""
    alone = policy[np.newaxis]
    chain_of = cache(_chains(mdp, alone))  # searches and factorizations are shared
    values, returns = _values_and_returns(mdp, alone, gamma, chain_of)
    steps, ends = _within_limit(mdp, policy) if mdp.time_limit else _unlimited(chain_of(0))
    return PolicyFigures(
        values.v[0] if values.exact[0] else None, _if_there(values.at_start), _if_there(returns), steps, ends
    )


def batch_figures(
    mdp: TabularMDP, q: FloatArray, ties: Ties, gamma: float, optimum: Solution | None
) -> BatchFigures:
    """Compute the numbers of the greedy policies of B runs, from estimates `q`, [B, P].

    Each equals :func:`figures`, bit for bit. Equal policies are evaluated once.
    """
    distinct, place = distinct_policies(greedy_policy(mdp, q, ties))
    values, returns = _values_and_returns(mdp, distinct, gamma, _chains(mdp, distinct))
    error = np.full(len(q), np.nan) if optimum is None else np.abs(q - optimum.q).max(axis=1)
    return BatchFigures(values.at_start[place], returns[place], error)


def expected_return(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Compute the expected undiscounted return of `policy`, [P], within the time limit.

    None if it may collect rewards forever, or if rounding would spoil it. Small worlds use machine code, fast
    enough for every frame.
    """
    return _if_there(expected_returns(mdp, policy[np.newaxis]))


def expected_returns(mdp: TabularMDP, policies: FloatArray) -> FloatArray:
    """Compute :func:`expected_return`, [B], of `policies`, [B, P], with NaN for None."""
    distinct, place = distinct_policies(policies)
    return returns_of(mdp, distinct, _chains(mdp, distinct))[place]


def chance_of_ending(mdp: TabularMDP, policy: FloatArray) -> float | None:
    """Compute the probability that an episode ends in time, or None if rounding spoils it."""
    if mdp.time_limit:
        return _within_limit(mdp, policy).ends
    return _if_exact(PolicyChain(exact_model(mdp), policy).chance_of_ending)


def _values_and_returns(
    mdp: TabularMDP, policies: FloatArray, gamma: float, chain_of: ChainOf
) -> tuple[ValuesOfPolicies, FloatArray]:
    values = values_of(mdp, policies, gamma, chain_of)
    if gamma == 1.0 and not mdp.time_limit:
        return values, values.at_start
    return values, returns_of(mdp, policies, chain_of)


def _chains(mdp: TabularMDP, policies: FloatArray) -> ChainOf:
    model = cache(exact_model)
    return lambda row: PolicyChain(model(mdp), policies[row])


def _within_limit(mdp: TabularMDP, policy: FloatArray) -> _Episode:
    visits = expected_visits(mdp, policy, mdp.time_limit)
    total = np.add.reduceat(mdp.probability, mdp.first_outcome[:-1])
    pairs = visits[mdp.pair_state] * policy / total
    ends = float(np.dot(pairs[mdp.outcome_pair] * mdp.probability, mdp.terminated))
    return _Episode(min(float(mdp.time_limit), float(visits.sum())), min(1.0, ends))


def _unlimited(chain: PolicyChain) -> _Episode:
    return _Episode(_if_exact(chain.expected_length), _if_exact(chain.chance_of_ending))


def _if_there(figure: FloatArray) -> float | None:
    number = float(figure[0])
    return None if np.isnan(number) else number


def _if_exact(answer: Callable[[], Answer]) -> Answer | None:
    try:
        return answer()
    except NoExactAnswer:
        return None
