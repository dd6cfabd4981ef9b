"""Double-double arithmetic: a number is the sum of two doubles, the second much smaller.

The rounding error of a sum or product is itself a double (Dekker, 1971: *A floating-point technique for
extending the available precision*; Knuth, *Seminumerical Algorithms*, section 4.2.2). On overflow the result
is inf or NaN.
"""

from __future__ import annotations

from typing import Final

from rl_tui.agents.kernels.compiled import for_kernels

# splits the 53 bits of a double into two halves of at most 26 bits
_SPLITTER: Final = 134217729.0

DoubleDouble = tuple[float, float]


@for_kernels
def two_sum(a: float, b: float) -> DoubleDouble:
    """Return a + b exactly, as rounded sum and rounding error."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)


@for_kernels
def quick_two_sum(a: float, b: float) -> DoubleDouble:
    """Return a + b exactly, if `a` is 0 or at least as large as `b` in magnitude."""
    total = a + b
    return total, b - (total - a)


@for_kernels
def two_product(a: float, b: float) -> DoubleDouble:
    """Return a · b exactly, as rounded product and rounding error."""
    product = a * b
    shifted = _SPLITTER * a
    high_a = shifted - (shifted - a)
    low_a = a - high_a
    shifted = _SPLITTER * b
    high_b = shifted - (shifted - b)
    low_b = b - high_b
    return product, ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b


@for_kernels
def plus(a: float, a_rest: float, b: float, b_rest: float) -> DoubleDouble:
    """Return the sum of two double-doubles."""
    total, rest = two_sum(a, b)
    return quick_two_sum(total, rest + (a_rest + b_rest))


@for_kernels
def times(a: float, a_rest: float, b: float, b_rest: float) -> DoubleDouble:
    """Return the product of two double-doubles."""
    product, rest = two_product(a, b)
    return quick_two_sum(product, rest + (a * b_rest + a_rest * b))
