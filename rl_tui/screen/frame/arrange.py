"""The place of every panel on the screen.

World and table are in an upper band, curve and agent in a lower one. Regions are in characters from the upper
left corner. The first row is the header, the last one has the keys.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Final

from textual.geometry import Region, Size

from rl_tui.screen.frame.shape import (
    MEDIUM,
    ROOMY,
    ROOMY_WIDTH,
    SMALL,
    Arrangement,
    ScreenPlan,
    Shape,
    cell_size,
    docks_lesson,
    map_size,
)
from rl_tui.screen.kit.row import (
    BUDGET,
    CAPTION,
    CURVE,
    DRAW,
    LAST_STEP,
    LESSON,
    TABLE,
    TIMELINE,
    WORLD,
    beside,
)
from rl_tui.screen.panels.arm_bars import rows_an_arm
from rl_tui.screen.panels.graph.chain import chain_rows
from rl_tui.screen.panels.margins import wanted_margins
from rl_tui.worlds.drawing import Arms, Axes, Body, Graph, Grid

_LEAST_BELOW: Final = {MEDIUM: 5, ROOMY: 10}  # rows of the lower band
_LEAST_BELOW_LANES: Final = 8  # rows of the lower band of medium size: with fewer, lines of runs are a braid
_LEAST_BELOW_WIDE_MAP: Final = {SMALL: 5, MEDIUM: 7, ROOMY: 12}
_BESIDE_PAGE: Final = 12  # rows of curve and table beside a lesson page at the right, or below two worlds
_LEAST_SCROLLING: Final = {MEDIUM: 1, ROOMY: 4}  # least rows of the lower band: sliders
_BELOW_A_WORLD: Final = 19  # rows of a panel below the world, beside a page of a lesson
_BELOW_LANES: Final = 18  # rows below the worlds of two runs that leave space for tables
# rows of the upper band if the table needs them beside a low map
_UPPER: Final = {SMALL: 18, MEDIUM: 13, ROOMY: 16}
_MOST_CURVE: Final = 16
_CURVE_BESIDE_PANEL: Final = {MEDIUM: 5, ROOMY: 10}  # most rows, not to outgrow the map
_LAST_STEP: Final = 8  # rows of the full text
_SHORT_STEP: Final = 3
_BUDGET: Final = 6
_LEAST_SETTINGS: Final = 5
_LEAST_CURVE: Final = {MEDIUM: 4, ROOMY: 6}  # rows with its timeline; with fewer it is below the table
_CURVE_AT_RIGHT: Final = {MEDIUM: (5, 1), ROOMY: (11, 0)}  # its rows, and of sliders below all else
_TABLE_KEPT: Final = 12  # rows that the table keeps when others share its column
_AROUND_A_TABLE: Final = 8  # rows: heads, legend, layers
_AROUND_ROWS: Final = 3  # the same at medium sizes
_SHARE: Final = 0.235  # of the screen; a smaller map takes rows of the lower band
_LEAST_PANEL: Final = {MEDIUM: 40, ROOMY: 44}  # columns, if the map gets larger cells
_PANEL_COLUMNS: Final = (44, 60)
_GLANCE_COLUMNS: Final = (48, 60)  # of a page beside a small map
_PANEL_SHARE: Final = 0.4
_BESIDE_A_GRAPH: Final = 36  # columns; more would turn the boxes of a graph into a list
_TALLER: Final = 1.5  # times: a wide map goes above all else if its cells get this much higher
_LARGER: Final = 1.3  # times: two maps are stacked if their cells get this much larger
_BESIDE_MAPS: Final = 28  # columns
_TOOLS: Final = 14  # rows of the tools beside another open panel


def arrange(
    size: Size,
    shape: Shape,
    opened: str | None = None,
    *,
    zoomed: str | None = None,
    wide_rows: int = 0,
) -> Arrangement:
    """Return the place of every panel.

    Args:
        size: Columns and rows.
        shape: Properties of world and run.
        opened: Panel opened by its key.
        zoomed: Panel in full screen.
        wide_rows: Rows for ``opened`` in the lower band of a roomy screen, 0 for the right column.
    """
    sheet = ScreenPlan(size, shape)
    if zoomed is not None:
        return sheet.alone(zoomed)
    if shape.has_lesson and not docks_lesson(size, shape.shown):
        if shape.reads and shape.spotlight in (WORLD, None) and sheet.room is MEDIUM:
            glance = replace(shape, shown=frozenset({WORLD}), lanes=False, is_drawn=False)
            return _Bands(ScreenPlan(size, glance), None, 0, glances=True).place()
        if shape.reads:
            return sheet.page()
        sheet.put(LESSON, Region(0, 1, size.width, 1))
        sheet.top = 2
    if sheet.room is SMALL and opened is not None:
        sheet.put(opened, Region(sheet.margin, sheet.top, sheet.usable, sheet.foot - sheet.top))
        return Arrangement(sheet.regions, Size(0, 0))
    if opened is not None and sheet.room is not ROOMY:
        sheet.lanes = False
    is_wide = sheet.room is ROOMY and not (shape.has_lesson or shape.is_drawn or sheet.lanes)
    if shape.is_fresh and shape.has_lesson and sheet.room is ROOMY and shape.shown is None:
        sheet.shape = shape.at_first()
    return _Bands(sheet, opened, wide_rows if is_wide else 0).place()


class _Bands:
    def __init__(
        self, sheet: ScreenPlan, opened: str | None, wide_rows: int, *, glances: bool = False
    ) -> None:
        self.sheet, self.shape, self.room = sheet, sheet.shape, sheet.room
        self.glances = glances  # a page points at the small map beside it
        self.wide, self.wide_rows = opened if wide_rows else None, wide_rows
        self.drawing = self.shape.drawing
        docked = LESSON if self.shape.has_lesson and docks_lesson(sheet.size, self.shape.shown) else None
        tools = DRAW if self.shape.is_drawn and self.room is not SMALL else None
        self.table = DRAW if self.shape.is_drawn and self.room is SMALL else TABLE
        """The panel to the right of the world."""
        self.below_page = opened or tools if docked else None
        """The panel below the world, if a lesson page has the right column."""
        self.aside = docked or (None if self.wide else opened) or tools
        """The panel that has the right column in both bands."""
        self.extra_tools = (
            tools if self.aside not in (None, tools) and not docked and self.room is ROOMY else None
        )
        if sheet.lanes and self.aside is not None:
            self.below_page, self.aside = (self.below_page, self.aside) if docked else (self.aside, None)
        steps_below = bool(docked) or self.room is SMALL
        has_column = self.aside or sheet.shows(TABLE) or (sheet.shows(LAST_STEP) and not steps_below)
        self.is_alone = self.shape.shown is not None and not has_column
        self.has_band = sheet.shows(CURVE) or sheet.shows(TABLE)
        lower = (CURVE, self.shape.settings, *([LAST_STEP] if steps_below else []))
        self.has_lower = bool(self.below_page) or any(sheet.shows(each) for each in lower)
        self.wind = int(isinstance(self.drawing, Grid) and bool(self.drawing.wind))
        self.is_place = isinstance(self.drawing, Grid) and not self.drawing.legend
        self.chain = len(self.drawing.chain) if isinstance(self.drawing, Graph) else 0
        self.least, self.most = self._columns()
        self._most_curve = _MOST_CURVE if self.aside is None else _CURVE_BESIDE_PANEL[self.room]

    def _columns(self) -> tuple[int, int]:
        width = self.sheet.size.width
        if self.aside is not None:
            least, most = _GLANCE_COLUMNS if self.glances else _PANEL_COLUMNS
            if isinstance(self.drawing, Graph) and self.room is MEDIUM:
                least = _BESIDE_A_GRAPH
            columns = max(least, min(most, round(width * _PANEL_SHARE)))
            return min(_LEAST_PANEL[self.room], columns), columns
        is_arms = isinstance(self.drawing, Arms)
        least = 24 if is_arms else 4 + 6 * min(self.shape.actions, 4)
        most = 40 if is_arms else 6 + 10 * min(self.shape.actions, 4)
        least = max(26 if self.room is SMALL else 30, least)
        if self.room is SMALL:
            return least, least
        if self.room is MEDIUM:
            return least, max(least, 33 if width < ROOMY_WIDTH else 44)
        return least, max(44, min(most, 46 if width < 150 else 56))

    def place(self) -> Arrangement:
        sheet = self.sheet
        room, below = self._world_room(), self._least_below()
        scale = self._scale_rows(below)
        extra = scale + self.wind
        cell, below = self._cell_and_rows_below(room, below, extra)
        stacked = self._stacked_cell(cell, extra)
        if stacked is not None:
            return self._on_top(stacked, extra)
        height = self._height(below, extra)
        above = self._cell_above_another(height)
        is_over = above is not None and above.area > _LARGER * cell.area
        if above is not None and is_over:
            cell, room = above, sheet.usable - _BESIDE_MAPS
        picture = self._picture(cell, room, height)
        columns = self._right_columns(picture.width)
        left = sheet.usable - (columns + sheet.gap if columns else 0)
        upper = (2 if is_over else 1) * (picture.height + extra)
        if self.aside is None and not sheet.lanes:
            beside = min(_UPPER[self.room], self.shape.table_rows + _AROUND_ROWS)
            upper = max(upper, min(beside, height + extra))
        self._put_world(picture, extra, left, room, is_over=is_over)
        low = sheet.top + upper + (sheet.blank if below else 0)
        if columns and self._has_curve_at_right(low):
            upper = sheet.foot - sheet.top - sum(_CURVE_AT_RIGHT[self.room]) - sheet.blank
        self._put_right(columns, upper if self.has_lower else sheet.foot - sheet.top)
        if sheet.lanes and self.aside is None and self.below_page is None and not is_over:
            low = self._put_tables(low, room)
        self._put_lower(low, left, columns)
        return Arrangement(sheet.regions, cell)

    def _has_curve_at_right(self, low: int) -> bool:
        return self._is_plain and self.room is not SMALL and self.sheet.foot - low < _LEAST_CURVE[self.room]

    @property
    def _is_plain(self) -> bool:
        return not (self.shape.shown is not None or self.sheet.lanes or self.aside or self.wide)

    def _height(self, below: int, extra: int) -> int:
        sheet = self.sheet
        return sheet.foot - sheet.top - below - extra - (sheet.blank if below else 0)

    def _cell_and_rows_below(self, room: int, below: int, extra: int) -> tuple[Size, int]:
        cell = self._cell(room, self._height(below, extra))
        if not self.is_small(cell) or below != _LEAST_BELOW[self.room]:
            return cell, below
        heights = range(below, _LEAST_SCROLLING[ROOMY] - 1, -1)
        last = [(False, _LEAST_SCROLLING[self.room])] if self._is_plain else []
        for is_broad, rows in (*product((False, True), heights), *last):
            larger = self._cell(room, self._height(rows, extra), is_broad=is_broad)
            if not self.is_small(larger):
                return larger, rows
        return cell, below

    def is_small(self, cell: Size) -> bool:
        drawing = self.drawing
        if not isinstance(drawing, Grid) or not self.is_place or self.aside or self.wide or self.sheet.lanes:
            return False
        area = cell.area * drawing.rows * drawing.columns
        return self.room is not SMALL and area < _SHARE * self.sheet.size.area

    # The world

    def _least_below(self) -> int:
        sheet = self.sheet
        if self.glances:
            return (sheet.foot - sheet.top) // 4
        if not self.has_lower:
            return 0
        if self.wide is not None:
            return self.wide_rows + 2  # with timeline and sliders
        if self.below_page is not None:
            return min(_BELOW_A_WORLD, (sheet.foot - sheet.top) // 2)
        if self.aside == LESSON and not self.has_band:
            return sheet.shows(self.shape.settings) + (_SHORT_STEP + 1) * sheet.shows(LAST_STEP)
        if self.aside == LESSON and (self.shape.shown is None or self.shape.is_fresh):
            return _BESIDE_PAGE + 2
        grid, height = self.drawing, sheet.foot - sheet.top
        rows = grid.rows + wanted_margins(grid, height).above if isinstance(grid, Grid) else 0
        if self.room is SMALL:
            return len(self._lines)
        may_take = self._is_plain or (self.room is ROOMY and self.aside is None)
        if may_take and not self.is_place and rows >= height - _LEAST_BELOW[self.room]:
            return _LEAST_SCROLLING[self.room]
        if sheet.lanes and self.room is MEDIUM:
            return _LEAST_BELOW_LANES
        is_captioned = self.room is MEDIUM and CAPTION in sheet.regions  # elsewhere it costs rows of the map
        return _LEAST_BELOW[self.room] - is_captioned

    def _world_room(self) -> int:
        sheet = self.sheet
        if sheet.lanes:
            usable = sheet.usable - (self.least + sheet.gap if self.aside else 0)
            return (usable - sheet.gap) // 2
        if self.is_alone:
            return sheet.usable
        beside = (self.least + self.most) // 2 if isinstance(self.drawing, Graph) else self.most
        return sheet.usable - sheet.gap - (self.least if isinstance(self.drawing, Grid) else beside)

    def _scale_rows(self, below: int) -> int:
        """Return 0 where a scale would cost the third row of each cell, else 1."""
        drawing, rows = self.drawing, self.sheet.foot - self.sheet.top - below
        is_tight = isinstance(drawing, Grid) and drawing.rows * 3 <= rows < drawing.rows * 3 + 1
        return 0 if self.room is SMALL and is_tight else 1

    def _cell(self, width: int, height: int, *, is_broad: bool = False) -> Size:
        if not isinstance(self.drawing, Grid):
            return Size(0, 0)
        return map_size(self.drawing, width, height, is_broad=is_broad).cell

    def _stacked_cell(self, cell: Size, extra: int) -> Size | None:
        """Return the cell of a map above all else, if much higher."""
        sheet = self.sheet
        if sheet.lanes or self.aside or self.wide or self.shape.shown is not None:
            return None
        if not self.is_place:
            return cell if self.chain else None
        stacked = self._cell(sheet.usable, self._rows_on_top(extra))
        is_better = stacked.height >= _TALLER * cell.height and stacked.width >= cell.width
        return stacked if is_better or (self.is_small(cell) and stacked.area > cell.area) else None

    def _rows_on_top(self, extra: int) -> int:
        sheet = self.sheet
        return sheet.foot - sheet.top - _LEAST_BELOW_WIDE_MAP[self.room] - extra - 1

    def _cell_above_another(self, height: int) -> Size | None:
        drawing = self.drawing
        if not isinstance(drawing, Grid) or not self.is_place or self.aside or not self.sheet.lanes:
            return None
        width = self.sheet.usable - _BESIDE_MAPS
        return cell_size(drawing.rows * 2, drawing.columns, width, height - 1 - self.wind)

    def _picture(self, cell: Size, room: int, height: int) -> Size:
        match self.drawing:
            case Grid(axes=Axes()) | Grid(body=Body()) as grid:
                return map_size(grid, room, height).picture
            case Grid(rows=rows, columns=columns):
                return Size(min(room, cell.width * columns), min(height, cell.height * rows))
            case Arms(count=arms):
                return Size(room, min(height, arms * rows_an_arm(arms, height) + 1))
            case Graph() if self.chain:
                return Size(room, min(height, chain_rows(self.chain, room) + self.sheet.blank))
            case _:
                return Size(room, height)

    def _put_world(self, picture: Size, extra: int, left: int, room: int, *, is_over: bool) -> None:
        sheet = self.sheet
        x = sheet.margin
        if self.is_alone and self.room is ROOMY and picture.width < left:
            x += (left - picture.width) // 2
        wide = left if is_over else max(picture.width, room if sheet.lanes else min(left, 40))
        region = Region(x - 1, sheet.top, min(wide, left) + 1, picture.height + extra)
        sheet.put(WORLD, region)
        if is_over:
            sheet.put(beside(WORLD), region.translate((0, region.height)))
        elif sheet.lanes:
            sheet.put(beside(WORLD), region.translate((room + sheet.gap, 0)))

    # The right column

    def _right_columns(self, picture: int) -> int:
        sheet = self.sheet
        if self.is_alone or (sheet.lanes and self.aside is None):
            return 0
        if sheet.lanes:
            return self.least
        return max(self.least, min(self.most, sheet.usable - sheet.gap - picture))

    def _put_right(self, columns: int, upper: int) -> None:
        sheet = self.sheet
        if not columns:
            return
        x = sheet.size.width - sheet.margin - columns
        if self.aside is not None:
            rows = sheet.foot - sheet.top - (_TOOLS + 1 if self.extra_tools else 0)
            sheet.put(self.aside, Region(x, sheet.top, columns, rows))
            if self.extra_tools is not None:
                sheet.put(self.extra_tools, Region(x, sheet.top + rows + 1, columns, _TOOLS))
            return
        kept = min(self.shape.table_rows + 2, _TABLE_KEPT)
        bottom = sheet.top + upper
        below: list[tuple[str, int]] = []
        rows = upper
        for panel, sizes in self._below_table():
            high = next((each for each in sizes if rows - each - sheet.blank >= kept), 0)
            if high and sheet.shows(panel):
                below.append((panel, high))
                rows -= high + sheet.blank
        for panel, high in below:
            sheet.put(panel, Region(x, bottom - high, columns, high))
            bottom -= high + sheet.blank
        if sheet.shows(self.table):
            self._put_table(Region(x, sheet.top, columns, bottom - sheet.top))

    def _put_table(self, region: Region) -> None:
        rows = self.shape.table_rows + _AROUND_A_TABLE if self.room is ROOMY else region.height
        self.sheet.put(self.table, Region(*region[:3], min(region.height, rows)))

    def _below_table(self) -> list[tuple[str, tuple[int, ...]]]:
        panels: list[tuple[str, tuple[int, ...]]] = []
        if self.wide is None and self.room is not SMALL:
            panels.append((LAST_STEP, (_LAST_STEP,) if self.room is ROOMY else (_LAST_STEP, _SHORT_STEP)))
        if isinstance(self.drawing, Arms):
            panels.append((BUDGET, (_BUDGET,)))
        return panels

    def _put_tables(self, low: int, room: int) -> int:
        """Put two tables if they fit, and return the next free row."""
        sheet, least = self.sheet, _BELOW_LANES + min(self.shape.table_rows, 6)
        if sheet.foot - low < least:
            return low
        rows = min(self.shape.table_rows + 2, sheet.foot - low - 14)
        sheet.put(TABLE, Region(sheet.margin, low, room, rows))
        sheet.put(beside(TABLE), Region(sheet.margin + room + sheet.gap, low, room, rows))
        return low + rows + 1

    # The lower band

    def _put_lower(self, low: int, left: int, columns: int) -> None:
        sheet, x, foot, shape = self.sheet, self.sheet.margin, self.sheet.foot, self.shape
        if self.wide is not None:
            sheet.put(self.wide, Region(x, low, sheet.usable, foot - 2 - low))
            sheet.put(TIMELINE, Region(x, foot - 2, sheet.usable, 1))
            sheet.put(shape.settings, Region(x, foot - 1, sheet.usable, 1))
        elif not self.has_lower:
            return
        elif self.room is SMALL:
            self._put_lines()
        elif columns and self.aside is None:
            at = sheet.size.width - sheet.margin - columns
            if self._has_curve_at_right(low):
                curve, below = _CURVE_AT_RIGHT[self.room]
                self._put_curve(foot - below - curve, foot - below, columns, at)
                rows, width = (below, sheet.usable) if below else (foot - low, left)
                sheet.put(shape.settings, Region(x, foot - rows, width, rows))
                return
            y = low
            for panel, rows in self._above_settings():
                if foot - y - rows - sheet.blank >= _LEAST_SETTINGS:
                    sheet.put(panel, Region(at, y, columns, rows))
                    y += rows + sheet.blank
            if sheet.shows(shape.settings):
                sheet.put(shape.settings, Region(at, y, columns, foot - y))
            self._put_curve(low, foot, left)
        else:
            self._put_below_lanes_or_page(low, left)

    def _above_settings(self) -> list[tuple[str, int]]:
        taken = self.sheet.regions
        panels = [(LAST_STEP, _LAST_STEP)] if self.sheet.shows(LAST_STEP) else []
        panels += [(BUDGET, _BUDGET)] if isinstance(self.drawing, Arms) else []
        return [each for each in panels if each[0] not in taken]

    def _put_below_lanes_or_page(self, low: int, width: int) -> None:
        sheet, foot, x, shape = self.sheet, self.sheet.foot, self.sheet.margin, self.shape
        if sheet.shows(shape.settings):
            foot -= 1
            sheet.put(shape.settings, Region(x, foot, width, 1))
        if LAST_STEP not in sheet.regions and sheet.shows(LAST_STEP):
            is_beside = self.aside is not None and self.below_page is None
            kept = self.has_band * (self._most_curve + 1 + sheet.blank if is_beside else _BESIDE_PAGE)
            sizes = (_LAST_STEP, _SHORT_STEP, 1) if is_beside else (1,)
            rows = next((each for each in sizes if foot - low - each >= kept), 0)
            foot -= rows
            sheet.put(LAST_STEP, Region(x, foot, width, rows))
            foot -= sheet.blank if rows > 1 else 0
        if self.below_page is not None and self.aside == LESSON:
            if sheet.shows(TIMELINE):
                foot -= 1
                sheet.put(TIMELINE, Region(x, foot, width, 1))
            sheet.put(self.below_page, Region(x, low, width, foot - low))
            return
        second = self.below_page
        if second is None and self.aside == LESSON and not sheet.lanes and sheet.shows(TABLE):
            second = TABLE
        if second is None and sheet.lanes and self.room is ROOMY and isinstance(self.drawing, Arms):
            second = BUDGET
        if second is not None:
            half = max(min(4 + 6 * min(shape.actions, 4), width // 2), (width - sheet.gap) // 2)
            sheet.put(second, Region(x + width - half, low, half, foot - low))
            width -= half + sheet.gap
        self._put_curve(low, foot, width)

    def _put_curve(self, low: int, foot: int, width: int, x: int | None = None) -> None:
        sheet, x = self.sheet, self.sheet.margin if x is None else x
        if not sheet.shows(CURVE):
            return
        rows = min(self._most_curve, foot - 1 - low)
        sheet.put(CURVE, Region(x, low, width, rows))
        sheet.put(TIMELINE, Region(x, low + rows, width, 1))

    @property
    def _lines(self) -> list[str]:
        return [each for each in (LAST_STEP, self.shape.settings, CURVE) if self.sheet.shows(each)]

    def _put_lines(self) -> None:
        sheet, x, width = self.sheet, self.sheet.margin, self.sheet.usable
        half = width // 2
        for y, panel in enumerate(self._lines, sheet.foot - len(self._lines)):
            if panel == CURVE:
                sheet.put(CURVE, Region(x, y, half - 1, 1))
                sheet.put(TIMELINE, Region(x + half, y, width - half, 1))
            else:
                sheet.put(panel, Region(x, y, width, 1))

    def _on_top(self, cell: Size, extra: int) -> Arrangement:
        sheet, x, foot = self.sheet, self.sheet.margin, self.sheet.foot
        picture = self._picture(cell, sheet.usable, self._rows_on_top(extra))
        sheet.put(WORLD, Region(x - 1, sheet.top, sheet.usable + 1, picture.height + extra))
        low = sheet.top + picture.height + extra + sheet.blank
        sheet.put(LAST_STEP, Region(x, low, sheet.usable, 1))
        low += 1 + (1 if self.room is ROOMY and foot - low - 1 >= 12 else 0)
        if self.room is not ROOMY:
            foot -= 1
            sheet.put(self.shape.settings, Region(x, foot, sheet.usable, 1))
        right = 32 if self.room is SMALL else self.most
        left, at, rows = sheet.usable - right - sheet.gap, sheet.size.width - sheet.margin - right, foot - low
        agent = 0 if self.room is not ROOMY else 6 if rows >= 14 else 4
        self._put_table(Region(at, low, right, rows - agent - bool(agent)))
        if agent:
            sheet.put(self.shape.settings, Region(at, foot - agent, right, agent))
        if self.room is SMALL:
            sheet.put(CURVE, Region(x, low, left, rows - 1))
            sheet.put(TIMELINE, Region(x, foot - 1, left, 1))
        else:
            self._put_curve(low, foot, left)
        return Arrangement(sheet.regions, cell)
