"""The band of the return curve, and what lies below its axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from colour_vision import contrast
from drawn_curves import NO_MARKS, WIDE, drawn
from lane_samples import side_by_side
from rich.style import Style
from samples import bandit, lake, look, student
from snapshots import changed

from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve, Marks
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.words import BELOW_AXIS
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.screen.theme.look import Look, Palette, palette_for


def drawn_with(snapshot: Snapshot, shown_with: Look) -> list[str]:
    return ["".join(character for character, _ in row) for row in cells(snapshot, shown_with)]


def cells(snapshot: Snapshot, shown_with: Look) -> list[list[tuple[str, Style]]]:
    """Every character with its style, row by row."""
    widget = ReturnCurve(shown_with)
    widget.snapshot = snapshot
    return [
        [(character, segment.style or Style()) for segment in row for character in segment.text]
        for row in widget.picture(snapshot, *WIDE)
    ]


def one_episode(value: float) -> Curve:
    values = np.array([value])
    return Curve(np.array([1]), values, values, values, values)


# The band


def test_where_colours_allow_the_band_is_a_surface_behind_the_lines() -> None:
    rows, palette = cells(lake(), look()), look().palette
    behind = {style.bgcolor for row in rows for _, style in row}
    assert behind == {None, palette.band.color}
    inside = [
        (character, style)
        for row in rows
        for character, style in row
        if style.bgcolor is not None and style.color == palette.episodes.color
    ]
    assert inside
    assert all(0x2800 < ord(character) <= 0x28FF for character, _ in inside)


@pytest.mark.parametrize("depth", ["16", "none"])
def test_with_few_colours_the_band_is_its_two_edges(depth: str) -> None:
    """A low and a high that are far apart: nothing is drawn between them."""
    values = np.full(40, 0.5)
    level = Curve(np.arange(1, 41) * 25_000, values, values - 0.1, values + 0.1, values)
    snapshot = lake(
        episodes=1_000_000,
        curve=level,
        marks=NO_MARKS,
        greedy_return=None,
        return_last_100=0.5,
        expected_return=None,
    )
    shown = look(depth=depth)
    rows = [
        {character for character, style in row if style == shown.palette.band and ord(character) > 0x2800}
        for row in cells(snapshot, shown)[:-2]
    ]
    assert [len(row) for row in rows if row] == [1, 1]
    assert not any(style.bgcolor for row in cells(snapshot, shown) for _, style in row)


def test_without_braille_and_colours_dashes_are_the_lowest_and_the_highest() -> None:
    lines = drawn_with(lake(), look(True, "none"))
    assert sum("- -" in line for line in lines[:-2]) >= 2


@pytest.mark.parametrize(
    "palette", [palette_for(depth, dark) for depth in ("256", "truecolor") for dark in (True, False)]
)
def test_lines_stand_out_from_the_band_behind_them(palette: Palette) -> None:
    assert palette.band.color is not None
    for style in (palette.greedy_line, palette.episodes, palette.optimum):
        assert style.color is not None
        assert contrast(style.color, palette.band.color) >= 3.0


# Far below all the rest


def far_below() -> Snapshot:
    """A first episode and a first greedy policy that are worth far less than all that came after them."""
    returns = np.array([-1_379.0, *np.full(39, -40.0)])
    episodes = np.arange(1, 41)
    early = Marks(np.array([0, 800, 1_600]), np.array([0, 10, 20]), np.array([-65_375.0, -65_375.0, -15.0]))
    return student(
        episodes=40,
        curve=Curve(episodes, returns, returns, returns, returns),
        marks=early,
        greedy_return=-15.0,
        return_last_100=-70.0,
        expected_return=None,
    )


def test_the_axis_is_that_of_most_episodes_and_of_the_best() -> None:
    _, widget = drawn(far_below())
    assert widget.scale == Scale(-70.0, 0.0, 20.0)


def test_a_line_below_the_axis_is_marked_where_it_leaves_it() -> None:
    snapshot = far_below()
    rows, palette = cells(snapshot, look()), look().palette
    bottom = rows[-3]
    arrows = {style.color for character, style in bottom if character == "↓"}
    assert arrows == {palette.episodes.color, palette.greedy_line.color}
    assert not any(character == "↓" for row in rows[:-3] for character, _ in row)
    assert "↓ greedy, once −65,375" in drawn(snapshot)[0]
    assert "v greedy, once" in drawn(snapshot, ascii=True)[0]
    beside_program = drawn(replace(snapshot, program=ProgramView("student.py", "FrozenLake-v1")))[0]
    assert f"↓ {BELOW_AXIS}: greedy and episodes" in beside_program
    assert "65,375" not in beside_program


@pytest.mark.parametrize("height", range(1, 9))
def test_far_below_is_told_at_any_height(height: int) -> None:
    for snapshot in (far_below(), lake(), bandit()):
        for size in ((40, height), (60, height), (12, height)):
            drawn(snapshot, size)
    assert UNICODE.down in drawn(far_below(), (60, height))[1].footing


def test_a_first_episode_decides_on_the_axis_as_long_as_there_are_few() -> None:
    start = changed(far_below(), episodes=1, return_last_100=-1_379.0, curve=one_episode(-1_379.0))
    _, widget = drawn(start)
    assert widget.scale == Scale(-1_500.0, 0.0, 500.0)


def test_a_greedy_policy_below_the_axis_has_an_arrow_and_its_number_at_its_end() -> None:
    text, widget = drawn(changed(far_below(), greedy_return=-65_375.0))

    assert "↓ greedy, exact −65,375" in text
    assert widget.scale == Scale(-70.0, 0.0, 20.0)


def test_what_is_on_the_axis_has_no_arrows() -> None:
    assert "↓" not in drawn(lake())[0]


def test_as_long_as_every_episode_is_on_the_line_there_is_no_band() -> None:
    few = changed(far_below(), marks=NO_MARKS, greedy_return=None)
    assert not any(style.bgcolor for row in cells(few, look()) for _, style in row)


@pytest.mark.parametrize(
    ("depth", "is_ascii", "alone", "among_lanes"),
    [
        ("truecolor", False, ["return", "shade"], ["dim dots", "return"]),
        ("16", False, ["return", "dim dots"], ["dim dots", "return"]),
        ("none", True, ["return", "dashes"], ["return"]),
    ],
)
def test_the_legend_names_the_band_as_it_is_drawn(
    depth: str, is_ascii: bool, alone: list[str], among_lanes: list[str]
) -> None:
    widget = ReturnCurve(look(is_ascii, depth))
    assert [sign.sign for sign in widget.legend(lake())] == alone
    assert [sign.sign for sign in widget.legend(side_by_side(2))] == among_lanes
