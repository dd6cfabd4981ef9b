"""Flip points: every γ in (0, 1) at which the optimal actions of a state change.

Decisions use integers, so rounding neither hides nor invents any.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import best_values
from rl_tui.agents.exact.exact_model import ExactModel, exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.policy_figures import expected_return, uniform_over
from rl_tui.agents.exact.polynomials import (
    Polynomial,
    common_factor,
    primitive,
    sign_at,
    square_free,
    variations,
    without_roots_at_ends,
)
from rl_tui.agents.exact.rational_values import PolicyValues, RationalModel, policy_values, rational_model
from rl_tui.common.words import counted
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Real roots of polynomials


# Roots this close are tested for a common factor of their polynomials
CLOSE: Final = Fraction(1, 2**40)
# Far below half the distance of neighbouring floats in (0, 1)
CLOSER_THAN_FLOATS: Final = Fraction(1, 2**90)


@dataclass(frozen=True, slots=True)
class RealRoot:
    """The only root of `polynomial` between `lower` and `upper`, with its sign at `lower`."""

    polynomial: Polynomial
    lower: Fraction
    upper: Fraction
    sign: int

    @property
    def width(self) -> Fraction:
        """Distance of the bounds."""
        return self.upper - self.lower

    def refined(self) -> RealRoot:
        """Return the root with at most two thirds of the width."""
        middle, sign = _split(self.polynomial, self.lower, self.upper)
        if sign == self.sign:
            return RealRoot(self.polynomial, middle, self.upper, sign)
        return RealRoot(self.polynomial, self.lower, middle, self.sign)

    def within(self, width: Fraction) -> RealRoot:
        """Return the root with at most this width."""
        root = self
        while root.width > width:
            root = root.refined()
        return root

    def nearest_float(self) -> float:
        """Return the float nearest to the root."""
        root = self
        while float(root.lower) != float(root.upper) and root.width > CLOSER_THAN_FLOATS:
            root = root.refined()
        return float((root.lower + root.upper) / 2)


def in_order(one: RealRoot, other: RealRoot) -> tuple[int, RealRoot, RealRoot]:
    """Compare two roots: −1, 0 or 1, and both refined until their bounds differ."""
    shared: Polynomial | None = None
    while True:
        if one.upper <= other.lower:
            return -1, one, other
        if other.upper <= one.lower:
            return 1, one, other
        if shared is None and max(one.width, other.width) <= CLOSE:
            shared = common_factor(one.polynomial, other.polynomial)
            lower, upper = max(one.lower, other.lower), min(one.upper, other.upper)
            # A common root inside both intervals is the root of each
            sign = sign_at(shared, lower)
            if sign != sign_at(shared, upper):
                equal = RealRoot(shared, lower, upper, sign)
                return 0, equal, equal
        if one.width >= other.width:
            one = one.refined()
        else:
            other = other.refined()


def first_change(given: Polynomial, lower: Fraction, upper: Fraction) -> RealRoot | None:
    """Return the smallest root between the bounds with a change of sign.

    The primitive polynomial `given` is not 0 at the bounds.
    """
    return _change(given, lower, upper, from_below=True)


def last_change(given: Polynomial, lower: Fraction, upper: Fraction) -> RealRoot | None:
    """Return the largest root between the bounds with a change of sign.

    The primitive polynomial `given` is not 0 at the bounds.
    """
    return _change(given, lower, upper, from_below=False)


def _change(given: Polynomial, lower: Fraction, upper: Fraction, *, from_below: bool) -> RealRoot | None:
    simple = given
    pending = [(lower, upper)]
    while pending:
        lower, upper = pending.pop()
        bound = variations(simple, lower, upper)
        if bound > 1:
            if simple is given:
                simple = square_free(given)
            middle, _ = _split(simple, lower, upper)
            halves = [(lower, middle), (middle, upper)]
            pending += reversed(halves) if from_below else halves
        # A root of even multiplicity only touches 0
        elif bound == 1 and sign_at(given, lower) != sign_at(given, upper):
            return RealRoot(simple, lower, upper, sign_at(simple, lower))
    return None


def _split(given: Polynomial, lower: Fraction, upper: Fraction) -> tuple[Fraction, int]:
    # A fraction near the middle that is not a root, and the sign there
    for parts in count(2):
        for part in range(-(-parts // 3), 2 * parts // 3 + 1):
            middle = lower + (upper - lower) * Fraction(part, parts)
            if sign := sign_at(given, middle):
                return middle, sign
    raise AssertionError


# Intervals of γ between flip points


ZERO: Final = Fraction(0)
ONE: Final = Fraction(1)
# First precision of a root, so that farther roots are recognized quickly
NARROW: Final = Fraction(1, 2**16)


@dataclass(frozen=True, slots=True)
class OptimalInterval:
    """The largest open interval of γ on which a policy is optimal.

    Args:
        policy: [N] pairs.
        optimal: All optimal pairs, [P]. At single γ, others may be equally good.
        lower: None: 0.
        upper: None: 1.
    """

    policy: tuple[int, ...]
    optimal: tuple[bool, ...]
    lower: RealRoot | None
    upper: RealRoot | None


def optimal_intervals(model: RationalModel, guess: Sequence[int]) -> list[OptimalInterval]:
    """Return all intervals from 0 to 1, in order.

    A `guess`, [N] pairs, that is optimal near γ = 1/2 saves time.
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
    # Nothing if `left` (None: 0) and `right` (None: 1) meet
    lower, upper = left and left.upper, right and right.lower
    if (left and not lower) or (right and not upper):
        return []
    if lower and upper:
        order, lower, upper = in_order(lower, upper)
        if order == 0:
            return []
    # Different roots may still share a bound, with each other or with an end
    while lower and lower.upper == (upper.lower if upper else ONE):
        lower = lower.refined()
    while upper and upper.lower == ZERO:
        upper = upper.refined()
    return [_around(model, lower.upper if lower else ZERO, upper.lower if upper else ONE, guess)]


