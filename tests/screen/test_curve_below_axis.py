"""Outliers of the mean, and greedy policies far below."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_curves import drawn
from rich.style import Style
from samples import bandit, lake, look, student
from snapshots import changed

from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve, Marks
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.theme.look import Look

WIDE = (90, 13)


def cells(snapshot: Snapshot, shown_with: Look) -> list[list[tuple[str, Style]]]:
    widget = ReturnCurve(shown_with)
    widget.snapshot = snapshot
    return [
        [(character, segment.style or Style()) for segment in row for character in segment.text]
        for row in widget.picture(snapshot, *WIDE)
    ]


def far_below(**changes: object) -> Snapshot:
    returns = np.array([-1_379.0, *np.full(200, -40.0)])
    episodes = np.arange(1, 202)
    early = Marks(np.array([0, 800, 1_600]), np.array([0, 10, 20]), np.array([-65_375.0, -65_375.0, -15.0]))
    usual = {
        "episodes": 201,
        "curve": Curve(episodes, returns, returns, returns, returns),
        "marks": early,
        "greedy_return": -15.0,
        "return_last_100": -40.0,
        "expected_return": None,
    }
    return student(**(usual | changes))


def test_the_axis_is_that_of_the_later_means_and_of_the_best() -> None:
    _, widget = drawn(far_below())
    assert (widget.scale.low, widget.scale.high) == (-40.0, -15.0)


def test_means_off_the_axis_are_marked_at_its_edge_in_every_column() -> None:
    rows = cells(far_below(), look())
    first = [character for character, _ in rows[-1][5:]]
    assert first[0] == "▾"
    assert "▾" in "".join(first[:4])
    assert not any(character == "▾" for row in rows[:-1] for character, _ in row)
    steps = Curve(
        np.arange(1, 201), np.ones(200), np.ones(200), np.ones(200), np.array([900.0] * 3 + [16.0] * 197)
    )
    text, _ = drawn(lake(curve=steps, episodes=200))
    assert "▴" in text.splitlines()[0]


def test_a_greedy_line_below_the_axis_is_marked_in_its_colour_and_the_heading_says_how_far() -> None:
    snapshot = far_below()
    signs = {style.color for character, style in cells(snapshot, look())[-1] if character == "▾"}
    assert look().palette.greedy_line.color in signs
    assert "▾ greedy down to −65,375" in drawn(snapshot, (90, 9))[1].heading
    assert "v greedy down to -65,375" in drawn(snapshot, (90, 9), ascii=True)[1].heading
    beside_program = replace(snapshot, program=ProgramView("student.py", "FrozenLake-v1"))
    assert "65,375" not in drawn(beside_program, (90, 9))[1].heading


@pytest.mark.parametrize("height", range(1, 9))
def test_far_below_is_drawn_at_any_height(height: int) -> None:
    for snapshot in (far_below(), lake(), bandit()):
        for size in ((40, height), (60, height), (12, height)):
            drawn(snapshot, size)


def test_a_first_episode_decides_on_the_axis() -> None:
    first = np.array([-1_379.0])
    start = far_below(
        episodes=1, return_last_100=-1_379.0, curve=Curve(np.array([1]), first, first, first, first)
    )
    _, widget = drawn(changed(start, greedy_return=None))
    assert widget.scale.low <= -1_379.0


def test_a_greedy_policy_below_the_axis_has_its_number_in_the_lowest_row() -> None:
    text, widget = drawn(far_below(greedy_return=-65_375.0))
    assert "greedy   −65k" in text.splitlines()[-1]
    assert widget.scale.low >= -100.0


def test_what_is_on_the_axis_has_no_signs() -> None:
    assert not {"▾", "▴"} & set(drawn(lake())[0])
