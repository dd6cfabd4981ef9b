"""Pictures in the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from click import unstyle
from rich.cells import cell_len

from rl_tui.commands.reports.picture_text import ROWS, picture_text
from rl_tui.studies.pictures.picture import AtlasChart, Chart, ChartCurve, Picture, fixed_axis, round_axis


def chart(*curves: ChartCurve, **more: Any) -> Picture:
    axes = fixed_axis("episodes", [0, 50, 100]), fixed_axis("", [0, 5, 10])
    return Picture("title", "", (Chart("panel", *axes, curves, **more),), ("a note",), band="bands")


def curve(name: str, *points: tuple[float, float | None], **more: Any) -> ChartCurve:
    return ChartCurve(name, tuple(x for x, _ in points), tuple(y for _, y in points), **more)


def atlas(values: Sequence[Sequence[float | None]], **more: Any) -> Picture:
    known = [value for row in values for value in row if value is not None]
    names = tuple(f"c{column}" for column in range(len(values[0])))
    rows = tuple(f"r{row}" for row in range(len(values)))
    alike = more.pop("alike", tuple(tuple(False for _ in row) for row in values))
    best = more.pop("best", None)
    scale = round_axis("", known)
    panel = AtlasChart("", "x", "y", names, rows, tuple(map(tuple, values)), scale, alike, best)
    return Picture("title", "", (panel,))


def plot_rows(picture: Picture, columns: int = 60, **more: Any) -> list[str]:
    lines = unstyle(picture_text(picture, columns, **more)).splitlines()
    first = next(place for place, line in enumerate(lines) if "10" in line and ("┤" in line or "+" in line))
    return lines[first : first + ROWS]


def test_a_line_goes_from_corner_to_corner() -> None:
    rows = plot_rows(chart(curve("up", (0, 0.0), (100, 10.0))))
    assert rows[-1].split("┤")[1][0] not in " "
    assert rows[0].split("┤")[1].split()[0][-1] != " "
    starts = [next(place for place, mark in enumerate(row) if "⠀" < mark <= "⣿") for row in rows]
    assert starts == sorted(starts, reverse=True)


def test_a_curve_is_named_where_it_ends() -> None:
    rows = plot_rows(chart(curve("high", (0, 0.0), (100, 10.0)), curve("low", (0, 9.0), (100, 0.0))))
    assert rows[0].endswith(" high")
    assert rows[-1].endswith(" low")
    alike = plot_rows(chart(*(curve(f"line {place}", (0, 5.0), (100, 5.0)) for place in range(4))))
    assert [row[-6:] for row in alike if "line" in row] == ["line 0", "line 1", "line 2", "line 3"]


def test_gaps_and_what_is_beyond_the_axes_stay_empty() -> None:
    rows = plot_rows(chart(curve("", (0, 5.0), (40, 5.0), (50, None), (60, 5.0), (100, 5.0))))
    (line,) = [row for row in rows if any("⠀" < mark <= "⣿" for mark in row)]
    assert "  " in line.lstrip(" 0123456789┤│").strip()
    beyond = plot_rows(chart(curve("", (0, 20.0), (100, 30.0))))
    assert not any("⠀" < mark <= "⣿" for row in beyond for mark in row)


def test_points_that_nothing_joins_have_their_intervals() -> None:
    points = curve("", (50, 5.0), low=(0.0,), high=(10.0,))
    rows = plot_rows(chart(points, connected=False))
    places = {place for row in rows for place, mark in enumerate(row) if "⠀" < mark <= "⣿"}
    assert len([row for row in rows if any("⠀" < mark <= "⣿" for mark in row)]) == ROWS
    assert len(places) <= 2


@pytest.mark.parametrize("columns", [40, 60, 120])
@pytest.mark.parametrize("depth", ["none", "16", "256", "truecolor"])
def test_lines_fit_and_colours_change_no_character(columns: int, depth: Any) -> None:
    names = ("a rather long name of a curve", "b")
    drawn = chart(*(curve(name, (0, place), (100, 10.0), colour=place) for place, name in enumerate(names)))
    text = picture_text(drawn, columns, depth)
    assert max(map(cell_len, unstyle(text).splitlines())) <= columns
    assert unstyle(text) == picture_text(drawn, columns)
    assert ("\x1b[" in text) == (depth != "none")


def test_bands_are_told_only_where_they_are_drawn() -> None:
    text = picture_text(chart(curve("", (0, 0.0), (100, 1.0))), 60)
    assert "a note" in text
    assert "bands" not in text


def test_in_ascii_each_curve_has_a_letter() -> None:
    drawn = chart(curve("ε = 0", (0, 0.0), (100, 10.0)), curve("low", (0, 1.0), (100, 0.0)))
    text = picture_text(drawn, 60, ascii_only=True)
    assert text.isascii()
    assert "a epsilon = 0" in text
    rows = plot_rows(drawn, ascii_only=True)
    assert "a" in rows[0]
    assert "bbb" in rows[-1]


def test_an_atlas_has_numbers_and_marks() -> None:
    drawn = atlas([[1.0, 2.0], [3.0, None]], best=(1, 0), alike=((True, False), (True, False)))
    lines = picture_text(drawn, 60).splitlines()
    assert [line.split() for line in lines[3:6]] == [["r1", "3*", "-"], ["r0", "1'", "2"], ["c0", "c1"]]
    assert lines[6] == "* the best   ' tied with the best"
    assert "best" not in picture_text(atlas([[1.0, 2.0]]), 60)


def test_a_wide_atlas_comes_in_blocks() -> None:
    drawn = atlas([[float(column) for column in range(40)]])
    lines = picture_text(drawn, 50).splitlines()
    assert max(map(len, lines)) <= 50
    named = [name for line in lines for name in line.split() if name.startswith("c")]
    assert named == [f"c{column}" for column in range(40)]


@pytest.mark.parametrize("depth", ["16", "256", "truecolor"])
def test_without_room_for_numbers_cells_are_colours_alone(depth: Any) -> None:
    drawn = atlas([[float(column) for column in range(20)], [None] * 20], best=(0, 19))
    text = unstyle(picture_text(drawn, 50, depth))
    lines = text.splitlines()
    assert max(map(len, lines)) <= 50
    assert lines[3] == "r1  " + "- " * 20
    assert lines[4] == "r0  " + "  " * 19 + " *"
    assert lines[5].split()[:2] == ["c0", "c2"]
    assert lines[6].split() == ["0", "20"]
    assert all(lines[5].index(name) == 4 + 2 * int(name[1:]) for name in lines[5].split())


@pytest.mark.parametrize("depth", ["16", "256", "truecolor"])
def test_cells_have_colours_behind_them(depth: Any) -> None:
    drawn = atlas([[1.0, 2.0]])
    text = picture_text(drawn, 60, depth)
    assert "\x1b[" in text
    assert unstyle(text).split() == picture_text(drawn, 60).split()
