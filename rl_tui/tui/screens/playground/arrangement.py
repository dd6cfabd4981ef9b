"""Where the panels stand: a pure function of the size, of what there is to show and of their table."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from textual.geometry import Region, Size

from rl_tui.tui.panels.catalogue import (
    BUDGET,
    CONTROLS,
    CURVE,
    LAST_STEP,
    PANELS,
    TABLE,
    TIMELINE,
    WORLD,
    PanelRow,
)
from rl_tui.worlds.drawing import Arms, Drawing, Grid

ROOMY_WIDTH: Final = 100
ROOMY_HEIGHT: Final = 32

_BORDERS = 2
_LOOP_ROWS = 8  # the six lines of the controls, or of the last step, and their borders
_BUDGET_ROWS = 6
_LINES_BELOW = 3  # compact: sliders, settings, last step; a line each, without borders
_LEAST_CURVE = 12  # with the timeline
_TIMELINE_ROWS = 1
_USUAL_TABLE = 15
_LEAST_WIDE = 20  # rows of a panel that has the whole width


@dataclass(frozen=True, slots=True)
class Shape:
    """What the arrangement depends on besides the size; ``table_rows`` is what the whole table takes.

    Where there is room for it, world and table have ``legend_rows`` more than their pictures take.
    """

    drawing: Drawing | None = None
    table_rows: int = 11
    arms: int = 0
    legend_rows: int = 0


def is_roomy(size: Size) -> bool:
    """Return whether there is room for bordered controls and a last step of several lines."""
    return size.width >= ROOMY_WIDTH and size.height >= ROOMY_HEIGHT


def arrangement(
    size: Size,
    shape: Shape,
    zoomed: str | None = None,
    opened: str | None = None,
    panels: Iterable[PanelRow] = PANELS,
) -> dict[str, Region]:
    """Return the region of each of ``panels`` by its id; those that are not shown are left out.

    The one ``zoomed`` covers all others. The one ``opened`` by its key stands as its row says.
    """
    if zoomed in (CURVE, TIMELINE):
        return _curve_and_timeline(0, size.width, size.height)
    if zoomed is not None:
        return {zoomed: Region(0, 0, size.width, size.height)}
    rows = {row.id: row for row in panels}
    budget = _BUDGET_ROWS if rows[BUDGET].needs(shape.drawing) else 0
    regions = (_roomy if is_roomy(size) else _compact)(size, shape, budget)
    if opened is None:
        return regions
    if rows[opened].is_wide and is_roomy(size):
        return _above_wide(size, shape, opened)
    taken = [regions.pop(panel) for panel in rows[opened].in_place_of if panel in regions]
    return regions | {opened: Region.from_union(taken)} if taken else {opened: size.region}


def _compact(size: Size, shape: Shape, budget: int) -> dict[str, Region]:
    width, height = size
    left, body = round(width * 42 / 80), max(0, height - _LINES_BELOW)
    world = _world_rows(shape, body, least_curve=max(6, body * 7 // 19))
    regions = _left_column(left, world, body) | _right_column(left, width - left, body, budget)
    regions[CONTROLS] = Region(0, body, width, 2)
    regions[LAST_STEP] = Region(0, body + 2, width, 1)
    return regions


def _roomy(size: Size, shape: Shape, budget: int) -> dict[str, Region]:
    width, height = size
    left = round(width * 62 / 120)
    table = shape.table_rows + 1 + _BORDERS
    if table > height - 2 * _LOOP_ROWS:
        body = height - _LOOP_ROWS
        world = _world_rows(shape, body, least_curve=_LEAST_CURVE)
        regions = _left_column(left, world, body) | _right_column(left, width - left, body, budget)
        regions[CONTROLS] = Region(0, body, left, _LOOP_ROWS)
        regions[LAST_STEP] = Region(left, body, width - left, _LOOP_ROWS)
        return regions
    world = _world_rows(shape, height, least_curve=_LEAST_CURVE)
    regions = _left_column(left, world, height)
    table = max(table + shape.legend_rows, min(world, _USUAL_TABLE))
    table = min(table, height - 2 * _LOOP_ROWS - budget)
    y = 0
    for panel, rows in (
        (TABLE, table),
        (CONTROLS, _LOOP_ROWS),
        (BUDGET, budget),
    ):
        if rows:
            regions[panel] = Region(left, y, width - left, rows)
            y += rows
    regions[LAST_STEP] = Region(left, y, width - left, height - y)
    return regions


def _above_wide(size: Size, shape: Shape, panel: str) -> dict[str, Region]:
    """Return world and table side by side above ``panel``, and the timeline below it."""
    width, height = size
    left, most = round(width * 62 / 120), height - _LEAST_WIDE
    top = max(_world_rows(shape, height, least_curve=_LEAST_WIDE), min(shape.table_rows + 1 + _BORDERS, most))
    return {
        WORLD: Region(0, 0, left, top),
        TABLE: Region(left, 0, width - left, top),
        panel: Region(0, top, width, height - top - _TIMELINE_ROWS),
        TIMELINE: Region(0, height - _TIMELINE_ROWS, width, _TIMELINE_ROWS),
    }


def _left_column(width: int, world: int, height: int) -> dict[str, Region]:
    return {WORLD: Region(0, 0, width, world)} | _curve_and_timeline(world, width, height - world)


def _curve_and_timeline(y: int, width: int, height: int) -> dict[str, Region]:
    curve = max(0, height - _TIMELINE_ROWS)
    return {
        CURVE: Region(0, y, width, curve),
        TIMELINE: Region(0, y + curve, width, height - curve),
    }


def _right_column(x: int, width: int, height: int, budget: int) -> dict[str, Region]:
    budget = min(budget, height // 2)
    regions = {TABLE: Region(x, 0, width, height - budget)}
    if budget:
        regions[BUDGET] = Region(x, height - budget, width, budget)
    return regions


def _world_rows(shape: Shape, height: int, least_curve: int) -> int:
    """Return the rows of the world panel: whole rows of what it draws, enough left for curve and timeline.

    A legend has rows of its own in a roomy terminal, where nothing need be drawn smaller for it.
    """
    most = max(_BORDERS + 1, height - least_curve)
    legend = shape.legend_rows if least_curve >= _LEAST_CURVE else 0
    match shape.drawing:
        case Grid(rows=rows, wind=wind):
            below = 1 if wind else 0
            sizes = [rows * each + below + _BORDERS + more for each in (3, 2, 1) for more in (legend, 0)]
        case Arms():
            sizes = [
                each + _BORDERS + more for each in (shape.arms * 2 + 1, shape.arms) for more in (legend, 0)
            ]
        case _:
            sizes = [height * 12 // 19 if least_curve < _LEAST_CURVE else height * 20 // 38]
    return next((rows for rows in sizes if rows <= most), most)
