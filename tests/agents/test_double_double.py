"""Arithmetic of two doubles, against fractions."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from rl_tui.agents.exact.small_worlds.double_double import (
    DoubleDouble,
    plus,
    quick_two_sum,
    times,
    two_product,
    two_sum,
)

# Far from overflow, and from lost digits at the other end
moderate = st.one_of(
    st.just(0.0), st.floats(1e-100, 1e100), st.floats(-1e100, -1e-100), st.floats(-4.0, 4.0, width=16)
)


def whole(number: DoubleDouble) -> Fraction:
    return Fraction(number[0]) + Fraction(number[1])


@given(moderate, moderate)
def test_sum_and_product_lose_nothing(a: float, b: float) -> None:
    assert whole(two_sum(a, b)) == Fraction(a) + Fraction(b)
    assert two_sum(a, b)[0] == a + b
    larger, smaller = max(a, b, key=abs), min(a, b, key=abs)
    assert quick_two_sum(larger, smaller) == two_sum(a, b)
    assert whole(two_product(a, b)) == Fraction(a) * Fraction(b)
    assert two_product(a, b)[0] == a * b


@given(moderate, moderate, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_two_doubles_have_twice_the_digits(a: float, b: float, a_share: float, b_share: float) -> None:
    of_a, of_b = two_sum(a, a * a_share * 2.0**-53), two_sum(b, b * b_share * 2.0**-53)
    total, product = whole(of_a) + whole(of_b), whole(of_a) * whole(of_b)
    largest = max(abs(whole(of_a)), abs(whole(of_b)))
    assert abs(whole(plus(*of_a, *of_b)) - total) <= largest / 2**102
    assert abs(whole(times(*of_a, *of_b)) - product) <= abs(product) / 2**102
