"""Real roots of polynomials, each between two fractions: found by Descartes' rule and bisection."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Final

from rl_tui.agents.exact.flips.polynomials import (
    Polynomial,
    common_factor,
    sign_at,
    square_free,
    variations,
)

# Two roots that stand as close as this are asked for what their polynomials have in common
CLOSE: Final = Fraction(1, 2**40)
# Far below half the distance of two floats in (0, 1) that matter to anybody
CLOSER_THAN_FLOATS: Final = Fraction(1, 2**90)


@dataclass(frozen=True, slots=True)
class RealRoot:
    """The one root of ``polynomial`` between ``lower`` and ``upper``, where it is not 0.

    ``sign`` is that of the polynomial at ``lower``, −1 or 1; at ``upper`` it is the other.
    """

    polynomial: Polynomial
    lower: Fraction
    upper: Fraction
    sign: int

    @property
    def width(self) -> Fraction:
        """How far apart the two bounds are."""
        return self.upper - self.lower

    def refined(self) -> RealRoot:
        """Return the same root within at most two thirds of the width."""
        middle, sign = _split(self.polynomial, self.lower, self.upper)
        if sign == self.sign:
            return RealRoot(self.polynomial, middle, self.upper, sign)
        return RealRoot(self.polynomial, self.lower, middle, self.sign)

    def within(self, width: Fraction) -> RealRoot:
        """Return the same root within at most that width."""
        root = self
        while root.width > width:
            root = root.refined()
        return root

    def nearest_float(self) -> float:
        """Return the float nearest to the root; of two that are equally near, either."""
        root = self
        while float(root.lower) != float(root.upper) and root.width > CLOSER_THAN_FLOATS:
            root = root.refined()
        return float((root.lower + root.upper) / 2)


def in_order(one: RealRoot, other: RealRoot) -> tuple[int, RealRoot, RealRoot]:
    """Return −1, 0 or 1 where ``one`` is less than, equal to or greater than ``other``, and both, refined.

    Where they are not equal their bounds no longer overlap.
    """
    shared: Polynomial | None = None
    while True:
        if one.upper <= other.lower:
            return -1, one, other
        if other.upper <= one.lower:
            return 1, one, other
        if shared is None and max(one.width, other.width) <= CLOSE:
            shared = common_factor(one.polynomial, other.polynomial)
            lower, upper = max(one.lower, other.lower), min(one.upper, other.upper)
            # A root of both polynomials in both intervals is the root of either there
            sign = sign_at(shared, lower)
            if sign != sign_at(shared, upper):
                equal = RealRoot(shared, lower, upper, sign)
                return 0, equal, equal
        if one.width >= other.width:
            one = one.refined()
        else:
            other = other.refined()


def first_change(given: Polynomial, lower: Fraction, upper: Fraction) -> RealRoot | None:
    """Return the least root between the two at which the sign of ``given`` changes, None if there is none.

    ``given`` is primitive and not 0 at either end.
    """
    return _change(given, lower, upper, from_below=True)


def last_change(given: Polynomial, lower: Fraction, upper: Fraction) -> RealRoot | None:
    """Return the greatest such root."""
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
        # An even multiple root only touches 0
        elif bound == 1 and sign_at(given, lower) != sign_at(given, upper):
            return RealRoot(simple, lower, upper, sign_at(simple, lower))
    return None


def _split(given: Polynomial, lower: Fraction, upper: Fraction) -> tuple[Fraction, int]:
    """Return a fraction near the middle at which ``given`` is not 0, and the sign there."""
    for parts in count(2):
        for part in range(-(-parts // 3), 2 * parts // 3 + 1):
            middle = lower + (upper - lower) * Fraction(part, parts)
            if sign := sign_at(given, middle):
                return middle, sign
    raise AssertionError