def _around(model: RationalModel, lower: Fraction, upper: Fraction, guess: Sequence[int]) -> OptimalInterval:
    for gamma in _fractions_between(lower, upper):
        policy, values = _optimal_policy(model, gamma, guess)
        advantages = [primitive(values.advantage(pair)) for pair in model.pairs]
        inside = {without_roots_at_ends(advantage) for advantage in advantages if advantage}
        crossing = [advantage for advantage in sorted(inside) if variations(advantage, ZERO, ONE)]
        # If an action is equally good only at this γ, an interval may end here, so try another γ
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
    # With powers of 2 as denominators, smallest first
    for bits in count(1):
        first, last = math.floor(lower * 2**bits) + 1, math.ceil(upper * 2**bits)
        yield from (Fraction(odd, 2**bits) for odd in range(first | 1, last, 2))


def _optimal_policy(
    model: RationalModel, gamma: Fraction, guess: Sequence[int]
) -> tuple[tuple[int, ...], PolicyValues]:
    # Policy iteration (page 80), from `guess`, [N] pairs
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
    # The next γ where an advantage becomes positive
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
    # The previous γ where an advantage becomes positive as γ falls
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


# The optimal path from the start


# Tolerance for chances that floats cannot represent, such as 1/3
AS_LIKELY: Final = 1e-9


def way_from_start(model: ExactModel, optimal: BoolArray) -> BoolArray | None:
    """Return the states, [S+1], on the most likely path of `optimal` pairs, [P], from the start.

    Each state leads to the most likely other state, and ties to several. The path reaches the end, or circles
    in a part without an end. None if it circles until a slip leads out, because it does not show how the
    episode continues.
    """
    source = model.pair_state[model.outcome_pair]
    moves = np.flatnonzero(optimal[model.outcome_pair] & (model.landing != source))
    places, place_of = np.unique(
        model.outcome_pair[moves] * (model.end + 1) + model.landing[moves], return_inverse=True
    )
    pair, landing = np.divmod(places, model.end + 1)
    chance = np.bincount(place_of, weights=model.probability[moves].astype(np.float64))
    highest = np.zeros(model.mdp.pairs)
    np.maximum.at(highest, pair, chance)
    followed = chance >= highest[pair] - AS_LIKELY
    first_edge = np.searchsorted(model.pair_state[pair[followed]], np.arange(model.end + 2))
    way = reachable(first_edge, landing[followed], model.mdp.start_state)
    may_end = model.steps_to([model.end], optimal) >= 0
    return way if way[model.end] or not (way & may_end).any() else None


