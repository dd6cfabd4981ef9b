"""The curve for a greedy policy without a return."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_curves import NARROW, WIDE, drawn, flat
from lane_samples import lane_views, side_by_side
from samples import bandit, lake, marks, planning, student
from snapshots import changed

from rl_tui.live.program_view import ProgramView
from rl_tui.runs.results import Marks
from rl_tui.screen.panels.curve import text as words

BROAD = (110, 13)


def explains_gap(heading: str) -> bool:
    return any(form in heading for form in words.NO_LINE_WITHOUT_END)


@pytest.mark.parametrize(
    ("size", "ends", "said"),
    [(WIDE, 0.0, "greedy no end"), (WIDE, 0.63, "63 % end"), (NARROW, 0.0, "no end")],
)
def test_a_greedy_policy_without_a_return_has_a_label_that_says_why(
    size: tuple[int, int], ends: float, said: str
) -> None:
    endless = lake(greedy_return=None, greedy_ends=ends)
    text, widget = drawn(endless, size)
    assert said in text
    named = [piece.style for row in widget.picture(endless, *size) for piece in row if said in piece.text]
    assert named == [widget.look.palette.greedy_line]


def test_gaps_in_the_greedy_line_are_explained() -> None:
    with_gap = marks(30, 0.0, 0.73, 12_500)
    with_gap.expected_return[10:20] = np.nan
    assert explains_gap(drawn(lake(marks=with_gap), BROAD)[1].heading)
    assert not explains_gap(drawn(lake(), BROAD)[1].heading)


def test_a_program_without_a_table_has_no_greedy_line_for_that_reason() -> None:
    none = marks(30, 0.0, 0.73, 12_500)
    none.expected_return[:] = np.nan
    shown = replace(lake(marks=none), program=ProgramView("lake.py", "FrozenLake-v1"))
    assert words.NO_LINE_WITHOUT_TABLE[0] in drawn(shown, BROAD)[1].heading


def test_marks_without_a_return_that_leave_no_column_empty_are_no_gap() -> None:
    dense = marks(3_000, 0.0, 0.73, 12_500)
    dense.expected_return[100:2_900:50] = np.nan
    assert not explains_gap(drawn(lake(marks=dense), BROAD)[1].heading)


def test_a_label_without_a_value_leaves_the_row_to_the_one_that_has_it() -> None:
    ending = student(
        episodes=1, greedy_return=None, greedy_ends=0.0, return_last_100=-377.0, curve=flat(-377.0, 2)
    )
    text, widget = drawn(ending)
    rows = text.splitlines()
    assert next(y for y, row in enumerate(rows) if words.AGENT in row) == len(rows) - 1
    assert sum(words.GREEDY in row for row in rows) == 1
    assert widget.scale.low <= -377.0


def test_a_secret_policy_is_not_told_by_its_end() -> None:
    assert "end" not in drawn(bandit(400, greedy_return=None, greedy_ends=0.0))[0]


def test_a_planner_whose_policy_never_ends_says_so() -> None:
    none = Marks(np.array([0]), np.array([0]), np.array([np.nan]))
    text, _ = drawn(planning(greedy_return=None, greedy_ends=0.0, marks=none))
    assert f"greedy {words.NO_END}" in text


def test_a_run_beside_whose_greedy_policy_never_ends_says_so() -> None:
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
