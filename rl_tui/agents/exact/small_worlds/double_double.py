"""Arithmetic of twice a double's digits: a number is the sum of two doubles, the second far below the first.

What is lost to rounding in a sum and in a product is itself a double, and is kept (Dekker, 1971: *A
floating-point technique for extending the available precision*; Knuth, *Seminumerical Algorithms*, section
4.2.2). This holds as long as nothing overflows; then the result is inf or NaN.
"""

from __future__ import annotations

from typing import Final

from rl_tui.agents.kernels.compiled import for_kernels

# It splits a double of 53 digits into two halves of at most 26 each
_SPLITTER: Final = 134217729.0

DoubleDouble = tuple[float, float]


@for_kernels
def two_sum(a: float, b: float) -> DoubleDouble:
    """Return a + b exactly: the rounded sum, and what rounding took from it."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)


@for_kernels
def quick_two_sum(a: float, b: float) -> DoubleDouble:
    """Return a + b exactly, where ``a`` is 0 or not below ``b`` in size."""
    total = a + b
    return total, b - (total - a)


@for_kernels
def two_product(a: float, b: float) -> DoubleDouble:
    """Return a · b exactly: the rounded product, and what rounding took from it."""
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
    """Return the sum of two numbers of two doubles."""
    total, rest = two_sum(a, b)
    return quick_two_sum(total, rest + (a_rest + b_rest))


@for_kernels
def times(a: float, a_rest: float, b: float, b_rest: float) -> DoubleDouble:
    """Return the product of two numbers of two doubles."""
    product, rest = two_product(a, b)
    return quick_two_sum(product, rest + (a * b_rest + a_rest * b))
