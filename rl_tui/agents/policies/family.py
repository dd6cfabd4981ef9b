"""What every policy brings: its rule, a NamedTuple of the numbers in force and, where it learns, arrays."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from rl_tui.agents.kernels.compiled import has_member, inlined, inlined_by_type
from rl_tui.worlds.mdp.space import FloatArray, IntArray


@inlined_by_type
def in_force(rule: Any, epsilon: float) -> Any:
    """Return the rule as it is in an episode whose exploration probability is ``epsilon``."""
    return rule


@inlined_by_type
def choose(
    rule: Any, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    """Choose among the pairs ``first`` .. ``last`` of a state, at least one; the second value: it explored.

    Under ε-greedy a pair explores if it was drawn at random, under other policies if it is not greedy.
    """
    raise NotImplementedError


@inlined_by_type
def probability_of(rule: Any, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    """Return π(a|s): how likely ``pair`` is to be chosen among the pairs ``first`` .. ``last`` of its state.

    NaN where it has no closed form. Screens call it interpreted.
    """
    raise NotImplementedError


@inlined_by_type
def expectation(rule: Any, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    """Return Σ π(a|s) Q(s, a) over the pairs ``first`` .. ``last`` of a state, 0 over none (equation 6.9).

    A policy may bring a quicker way to it. Its last bits then are that way's, in saved runs too.
    """
    total = 0.0
    for pair in range(first, last):
        total += probability_of(rule, q, visits, first, last, pair) * float(q[pair])
    return total


@inlined_by_type
def reinforce(rule: Any, alpha: float, first: int, last: int, pair: int, reward: float) -> None:
    """Update the rule with the reward of ``pair``, one of ``first`` .. ``last``.

    Most policies learn nothing. ``alpha`` is the step size in force.
    """
    return


def learns(rule: Any) -> bool:
    """Return whether the policy learns from rewards: whether it brings a :func:`reinforce` of its own."""
    return has_member(reinforce, type(rule))


@inlined
def best_value(q: FloatArray, first: int, last: int) -> float:
    """Return the greatest of the estimates ``first`` .. ``last``; the maximum over nothing is 0."""
    if first == last:
        return 0.0
    best = float(q[first])
    for pair in range(first + 1, last):
        best = max(best, float(q[pair]))
    return best


@inlined
def greedy(q: FloatArray, first: int, last: int, random_ties: bool, draw: float) -> int:
    """Return the best of the pairs ``first`` .. ``last``; of exact ties the first, or by a draw in [0, 1)."""
    best = first
    ties = 1
    highest = float(q[first])
    for pair in range(first + 1, last):
        estimate = float(q[pair])
        if estimate > highest:
            best = pair
            highest = estimate
            ties = 1
        elif estimate == highest:
            ties += 1
    if random_ties and ties > 1:
        skip = min(int(draw * ties), ties - 1)
        while skip > 0:
            best += 1
            if q[best] == highest:
                skip -= 1
    return best


@inlined
def greedy_in_turn(q: FloatArray, first: int, last: int, random_ties: bool, draw: float) -> int:
    """Return what :func:`greedy` does, with no branch that depends on the estimates but for ties.

    It takes longer alone, since a processor guesses well; a wrong guess costs the work at other runs too.
    """
    highest = best_value(q, first, last)
    ties, offset = 0, 0
    for pair in range(first, last):
        is_best = q[pair] == highest
        ties += is_best
        offset += (pair - first) * is_best
    return first + offset if ties == 1 else greedy(q, first, last, random_ties, draw)
