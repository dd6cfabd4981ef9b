"""The stretches of γ on which one set of actions is optimal, from 0 to 1, without gaps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Final

from rl_tui.agents.exact.flips.policy_values import PolicyValues, policy_values
from rl_tui.agents.exact.flips.polynomials import (
    Polynomial,
    primitive,
    sign_at,
    variations,
    without_roots_at_ends,
)
from rl_tui.agents.exact.flips.rational_model import RationalModel
from rl_tui.agents.exact.flips.real_roots import RealRoot, first_change, in_order, last_change

ZERO: Final = Fraction(0)
ONE: Final = Fraction(1)
# A root is first found this well, so that farther ones are seen to be farther at once
NARROW: Final = Fraction(1, 2**16)


@dataclass(frozen=True, slots=True)
class OptimalInterval:
    """The largest open interval of γ on which ``policy``, [N] pairs, is optimal.

    ``optimal`` marks all pairs that are optimal on it, [P]: the same everywhere, but for single γ at which
    others are as good. ``lower`` is None where it begins at 0, ``upper`` where it ends at 1.
    """

    policy: tuple[int, ...]
    optimal: tuple[bool, ...]
    lower: RealRoot | None
    upper: RealRoot | None


def optimal_intervals(model: RationalModel, guess: Sequence[int]) -> list[OptimalInterval]:
    """Return the intervals from 0 to 1; each ends where the next begins.

    ``guess``, [N] pairs, is any policy; the search is quick if it is optimal at some γ near 1/2.
    """
    found = _between(model, None, None, guess)
    place = 0
    while place <= len(found):
        left = found[place - 1] if place else None
        right = found[place] if place < len(found) else None
        between = _between(model, left, right, found[max(0, place - 1)].policy)
        found[place:place] = between
        place += not between
    return found


def _between(
    model: RationalModel, left: OptimalInterval | None, right: OptimalInterval | None, guess: Sequence[int]
) -> list[OptimalInterval]:
    """Return an interval between ``left`` (None: 0) and ``right`` (None: 1), none where they meet."""
    lower, upper = left and left.upper, right and right.lower
    if (left and not lower) or (right and not upper):
        return []
    if lower and upper:
        order, lower, upper = in_order(lower, upper)
        if order == 0:
            return []
    # Roots that differ may still share a bound, with each other or with an end
    while lower and lower.upper == (upper.lower if upper else ONE):
        lower = lower.refined()
    while upper and upper.lower == ZERO:
        upper = upper.refined()
    return [_around(model, lower.upper if lower else ZERO, upper.lower if upper else ONE, guess)]


def _around(model: RationalModel, lower: Fraction, upper: Fraction, guess: Sequence[int]) -> OptimalInterval:
    """Return the interval around some γ between the two."""
    for gamma in _fractions_between(lower, upper):
        policy, values = _optimal_policy(model, gamma, guess)
        advantages = [primitive(values.advantage(pair)) for pair in model.pairs]
        inside = {without_roots_at_ends(advantage) for advantage in advantages if advantage}
        crossing = [advantage for advantage in sorted(inside) if variations(advantage, ZERO, ONE)]
        # Where an action is as good at this γ alone, an interval might end here: another γ is taken
        if all(sign_at(advantage, gamma) for advantage in crossing):
            return OptimalInterval(
                policy=policy,
                optimal=tuple(not advantage for advantage in advantages),
                lower=_nearest_below(crossing, gamma),
                upper=_nearest_above(crossing, gamma),
            )
        guess = policy
    raise AssertionError


def _fractions_between(lower: Fraction, upper: Fraction) -> Iterator[Fraction]:
    """Yield fractions between the two whose denominators are powers of 2, the smallest first."""
    for bits in count(1):
        first, last = math.floor(lower * 2**bits) + 1, math.ceil(upper * 2**bits)
        yield from (Fraction(odd, 2**bits) for odd in range(first | 1, last, 2))


def _optimal_policy(
    model: RationalModel, gamma: Fraction, guess: Sequence[int]
) -> tuple[tuple[int, ...], PolicyValues]:
    """Return a policy that is optimal at ``gamma``, [N] pairs, and its values (page 80, from ``guess``)."""
    policy = tuple(guess)
    while True:
        values = policy_values(model, policy)
        here = values.at(gamma)
        better = []
        for pairs, taken in zip(model.pairs_of, policy, strict=True):
            gains = {pair: here.advantage(model.pairs[pair]) for pair in pairs}
            best = max(pairs, key=lambda pair: gains[pair])
            better.append(best if gains[best] > 0 else taken)
        if tuple(better) == policy:
            return policy, values
        policy = tuple(better)


def _nearest_above(advantages: Sequence[Polynomial], gamma: Fraction) -> RealRoot | None:
    """Return the least γ above ``gamma`` at which one of the ``advantages`` becomes positive, if one does."""
    nearest: RealRoot | None = None
    for advantage in advantages:
        while nearest and not sign_at(advantage, nearest.upper):
            nearest = nearest.refined()
        root = first_change(advantage, gamma, nearest.upper if nearest else ONE)
        if root and nearest:
            order, root, nearest = in_order(root, nearest)
            nearest = root if order < 0 else nearest
        elif root:
            nearest = root.within(NARROW)
    return nearest


def _nearest_below(advantages: Sequence[Polynomial], gamma: Fraction) -> RealRoot | None:
    """Return the greatest γ below ``gamma`` at which one of them becomes positive as γ falls, if one does."""
    nearest: RealRoot | None = None
    for advantage in advantages:
        while nearest and not sign_at(advantage, nearest.lower):
            nearest = nearest.refined()
        root = last_change(advantage, nearest.lower if nearest else ZERO, gamma)
        if root and nearest:
            order, root, nearest = in_order(root, nearest)
            nearest = root if order > 0 else nearest
        elif root:
            nearest = root.within(NARROW)
    return nearest
