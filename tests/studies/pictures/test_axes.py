from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.studies.pictures.picture import (
    MOST_TICKS,
    ChartAxis,
    close_axis,
    fixed_axis,
    number_text,
    round_axis,
    word_axis,
)

VALUES = st.lists(st.floats(-1e9, 1e9, allow_subnormal=False), min_size=1, max_size=20)


@given(VALUES)
def test_an_axis_between_round_numbers_holds_all_values(values: list[float]) -> None:
    axis = round_axis("", values)
    assert all(-1e-9 <= axis.share(value) <= 1 + 1e-9 for value in values)
    assert 2 <= len(axis.ticks) <= MOST_TICKS + 1
    assert (axis.ticks[0], axis.ticks[-1]) == (axis.low, axis.high)
    steps = {round((later - earlier) / (axis.high - axis.low), 6) for earlier, later in pairwise(axis.ticks)}
    assert len(steps) == 1


@given(VALUES)
def test_ticks_have_labels_that_differ(values: list[float]) -> None:
    for axis in (round_axis("", values), close_axis("", values)):
        assert len(set(axis.labels)) == len(axis.ticks)


@pytest.mark.parametrize(
    ("axis", "labels"),
    [
        (round_axis("", [0.0, 1.4]), ("0.0", "0.5", "1.0", "1.5")),
        (round_axis("", [-940.0, -27.0]), ("−1,000", "−750", "−500", "−250", "0")),
        (round_axis("", [3.0], zero=True), ("0", "1", "2", "3")),
        (close_axis("", [1.0, 1000.0]), ("200", "400", "600", "800", "1,000")),
        (close_axis("", [0.01, 1.0], logarithmic=True), ("0.01", "0.1", "1")),
        (close_axis("", [0.1, 1.0], logarithmic=True), ("0.1", "0.3", "1")),
        (fixed_axis("", [-100, -50, 0]), ("−100", "−50", "0")),
        (word_axis("", ["sarsa", "q-learning"]), ("sarsa", "q-learning")),
    ],
)
def test_round_numbers(axis: ChartAxis, labels: tuple[str, ...]) -> None:
    assert axis.labels == labels


def test_a_logarithmic_axis_has_equal_ratios_at_equal_distances() -> None:
    axis = close_axis("", [0.01, 1.0], logarithmic=True)
    assert [axis.share(value) for value in (0.01, 0.1, 1.0)] == pytest.approx([0.0, 0.5, 1.0])
    assert axis.share(0.0) == -math.inf


def test_one_value_has_an_axis_too() -> None:
    for axis in (round_axis("", [5.0]), close_axis("", [5.0]), close_axis("", [5.0], logarithmic=True)):
        assert axis.low < 5.0 < axis.high
    assert round_axis("", []).low < round_axis("", []).high


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-50.74, "−50.7"),
        (0.035112, "0.0351"),
        (1500.0, "1,500"),
        (12345.6, "12,346"),
        (-0.0, "0"),
        (1e-7, "1e−7"),
        (2.5e9, "2.5e9"),
        (100.0, "100"),
    ],
)
def test_numbers_are_written_with_three_digits_or_all_before_the_point(value: float, text: str) -> None:
    assert number_text(value, 3) == text
