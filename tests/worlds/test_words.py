from __future__ import annotations

import pytest

from rl_tui.common.words import counted, lasting, short_count


def test_one_is_singular_and_thousands_have_commas() -> None:
    assert [counted(count, "run") for count in (0, 1, 1200)] == ["0 runs", "1 run", "1,200 runs"]


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (0.0, "1 s"),
        (90.4, "90 s"),
        (130.0, "2 min"),
        (7_300.0, "2 h"),
        (9 * 3_600.0, "9 h"),
        (6 * 86_400.0, "6 days"),
        (3e9, "95 years"),
        (1e13, "316,881 years"),
    ],
)
def test_how_long_is_said_in_the_unit_that_suits(seconds, said):
    assert lasting(seconds) == said


@pytest.mark.parametrize(
    ("count", "said"),
    [
        (0, "0"),
        (950, "950"),
        (1_234, "1.2k"),
        (30_232_816, "30.2M"),
        (123_456_789, "123M"),
        (10**15, "1000T"),
    ],
)
def test_how_many_is_said_shortly(count, said):
    assert short_count(count) == said
