"""Exact arithmetic with integer polynomials.

A polynomial is the tuple of its coefficients, constant first, without trailing zeros.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import accumulate, repeat
from operator import mul
from typing import Final

Polynomial = tuple[int, ...]

# Number of running sums between sign checks
LOOK_EVERY: Final = 3


def polynomial(coefficients: Iterable[int]) -> Polynomial:
    """Return the polynomial with these coefficients."""
    kept = list(coefficients)
    while kept and not kept[-1]:
        kept.pop()
    return tuple(kept)


def primitive(given: Polynomial) -> Polynomial:
    """Divide `given` by the greatest common divisor of its coefficients."""
    common = math.gcd(*given)
    return given if common <= 1 else tuple(each // common for each in given)


def scaled_value(given: Sequence[int], at: Fraction) -> int:
    """Return the value at `at`, times its denominator to the power len(given) − 1."""
    numerator, denominator = at.numerator, at.denominator
    value, scale = 0, 1
    for coefficient in reversed(given):
        value = value * numerator + coefficient * scale
        scale *= denominator
    return value


def sign_at(given: Polynomial, at: Fraction) -> int:
    """Return the sign of the value at `at`: −1, 0 or 1."""
    value = scaled_value(given, at)
    return (value > 0) - (value < 0)


def variations(given: Polynomial, lower: Fraction, upper: Fraction) -> int:
    """Return Descartes' bound of the number of roots between the bounds.

    It counts the sign changes among the coefficients of (1 + t)ⁿ p((lower·t + upper) / (1 + t)). The number
    of roots, with multiplicity, is less by an even number. So 0 and 1 are exact.
    """
    # p(lower + (upper − lower)·s) has the wanted roots in (0, 1)
    moved = list(given)
    if lower:
        moved = _shifted_by_one(_stretched(moved, lower))
        moved = _stretched(moved, (upper - lower) / lower)
    else:
        moved = _stretched(moved, upper)
    return _changes_of_shifted(moved[::-1])


def without_roots_at_ends(given: Polynomial) -> Polynomial:
    """Remove the roots at 0 and 1. Signs in between stay."""
    rest = list(given)
    while not rest[0]:
        del rest[0]
    while not sum(rest):
        # divide by 1 − γ, which is positive on (0, 1)
        rest = list(accumulate(rest))[:-1]
    return tuple(rest)


def derivative(given: Polynomial) -> Polynomial:
    """Return the derivative of `given`."""
    return tuple(power * each for power, each in enumerate(given) if power)


def quotient(dividend: Polynomial, divisor: Polynomial) -> Polynomial | None:
    """Return `dividend` / `divisor`, or None if it is not an integer polynomial."""
    rest = list(dividend)
    result = [0] * max(0, len(dividend) - len(divisor) + 1)
    for place in reversed(range(len(result))):
        result[place], remainder = divmod(rest[place + len(divisor) - 1], divisor[-1])
        if remainder:
            return None
        if result[place]:
            for offset, each in enumerate(divisor):
                rest[place + offset] -= result[place] * each
    return None if any(rest) else tuple(result)


def common_factor(one: Polynomial, other: Polynomial) -> Polynomial:
    """Return the greatest common divisor of two primitive polynomials, itself primitive.

    The digits of the common divisor of their values at a large integer x, in base x from −x/2 to x/2, give a
    candidate. If it divides both, and x > 2h + 2 (h: the smaller of their largest coefficients), it is the
    greatest. Proof: each root of a further common factor Q has a size of at most 1 + h, so |Q(x)| > x/2. But
    Q(x) divides a number of at most x/2.
    """
    base = 4 * min(max(map(abs, one)), max(map(abs, other))) + 9
    while True:
        at = Fraction(base)
        candidate = _digits(math.gcd(scaled_value(one, at), scaled_value(other, at)), base)
        if quotient(one, candidate) and quotient(other, candidate):
            return candidate
        base = 3 * base + 1


def square_free(given: Polynomial) -> Polynomial:
    """Return the primitive polynomial with the roots of `given`, each once."""
    repeated = common_factor(given, primitive(derivative(given)))
    result = quotient(given, repeated)
    assert result is not None
    return result


def _stretched(given: list[int], by: Fraction) -> list[int]:
    # p(by · x), times a positive number that makes it integer
    result = given
    if by.numerator != 1:
        result = list(map(mul, result, _powers(by.numerator, len(given))))
    if by.denominator != 1:
        result = list(map(mul, result, reversed(_powers(by.denominator, len(given)))))
    return result


def _powers(base: int, many: int) -> list[int]:
    return list(accumulate(repeat(base, many - 1), mul, initial=1))


def _shifted_by_one(given: list[int]) -> list[int]:
    # p(x + 1) by running sums (Horner)
    running = given[::-1]
    result = []
    while running:
        running = list(accumulate(running))
        result.append(running.pop())
    return result


def _changes_of_shifted(given: list[int]) -> int:
    # Sign changes of p(x + 1), ignoring zeros
    running = given[::-1]
    changes, last = 0, 0
    while running:
        if len(running) % LOOK_EVERY == 0 and (max(running) <= 0 or min(running) >= 0):
            return changes + (last * sum(running) < 0)
        running = list(accumulate(running))
        if each := running.pop():
            changes += last * each < 0
            last = 1 if each > 0 else -1
    return changes


def _digits(number: int, base: int) -> Polynomial:
    # Digits from −base/2 to base/2, made primitive
    digits = []
    while number:
        digit = number % base
        if 2 * digit > base:
            digit -= base
        digits.append(digit)
        number = (number - digit) // base
    return primitive(tuple(digits))
