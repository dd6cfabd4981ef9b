"""A map as a landscape."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_grids import style_at
from drawn_tables import Drawn
from rich.color import ColorType
from samples import big_lake, lake, look, student
from snapshots import changed
from textual.geometry import Size
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.landscape import has_landscape, has_relief, heights, line_step, pixels, relief
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import IntArray

CELL = Size(7, 3)
SCALE = ValueScale(0.0, 1.0)
SLOPE = np.tile(np.linspace(0.0, 1.0, 6), (4, 1))  # it rises to the right


def view_of(snapshot: Snapshot, with_look: Look | None = None, cell: Size = CELL) -> GridView:
    view = GridView(snapshot.world, with_look or look())
    view.cell, view.wanted_layer = cell, Layer.LANDSCAPE
    view.show(snapshot)
    return view


def drawn(snapshot: Snapshot, view: GridView | None = None) -> list[Strip]:
    strips = (view or view_of(snapshot)).picture(snapshot, 60, 25)
    assert [strip.cell_length for strip in strips] == [60] * 25
    return strips


def test_the_middle_of_a_cell_has_its_value_and_halfway_is_the_mean() -> None:
    values = np.array([[0.0, 1.0], [0.5, 0.5]])
    found = heights(values, Size(5, 2))
    assert found.shape == (8, 10)
    assert found[:3, 2] == pytest.approx([0.0, 0.0, 0.0625])
    assert found[2, 7] == pytest.approx(1.0 - 0.0625)
    assert found[0, 4] == pytest.approx(0.4)
    assert found[-1] == pytest.approx(0.5)


def test_a_wall_is_no_height_and_does_not_pull_its_neighbours() -> None:
    found = heights(np.array([[0.5, math.nan, 1.0]]), Size(5, 2))
    assert np.isnan(found[:, 5:10]).all()
    assert (found[:, :5] == 0.5).all()
    assert (found[:, 10:] == 1.0).all()


@pytest.mark.parametrize(
    ("values", "ends", "step"),
    [
        ([0.0, 0.2, 0.4, 0.6, 0.8, 1.0], (0.0, 1.0), 0.2),
        ([0.0, 0.0, 0.0, 0.90, 0.91, 0.92, 0.93], (0.0, 1.0), 0.02),  # most of them on a plateau
        ([-13.0, -12.0, -11.0, math.nan, -9.0, -8.0], (-13.0, -1.0), 2.0),
        ([0.0, 1.0], (0.0, 1.0), 0.2),
        ([0.5, 0.5], (0.0, 1.0), 0.2),
    ],
)
def test_most_cells_are_two_thirds_of_a_step_apart(
    values: list[float], ends: tuple[float, float], step: float
) -> None:
    assert line_step(np.array([values, values]), ValueScale(*ends)) == pytest.approx(step)


def test_half_of_a_height_is_the_rank_so_that_a_plateau_has_slopes() -> None:
    found = relief(np.array([[0.0, math.nan, 0.9, 0.95, 1.0]]), SCALE)[0]
    assert found[[0, 2, 3, 4]] == pytest.approx([0.0, 0.45 + 1 / 6, 0.475 + 2 / 6, 1.0])
    assert np.isnan(found[1])
    signed = relief(np.array([[-1.0, -0.5, 0.0, 1.0]]), ValueScale(-1.0, 1.0))[0]
    assert signed == pytest.approx([0.0, 0.25, 0.5, 1.0])


def light_of(found: IntArray) -> IntArray:
    return found // 2 % 13


def test_light_comes_from_the_upper_left() -> None:
    lit, dark = pixels(SLOPE, CELL, SCALE, 0.2), pixels(SLOPE[:, ::-1], CELL, SCALE, 0.2)[:, ::-1]
    flat = pixels(np.full((4, 6), 0.5), CELL, SCALE, 0.2)
    assert (light_of(lit) >= light_of(dark)).all()
    assert (light_of(lit) > 6).any()
    assert (light_of(flat) == 6).all()


def test_lines_are_where_v_passes_a_step_and_a_plain_has_none() -> None:
    is_line = pixels(SLOPE, CELL, SCALE, 0.2) % 2 == 1
    assert is_line[1].sum() == 5  # .1, .3, .5, .7, .9
    plain = np.full((4, 6), 0.6) + 1e-12 * np.random.default_rng(0).standard_normal((4, 6))
    assert not (pixels(plain, CELL, SCALE, 0.2) % 2 == 1).any()


def test_a_plain_at_0_has_one_colour() -> None:
    assert len(np.unique(pixels(np.zeros((4, 12)), Size(7, 2), ValueScale(-1.0, 1.0), 0.2))) == 1


def test_a_slope_so_steep_that_its_lines_would_touch_has_none() -> None:
    assert not (pixels(SLOPE, CELL, SCALE, 0.02) % 2 == 1).any()


def test_light_changes_gradually_beside_a_hole() -> None:
    values = np.full((5, 5), 0.9)
    values[2, 2] = 0.0
    light = light_of(pixels(values, CELL, SCALE, 0.2))
    assert (np.abs(np.diff(light, axis=1)) <= 2).all()
    assert (np.abs(np.diff(light, axis=0)) <= 2).all()
    assert light.min() < 6 < light.max()


def test_where_v_hardly_differs_cells_are_drawn() -> None:
    assert not has_relief([0.3, 0.32], SCALE)
    assert not has_relief([math.nan] * 4, SCALE)
    assert not has_relief([], SCALE)
    assert has_relief([0.3, 0.4], SCALE)
    flat = changed(lake(), q=np.full(44, 0.5))
    flat_view = view_of(flat, cell=Size(13, 5))
    usual = GridView(flat.world, look())
    usual.cell = Size(13, 5)
    assert flat_view.picture(flat, 60, 25)[:24] == usual.picture(flat, 60, 25)[:24]


def test_it_has_half_blocks_letters_and_plates() -> None:
    view = view_of(big_lake())
    text = [strip.text for strip in drawn(big_lake(), view)]
    assert sum(row.count("▀") for row in text[:-1]) > 0.9 * 56 * 24
    assert {"◉", "●", "★", "→"} <= set("".join(text))
    assert "a line every .1" in text[-1]


def test_map_and_table_keep_the_scale_of_v_and_the_table_shows_q() -> None:
    usual, landscape = GridView(lake().world, look()), view_of(lake())
    usual.cell = CELL
    usual.picture(lake(), 60, 25)
    landscape.picture(lake(), 60, 25)
    assert landscape.tints == usual.tints
    assert Drawn(lake(), 60, 17, Layer.LANDSCAPE).table.shown_layer is Layer.Q


def test_it_is_left_out_in_small_cells_few_colours_and_other_worlds() -> None:
    assert has_landscape(lake().world, Size(5, 2), look())
    assert has_landscape(lake().world, Size(5, 2), look(depth="256"))
    for world, cell, with_look in (
        (lake().world, Size(4, 2), look()),
        (lake().world, Size(5, 1), look()),
        (lake().world, None, look()),
        (lake().world, Size(5, 2), look(depth="16")),
        (lake().world, Size(5, 2), look(depth="none")),
        (lake().world, Size(5, 2), look(ascii=True)),
        (student().world, Size(5, 2), look()),
    ):
        assert not has_landscape(world, cell, with_look)


def test_with_256_colours_it_has_no_others() -> None:
    view = view_of(big_lake(), look(depth="256"))
    for strip in drawn(big_lake(), view)[:24]:
        for column in range(56):
            style = style_at(strip, column)
            assert style is not None
            assert style.bgcolor is None or style.bgcolor.type is not ColorType.TRUECOLOR


@pytest.mark.parametrize("width", [5, 6, 7, 8])
def test_signs_stay_in_their_cells(width: int) -> None:
    view = view_of(big_lake(), cell=Size(width, 2))
    view.differing, view.cursor = frozenset(range(64)), 0
    stops = replace(big_lake().playback.breakpoints, states=frozenset(range(64)))
    shown = replace(big_lake(), playback=replace(big_lake().playback, breakpoints=stops))
    strips = view.picture(shown, 66, 17)
    assert [strip.cell_length for strip in strips] == [66] * 17
    assert [len(strip.text) for strip in strips] == [66] * 17
    texts = [strip.text for strip in strips[:16]]
    left = min(len(text) - len(text.lstrip()) for text in texts)
    assert sum(text[left] == look().glyphs.differs for text in texts) == 8


def test_nobody_draws_in_a_landscape() -> None:
    view = view_of(lake())
    view.title = ("You draw the world",)
    assert not view.has_landscape
    assert "▀" * 7 not in "".join(strip.text for strip in drawn(lake(), view))


def test_what_did_not_change_is_not_worked_out_again(monkeypatch: pytest.MonkeyPatch) -> None:
    shown, calls = big_lake(), []
    monkeypatch.setattr(
        "rl_tui.screen.panels.grid.landscape.pixels", lambda *given: calls.append(1) or pixels(*given)
    )
    view = view_of(shown)
    before = drawn(shown, view)
    moved = replace(shown, counters=replace(shown.counters, state=0))
    after = drawn(moved, view)
    assert len(calls) == 1
    assert sum(old != new for old, new in zip(before, after, strict=True)) == 2
