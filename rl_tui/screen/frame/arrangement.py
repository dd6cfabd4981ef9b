"""Where the panels stand: a pure function of the size, of what there is to show and of their table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from textual.geometry import Region, Size

from rl_tui.screen.kit.row import (
    BUDGET,
    CONTROLS,
    CURVE,
    DRAW,
    LAST_STEP,
    LESSON,
    PROGRAM,
    TABLE,
    TIMELINE,
    WORLD,
    PanelRow,
    beside,
)
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.worlds.drawing import Arms, Drawing, Grid
from rl_tui.worlds.sections.schema import WorldSection

ROOMY_WIDTH: Final = 100
ROOMY_HEIGHT: Final = 32

_BORDERS = 2
_CONTROLS_ROWS = 8  # six lines and their borders
_LAST_STEP_ROWS = (10, 8)  # the longest form and the one that takes less, with their borders
_LEAST_TABLE = 18  # beside controls and a budget, where the last step has its longest form
_BUDGET_ROWS = 6
_LINES_BELOW = 3  # compact: sliders, settings, last step; a line each, without borders
_SETTINGS_LINES = 2
_LEAST_CURVE = 12  # with the timeline
_TIMELINE_ROWS = 1
_LEAST_PAIR_WIDTH = 76  # for two worlds side by side
_LEAST_PAIR_HEIGHT = 20
_LEAST_PAIR_CURVE = 9  # with the timeline
_LEAST_PAIR_TABLE = 8
_NOTE_ROWS = 2  # what is noted below a list may be left out
_LEAST_TALL_CELL = 8  # a cell of a map that is narrower gains nothing by a third row
_LEAST_WIDE = 20  # rows of a panel that has the whole width
_LESSON_COLUMNS = (40, 56)
_LESSON_ROWS = 1  # where page and world take turns
_LEAST_TALL = 30  # rows that are more than lines below need: the last step has its border then


@dataclass(frozen=True, slots=True)
class Shape:
    """What the arrangement depends on besides the size; ``table_rows`` is what the whole table takes.

    Where there is room for it, the world has ``legend_rows`` more than its picture takes. With ``lanes`` two
    runs are to stand side by side. Of a program that is watched there is nothing to set. With ``has_lesson``
    a page stands beside the world; where there is no room for both, ``reads`` says that the page has it.
    While a person draws the world, it ``is_drawn``: then there is a panel of tools.
    """

    drawing: Drawing | None = None
    table_rows: int = 11
    legend_rows: int = 0
    lanes: bool = False
    is_program: bool = False
    has_lesson: bool = False
    reads: bool = False
    is_drawn: bool = False

    @property
    def settings(self) -> str:
        """The id of the panel that says by what the agent learns."""
        return PROGRAM if self.is_program else CONTROLS


def expected_shape(
    section: WorldSection, *, has_legends: bool, lanes: bool, is_program: bool, has_lesson: bool
) -> Shape:
    """Return what is known of the shape before the world of ``section`` is built."""
    return Shape(
        drawing=section.sketch(),
        legend_rows=int(has_legends),
        lanes=lanes,
        is_program=is_program,
        has_lesson=has_lesson,
        reads=has_lesson,
    )


def is_roomy(size: Size) -> bool:
    """Return whether there is room for bordered controls and a last step of several lines."""
    return size.width >= ROOMY_WIDTH and size.height >= ROOMY_HEIGHT


def docks_lesson(size: Size) -> bool:
    """Return whether there is room for a page of a lesson beside the world."""
    return is_roomy(size)


def has_lines_below(size: Size, shape: Shape) -> bool:
    """Return whether settings stand in lines without a border below all else, unless two lanes do."""
    return not is_roomy(beside_lesson(size, shape).size)


def beside_lesson(size: Size, shape: Shape) -> Region:
    """Return what a lesson leaves to the run: all but its page, or but a row that tells of it."""
    if not shape.has_lesson:
        return size.region
    if docks_lesson(size):
        return Region(0, 0, size.width - _lesson_columns(size), size.height)
    return Region(0, _LESSON_ROWS, size.width, max(0, size.height - _LESSON_ROWS))


def _lesson_columns(size: Size) -> int:
    least, most = _LESSON_COLUMNS
    return max(least, min(most, round(size.width * 44 / 120)))


def arrangement(
    size: Size,
    shape: Shape,
    zoomed: str | None = None,
    opened: str | None = None,
    panels: Iterable[PanelRow] = PANELS,
) -> dict[str, Region]:
    """Return the region of each of ``panels`` by its id; those that are not shown are left out.

    What a lesson leaves is arranged as all would be without it. The others are as in :func:`_of_run`.
    """
    if not shape.has_lesson:
        return _of_run(size, shape, zoomed, opened, panels)
    if zoomed == LESSON or (shape.reads and not docks_lesson(size)):
        return {LESSON: size.region}
    rest = beside_lesson(size, shape)
    regions = _of_run(rest.size, shape, zoomed, opened, panels)
    page = (
        Region(rest.width, 0, size.width - rest.width, size.height)
        if docks_lesson(size)
        else Region(0, 0, size.width, rest.y)
    )
    return {name: region.translate(rest.offset) for name, region in regions.items()} | {LESSON: page}


def _of_run(
    size: Size,
    shape: Shape,
    zoomed: str | None,
    opened: str | None,
    panels: Iterable[PanelRow],
) -> dict[str, Region]:
    """Return the regions of the panels of the run.

    The one ``zoomed`` covers all others. The one ``opened`` by its key stands as its row says; two lanes side
    by side make room for it at the right of the curve, unless it stands in place of a world: then there is
    one lane.
    """
    if zoomed in (CURVE, TIMELINE):
        return _curve_and_timeline(0, size.width, size.height)
    if zoomed is not None:
        return {zoomed: Region(0, 0, size.width, size.height)}
    rows = {row.id: row for row in panels}
    budget = _BUDGET_ROWS if rows[BUDGET].needs(shape.drawing) else 0
    if _is_pair(size, shape) and (opened is None or WORLD not in rows[opened].in_place_of):
        usual = DRAW if shape.is_drawn else BUDGET if budget and is_roomy(size) else None
        return _pair(size, shape, opened or usual)
    regions = (_roomy if is_roomy(size) else _compact)(size, shape, budget)
    if opened is not None and rows[opened].is_wide and is_roomy(size):
        return _above_wide(size, shape, opened)
    if opened is not None:
        regions = _in_place_of(rows[opened].in_place_of, opened, regions) or {opened: size.region}
    if shape.is_drawn:
        # where controls stand there: meanwhile most of their keys draw
        place = (CONTROLS, LAST_STEP) if is_roomy(size) else (TABLE, BUDGET)
        regions = _in_place_of(place, DRAW, regions) or regions
    return regions


def _in_place_of(panels: Iterable[str], panel: str, regions: Mapping[str, Region]) -> dict[str, Region]:
    """Return ``regions`` with ``panel`` where ``panels`` stood; nothing where none of them does."""
    taken = [regions[each] for each in panels if each in regions]
    rest = {name: region for name, region in regions.items() if name not in panels}
    return rest | {panel: Region.from_union(taken)} if taken else {}


def _is_pair(size: Size, shape: Shape) -> bool:
    return shape.lanes and size.width >= _LEAST_PAIR_WIDTH and size.height >= _LEAST_PAIR_HEIGHT


def _pair(size: Size, shape: Shape, aside: str | None) -> dict[str, Region]:
    """Return two worlds, two tables where there is room, and one curve; ``aside`` stands at its right."""
    width, height = size
    left, body = width // 2, height - _LINES_BELOW
    if is_roomy(size):
        least = min(shape.table_rows + 1 + _BORDERS, _LEAST_PAIR_TABLE)
        world = _world_rows(shape, body - least, _LEAST_PAIR_CURVE, most_lines=_most_lines(shape, left))
        table = _pair_table_rows(shape, body - world)
    else:
        world = _world_rows(shape, body, least_curve=max(6, body * 7 // 19))
        table = 0
    regions = {}
    for panel, y, rows in ((WORLD, 0, world), (TABLE, world, table)):
        if rows:
            regions[panel] = Region(0, y, left, rows)
            regions[beside(panel)] = Region(left, y, width - left, rows)
    y = world + table
    curve = body - _TIMELINE_ROWS - y
    if aside is not None:
        regions[aside] = Region(left, y, width - left, curve)
    regions[CURVE] = Region(0, y, width if aside is None else left, curve)
    regions[TIMELINE] = Region(0, y + curve, width, _TIMELINE_ROWS)
    return regions | _lines_below(shape, width, body)


def _most_lines(shape: Shape, width: int) -> int:
    """Return how many rows a cell of a map in ``width`` columns is worth."""
    columns = shape.drawing.columns if isinstance(shape.drawing, Grid) else 1
    return 3 if (width - _BORDERS) // columns >= _LEAST_TALL_CELL else 2


def _pair_table_rows(shape: Shape, rows: int) -> int:
    """Return how many of ``rows`` the tables take: all they need, else about as many as the curve."""
    whole = shape.table_rows + 1 + _BORDERS
    for needed in (whole, whole - _NOTE_ROWS):
        if needed <= rows - _LEAST_PAIR_CURVE:
            return needed
    return rows - max(_LEAST_PAIR_CURVE, rows * 12 // 25)


def _lines_below(shape: Shape, width: int, y: int) -> dict[str, Region]:
    """Return controls and last step in lines without borders."""
    return {
        shape.settings: Region(0, y, width, _SETTINGS_LINES),
        LAST_STEP: Region(0, y + _SETTINGS_LINES, width, _LINES_BELOW - _SETTINGS_LINES),
    }


def _compact(size: Size, shape: Shape, budget: int) -> dict[str, Region]:
    width, height = size
    if shape.has_lesson and height >= _LEAST_TALL:
        return _tall(size, shape, budget)
    left, body = round(width * 42 / 80), max(0, height - _LINES_BELOW)
    world = _world_rows(shape, body, least_curve=max(6, body * 7 // 19))
    regions = _left_column(left, world, body) | _right_column(left, width - left, body, budget)
    return regions | _lines_below(shape, width, body)


def _tall(size: Size, shape: Shape, budget: int) -> dict[str, Region]:
    """Return the compact layout of a narrow board with rows to spare: the last step tells all it knows."""
    width, height = size
    left, last_step = round(width * 42 / 80), _LAST_STEP_ROWS[1]
    body = height - last_step - _SETTINGS_LINES
    world = _world_rows(shape, body, least_curve=max(6, body * 7 // 19))
    regions = _left_column(left, world, body) | _right_column(left, width - left, body, budget)
    return regions | {
        LAST_STEP: Region(0, body, width, last_step),
        shape.settings: Region(0, body + last_step, width, _SETTINGS_LINES),
    }


def _roomy(size: Size, shape: Shape, budget: int) -> dict[str, Region]:
    """Return one layout for all scenarios, so that no slider moves from one to the next."""
    width, height = size
    left = round(width * 62 / 120)
    world = _world_rows(shape, height, least_curve=_LEAST_CURVE)
    longest, shorter = _LAST_STEP_ROWS
    last_step = longest if height - longest - _CONTROLS_ROWS >= _LEAST_TABLE else shorter
    above = height - last_step - _CONTROLS_ROWS
    return (
        _left_column(left, world, height)
        | _right_column(left, width - left, above, budget)
        | {
            shape.settings: Region(left, above, width - left, _CONTROLS_ROWS),
            LAST_STEP: Region(left, above + _CONTROLS_ROWS, width - left, last_step),
        }
    )


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


def _world_rows(shape: Shape, height: int, least_curve: int, *, most_lines: int = 3) -> int:
    """Return the rows of the world panel: whole rows of what it draws, enough left for curve and timeline.

    A row of a map has ``most_lines``, or fewer. A legend has rows of its own where the curve has room enough:
    there nothing need be drawn smaller for it.
    """
    most = max(_BORDERS + 1, height - least_curve)
    legend = shape.legend_rows if least_curve >= _LEAST_CURVE else 0
    match shape.drawing:
        case Grid(rows=rows, wind=wind):
            below = _BORDERS + (1 if wind else 0)
            sizes = [rows * each + below + more for each in range(most_lines, 0, -1) for more in (legend, 0)]
        case Arms(count=arms):
            sizes = [each + _BORDERS + more for each in (arms * 2 + 1, arms) for more in (legend, 0)]
        case _:
            sizes = [height * 12 // 19 if least_curve < _LEAST_CURVE else height * 20 // 38]
    return next((rows for rows in sizes if rows <= most), most)
