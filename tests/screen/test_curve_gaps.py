"""What the return curve says where a greedy policy has no return, because it may never end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_curves import NARROW, WIDE, drawn, flat
from lane_samples import lane_views, side_by_side
from samples import bandit, lake, marks, planning, student
from snapshots import changed

from rl_tui.runs.results import Marks
from rl_tui.screen.panels.curve import words

TINY = (26, 9)


def explains_gap(text: str) -> bool:
    return any(form in text for form in words.NO_LINE_WITHOUT_END)


@pytest.mark.parametrize(
    ("size", "ends", "said"),
    [
        (WIDE, 0.0, f"greedy: {words.NEVER_ENDS}"),
        (WIDE, 0.63, "greedy: ends in 63 %"),
        (NARROW, 0.0, f"greedy: {words.NO_END}"),
        (NARROW, 0.63, "greedy: 63 % end"),
        (TINY, 0.0, f"greedy: {words.NO_END}"),
    ],
)
def test_a_greedy_policy_without_a_return_says_why_where_its_line_would_end(
    size: tuple[int, int], ends: float, said: str
) -> None:
    text, widget = drawn(lake(greedy_return=None, greedy_ends=ends), size)
    assert said in text
    assert words.GREEDY not in text
    palette = widget.look.palette
    named = [
        segment.style
        for row in widget.picture(lake(greedy_return=None, greedy_ends=ends), *size)
        for segment in row
        if said in segment.text
    ]
    assert named == [palette.greedy_line]


def test_a_narrow_title_says_it_too() -> None:
    _, widget = drawn(lake(greedy_return=None, greedy_ends=0.0), NARROW)
    assert widget.heading == f"greedy {words.NEVER_ENDS} · {words.SHORT_OPTIMUM} .54"


def test_gaps_in_the_greedy_line_are_explained() -> None:
    with_gap = marks(30, 0.0, 0.73, 12_500)
    with_gap.expected_return[10:20] = np.nan
    assert explains_gap(drawn(lake(marks=with_gap))[0])
    assert not explains_gap(drawn(lake())[0])


def test_marks_without_a_return_that_leave_no_column_empty_are_no_gap() -> None:
    dense = marks(3_000, 0.0, 0.73, 12_500)
    dense.expected_return[100:2_900:50] = np.nan
    assert not explains_gap(drawn(lake(marks=dense))[0])


def test_a_name_without_a_line_leaves_the_row_to_the_one_whose_line_ends_there() -> None:
    ending = student(
        episodes=1, greedy_return=None, greedy_ends=0.0, return_last_100=-377.0, curve=flat(-377.0, 2)
    )
    lines = drawn(ending)[0].splitlines()
    named = next(line for line in lines if "episodes, last" in line)
    assert any(0x2800 < ord(character) <= 0x28FF for character in named)
    assert not any(
        0x2800 < ord(character) <= 0x28FF for line in lines if words.NEVER_ENDS in line for character in line
    )


def test_a_secret_policy_is_not_told_by_its_end() -> None:
    assert "end" not in drawn(bandit(400, greedy_return=None, greedy_ends=0.0))[0]


def test_a_planner_whose_policy_never_ends_says_so() -> None:
    none = Marks(np.array([0]), np.array([0]), np.array([np.nan]))
    text, _ = drawn(planning(greedy_return=None, greedy_ends=0.0, marks=none))
    assert f"greedy: {words.NEVER_ENDS}" in text


def test_a_lane_whose_greedy_policy_never_ends_says_so() -> None:
    shown, other = lane_views(2)
    endless = replace(other, results=replace(other.results, greedy_return=None, greedy_ends=0.0))
    beside = changed(side_by_side(2), lanes=(shown, endless))
    assert f"α 0.5: .32, greedy {words.NO_END}" in drawn(beside, (110, 14))[0]
    alone = replace(endless, algorithm="value-iteration")
    no_episodes = replace(
        alone, results=replace(alone.results, curve=type(alone.results.curve)(), return_last_100=None)
    )
    planner = changed(side_by_side(2), lanes=(shown, no_episodes))
    assert f"α 0.5: {words.NO_END}" in drawn(planner, (110, 14))[0]
