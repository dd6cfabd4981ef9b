from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.names import with_minus
from rl_tui.screen.theme.glyphs import ASCII, UNICODE


@pytest.mark.parametrize(
    ("x", "width", "text"),
    [
        (0.54, 3, ".54"),
        (0.54, 5, "0.540"),
        (-1.2, 5, "−1.20"),
        (12.3, 4, "12.3"),
        (1.0, 3, "1.0"),
        (10.0, 5, "10.00"),
        (1_234_567.0, 5, "1.2e6"),
        (0.0004, 5, "4e-4"),
        (0.0004, 3, ".00"),
        (1e-12, 5, "0.000"),
        (-1e-12, 5, "0.000"),
        (-9.999, 3, "−10"),
        (-9.999, 2, "##"),
        (-100.0, 4, "−100"),
        (-1_000.0, 3, "−1k"),
        (-12_345.0, 4, "−12k"),
        (123_456.0, 3, "1e5"),
        (-1e20, 4, "<−1T"),
        (1e100, 3, ">1T"),
        (math.inf, 5, "inf"),
        (math.nan, 2, "##"),
    ],
)
def test_a_value_takes_as_many_decimals_as_fit(x: float, width: int, text: str) -> None:
    assert numbers.value(x, width) == text


@given(st.floats(), st.integers(1, 12))
def test_a_value_is_never_wider_than_its_room(x: float, width: int) -> None:
    assert 0 < len(numbers.value(x, width)) <= width


@given(st.floats(-1e6, 1e6), st.integers(8, 12))
def test_a_value_with_room_is_told_to_three_decimals(x: float, width: int) -> None:
    told = float(numbers.value(x, width).replace("−", "-"))
    assert told == pytest.approx(x, rel=1e-2, abs=5e-4)


def test_the_most_decimals_can_be_asked_for() -> None:
    assert numbers.value(0.54321, 8, decimals=2) == "0.54"


def test_the_minus_sign_is_the_one_of_the_glyphs() -> None:
    assert numbers.value(-1.2, 5, ASCII) == "-1.20"
    assert numbers.value(-1e9, 5, ASCII) == "-1e9"
    assert numbers.brief(-1e-7, ASCII) == "-1e-7"


@pytest.mark.parametrize(
    ("x", "width", "text"),
    [
        (-49_960, 4, "−50k"),
        (-4_000, 4, "−4k"),
        (-47_000, 4, "−47k"),
        (1.2e6, 5, "1.2e6"),
        (-131_546, 4, "−1e5"),
    ],
)
def test_thousands_are_in_one_unit(x: float, width: int, text: str) -> None:
    assert numbers.value(x, width) == text


@pytest.mark.parametrize(
    ("x", "width", "text"),
    [
        (0.119, 8, ".119"),
        (13.0, 8, "13.00"),
        (-6_146.4, 8, "−6146"),
        (9_999.7, 8, "10,000"),
        (-131_546.422, 8, "−131,546"),
        (-131_546.422, 7, "−1.3e5"),
        (0.0, 8, "0"),
        (0.0004, 8, "4e-4"),
    ],
)
def test_an_exact_figure_has_decimals_by_its_size(x: float, width: int, text: str) -> None:
    assert numbers.figure(x, width) == text


def test_a_number_that_rounds_to_zero_has_no_sign() -> None:
    assert numbers.fixed(-0.001, 2) == "0.00"
    assert numbers.fixed(-0.001, 2, leading_zero=False) == ".00"
    assert numbers.fixed(-0.25, 2, leading_zero=False) == "−.25"


@pytest.mark.parametrize(
    ("x", "text"),
    [(-2.0, "−2"), (0.1, ".1"), (0.0, "0"), (1 / 3, ".333333"), (100.0, "100"), (10.5, "10.5"), (1e9, "1e9")],
)
def test_brief_has_no_idle_decimals(x: float, text: str) -> None:
    assert numbers.brief(x) == text


@pytest.mark.parametrize(
    ("n", "width", "text"),
    [
        (12_345, None, "12,345"),
        (12_345, 5, "12.3k"),
        (12_345, 4, "12k"),
        (999_999, 6, "1.0M"),
        (4_100_000, 7, "4.1M"),
        (0, 1, "0"),
    ],
)
def test_a_count_is_short_where_it_must_be(n: int, width: int | None, text: str) -> None:
    assert numbers.count(n, width) == text


@pytest.mark.parametrize(
    ("speed", "short", "long"),
    [
        (38.2e6, "38 M/s", "38.2 M steps/s"),
        (950.0, "950/s", "950 steps/s"),
        (9.96, "10/s", "10 steps/s"),
        (1_234.0, "1.2 k/s", "1.2 k steps/s"),
        (999_960_000.0, "1.0 G/s", "1.0 G steps/s"),
    ],
)
def test_speeds(speed: float, short: str, long: str) -> None:
    assert numbers.rate(speed) == short
    assert numbers.long_rate(speed) == long


@pytest.mark.parametrize(
    ("share", "text"), [(0.84, "84 %"), (0.0, "0 %"), (1.0, "100 %"), (0.9999, ">99 %"), (0.0001, "<1 %")]
)
def test_all_and_none_are_said_only_where_it_is_so(share: float, text: str) -> None:
    assert numbers.percent(share) == text


def test_names_of_states_have_the_minus_of_numbers() -> None:
    assert with_minus("-0.55, -.02", UNICODE) == "−0.55, −.02"
    assert with_minus("-0.55, -.02", ASCII) == "-0.55, -.02"
    assert with_minus("3-4 half-way", UNICODE) == "3-4 half-way"
