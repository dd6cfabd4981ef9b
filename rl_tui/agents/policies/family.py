"""The interface of all policies. A rule is a NamedTuple."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from rl_tui.agents.kernels.compiled import has_member, inlined, inlined_by_type
from rl_tui.worlds.mdp.space import FloatArray, IntArray


@inlined_by_type
def in_force(rule: Any, epsilon: float) -> Any:
    """Return the rule for an episode with this ε."""
    return rule


@inlined_by_type
def choose(
    rule: Any, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    """Choose one of the pairs `first` .. `last` − 1; there is at least one.

    `q` and `visits` are [P].

    Returns:
        The pair, and True if it explored: drawn at random (ε-greedy), or not greedy (other policies).
    """
    raise NotImplementedError


@inlined_by_type
def probability_of(rule: Any, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    """Return π(a|s) of one of the pairs `first` .. `last` − 1, or NaN without a closed form.

    `q` and `visits` are [P]. Screens call it interpreted.
    """
    raise NotImplementedError


@inlined_by_type
def expectation(rule: Any, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    """Return Σ π(a|s) Q(s, a) over the pairs `first` .. `last` − 1 (equation 6.9), or 0 without pairs.

    `q` and `visits` are [P]. Saved runs depend on the last bits.
    """
    total = 0.0
    for pair in range(first, last):
        total += probability_of(rule, q, visits, first, last, pair) * float(q[pair])
    return total


@inlined_by_type
def reinforce(rule: Any, alpha: float, first: int, last: int, pair: int, reward: float) -> None:
    """Update the rule with the reward of one of the pairs `first` .. `last` − 1."""
    return


def learns(rule: Any) -> bool:
    """Return True if the policy has its own :func:`reinforce`."""
    return has_member(reinforce, type(rule))


@inlined
def best_value(q: FloatArray, first: int, last: int) -> float:
    """Return the greatest of the estimates `first` .. `last` − 1, or 0 if there are none."""
    if first == last:
        return 0.0
    best = float(q[first])
    for pair in range(first + 1, last):
        best = max(best, float(q[pair]))
    return best


@inlined
def greedy(q: FloatArray, first: int, last: int, random_ties: bool, draw: float) -> int:
    """Return the best of the pairs `first` .. `last` − 1. Ties take the first, or use `draw` in [0, 1)."""
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
    """Return the same as :func:`greedy`, with data-dependent branches only for ties.

    A wrong prediction of the processor would stall the other runs. Alone this is slower.
    """
    highest = best_value(q, first, last)
    ties, offset = 0, 0
    for pair in range(first, last):
        is_best = q[pair] == highest
        ties += is_best
        offset += (pair - first) * is_best
    return first + offset if ties == 1 else greedy(q, first, last, random_ties, draw)