# Flip points


MOST_STATES: Final = 100
MIDDLE: Final = 0.5


@dataclass(frozen=True, slots=True)
class Turn:
    """The pairs of one state that are optimal below and above γ."""

    state: int
    before: tuple[int, ...]
    after: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Flip:
    """A value of γ at which optimal actions change.

    Args:
        gamma: The nearest float.
        turns_the_way: True if a changed state is a start, or on an optimal path (:func:`way_from_start`),
            below or above.
        expected_return: Undiscounted return of the optimal policy below and above, uniform over ties, within
            the time limit, or None.
        turns: In the order of states.
    """

    gamma: float
    turns_the_way: bool
    expected_return: tuple[float | None, float | None]
    turns: tuple[Turn, ...]


def flips(mdp: TabularMDP) -> tuple[Flip, ...]:
    """Return all flip points, rising in γ. Rounding neither hides nor invents any.

    Probabilities and rewards are the nearest fractions with denominators up to 10⁶. A γ at which an action is
    only momentarily as good does not count.

    Raises:
        NoExactAnswer: More than 100 states have pairs, or a non-zero number is too small.
    """
    reason = why_refused(mdp)
    if reason:
        raise NoExactAnswer(reason)
    model = exact_model(mdp)
    if mdp.terminated.all():
        return ()
    intervals = optimal_intervals(rational_model(mdp), _guess(model))
    sides = [_side(model, np.array(interval.optimal)) for interval in intervals]
    return tuple(
        _flip(model, interval.lower, *sides[place : place + 2])
        for place, interval in enumerate(intervals[1:])
        if interval.lower
    )


def why_refused(mdp: TabularMDP) -> str:
    """Return why `mdp` is too large, or an empty text."""
    live = int(np.count_nonzero(np.diff(mdp.first_pair)))
    most = counted(MOST_STATES, "state")
    return (
        f"flip points are computed for at most {most} with actions; here there are {live:,}"
        if live > MOST_STATES
        else ""
    )


class _Side(NamedTuple):
    optimal: BoolArray
    expected_return: float | None
    way: BoolArray | None


def _guess(model: ExactModel) -> list[int]:
    # [N] pairs, probably optimal at γ = 1/2
    mdp = model.mdp
    v = np.append(best_values(mdp, MIDDLE, mdp.states), 0.0).astype(np.longdouble)
    advantage = model.advantage(v, MIDDLE).tolist()
    return [max(mdp.pairs_of(state), key=advantage.__getitem__) for state in model.live.tolist()]


def _side(model: ExactModel, optimal: BoolArray) -> _Side:
    earned = expected_return(model.mdp, uniform_over(model.mdp, optimal))
    return _Side(optimal, earned, way_from_start(model, optimal))


def _flip(model: ExactModel, root: RealRoot, below: _Side, above: _Side) -> Flip:
    turns = tuple(_turns(model, below.optimal, above.optimal))
    on_the_way = np.zeros(model.end + 1, dtype=np.bool_)
    on_the_way[model.mdp.start_state] = True
    if below.way is not None and above.way is not None:
        on_the_way |= below.way | above.way
    return Flip(
        gamma=root.nearest_float(),
        turns_the_way=any(on_the_way[turn.state] for turn in turns),
        expected_return=(below.expected_return, above.expected_return),
        turns=turns,
    )


def _turns(model: ExactModel, before: BoolArray, after: BoolArray) -> Iterator[Turn]:
    for state in model.live.tolist():
        pairs = model.mdp.pairs_of(state)
        was, becomes = (tuple(pair for pair in pairs if optimal[pair]) for optimal in (before, after))
        if was != becomes:
            yield Turn(state, was, becomes)
