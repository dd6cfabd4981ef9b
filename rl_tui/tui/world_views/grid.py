"""The map of a grid world: cells tinted by V(s), with the greedy actions as arrows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from rich.style import Style
from textual.strip import Strip

from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui import numbers
from rl_tui.tui.canvas import Canvas
from rl_tui.tui.scrolling import kept_in_view
from rl_tui.tui.theme.look import Look
from rl_tui.tui.world_views.grid_form import CellForm, cell_form
from rl_tui.tui.world_views.grid_map import CellContent, GridMap
from rl_tui.tui.world_views.state_values import fraction
from rl_tui.tui.world_views.view import WorldView
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.world import World

SEVERAL: Final = "+"  # in place of the arrows where they do not fit
START: Final = "S"
_ROOM_FOR_SMALL: Final = 6
_LEAST_SHOWN: Final = 0.005  # what is below would be rounded to .00


class GridView(WorldView):
    """A grid world. Where the map is larger than the panel, the part around the agent is drawn."""

    def __init__(
        self,
        world: World,
        look: Look,
        *,
        id: str | None = None,  # noqa: A002
        classes: str | None = None,
    ) -> None:
        if not isinstance(world.drawing, Grid):
            raise TypeError("a GridView draws worlds whose drawing is a Grid")
        super().__init__(world, look, id=id, classes=classes)
        self._map = GridMap(world.space, world.drawing)
        self._top = self._left = 0
        self._following = True
        self._whole = True
        self.heading = "World · V and greedy"

    def drawing(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        """Return the map, or the part of it that fits."""
        grid = self._map.grid
        form = cell_form(grid.rows, grid.columns, width, height)
        rows, columns = (
            min(grid.rows, max(1, height // form.height)),
            min(grid.columns, max(1, width // form.width)),
        )
        row, column = divmod(grid.cell_of_state[snapshot.state], grid.columns)
        self._top = kept_in_view(self._top, row if self._following else None, rows, grid.rows)
        self._left = kept_in_view(self._left, column if self._following else None, columns, grid.columns)
        self._whole = rows == grid.rows and columns == grid.columns
        self.footing = self._where()
        return draw_grid(
            self._map, snapshot, self.look, Part(self._top, self._left, rows, columns), form, width, height
        )

    def pan(self, rows: int, columns: int) -> None:
        """Scroll a map that is not whole in view; it then stands still until :meth:`follow`."""
        if self._whole:
            return
        self._following = False
        self._top += rows
        self._left += columns

    def follow(self) -> None:
        """Keep the agent in view again."""
        self._following = True

    def _where(self) -> str:
        if self._whole:
            return ""
        return "follows the agent" if self._following else "home: follow the agent"


@dataclass(frozen=True, slots=True)
class Part:
    """The rows × columns cells from (top, left) on."""

    top: int
    left: int
    rows: int
    columns: int


def draw_grid(
    grid_map: GridMap, snapshot: Snapshot, look: Look, part: Part, form: CellForm, width: int, height: int
) -> list[Strip]:
    """Return ``part`` of the map in the middle of width × height characters.

    The tints go from the least to the greatest value in ``part``, 0 included.
    """
    cells = [
        grid_map.content(row, column, snapshot)
        for row in range(part.top, part.top + part.rows)
        for column in range(part.left, part.left + part.columns)
    ]
    shown = [each.value for each in cells if each.value is not None and math.isfinite(each.value)]
    low, high = min(shown, default=0.0), max(shown, default=0.0)
    tints = Tints(look, min(low, 0.0), max(high, 0.0))
    canvas = Canvas(width, height, look.palette.text)
    x0 = max(0, (width - part.columns * form.width) // 2)
    y0 = max(0, (height - part.rows * form.height) // 2)
    for index, cell in enumerate(cells):
        row, column = divmod(index, part.columns)
        _draw_cell(canvas, x0 + column * form.width, y0 + row * form.height, cell, form, tints)
    return canvas.strips()


@dataclass(frozen=True, slots=True)
class Tints:
    """The style of a cell by its value, between ``low`` and ``high``."""

    look: Look
    low: float
    high: float

    def of(self, cell: CellContent) -> Style:
        """Return the style of the cell's ground and number."""
        palette = self.look.palette
        if cell.value is None:
            return {
                CellKind.HOLE: palette.hole,
                CellKind.GOAL: palette.goal,
                CellKind.WALL: palette.wall,
            }.get(cell.kind, palette.dim)
        if not cell.known:
            return palette.unvisited
        return palette.value(fraction(cell.value, self.low, self.high))


def _draw_cell(canvas: Canvas, x: int, y: int, cell: CellContent, form: CellForm, tints: Tints) -> None:
    look, style = tints.look, tints.of(cell)
    if cell.kind is CellKind.WALL:
        for row in range(form.height):
            canvas.put(x, y + row, look.glyphs.wall * form.width, style)
        return
    for row in range(form.height):
        canvas.put(x, y + row, " " * form.width, style)
    if form.height == 1:
        _draw_small(canvas, x, y, cell, form, look, style)
    else:
        _draw_large(canvas, x, y, cell, form, look, style)


def _draw_large(
    canvas: Canvas, x: int, y: int, cell: CellContent, form: CellForm, look: Look, style: Style
) -> None:
    """Draw arrows above the value, the mark beside the arrows."""
    row = y + (form.height - 1) // 2
    signs = _signs(cell, look, most=form.width - 2)
    start = x + (form.width - max(1, len(signs))) // 2
    canvas.put(start, row, signs, _sign_style(cell, look, style))
    _put_mark(canvas, start - (2 if form.width >= 10 else 1), row, cell, look, style)
    if cell.value is not None:
        text = _value_text(cell.value, 4 if form.width < 12 else 6, look)
        canvas.put(x + (form.width - len(text)) // 2, row + 1, text, style)


def _draw_small(
    canvas: Canvas, x: int, y: int, cell: CellContent, form: CellForm, look: Look, style: Style
) -> None:
    """Draw mark, arrows and value in one row."""
    if cell.value is None:
        middle = x + (form.width - 1) // 2
        canvas.put(middle, y, _signs(cell, look, most=1), style)
        _put_mark(canvas, middle - 1, y, cell, look, style)
        return
    digits = 3 if form.width < 8 else 4
    text = _value_text(cell.value, digits, look).rjust(digits)
    mark = 1 if _mark(cell, look) else 0
    # a blank before it all, so that neighbours keep apart without colours too
    signs = _signs(cell, look, most=max(1, form.width - digits - mark - 1))
    end = x + form.width - digits
    canvas.put(end, y, text, style)
    canvas.put(end - len(signs), y, signs, _sign_style(cell, look, style))
    _put_mark(canvas, end - max(1, len(signs)) - 1, y, cell, look, style)


def _value_text(x: float, width: int, look: Look) -> str:
    """Return a value; one too small for two decimals as a bound where there is no room for more."""
    if width < _ROOM_FOR_SMALL and numbers.NEGLIGIBLE <= x < _LEAST_SHOWN:
        return "<.01" if width >= len("<.01") else ".00"
    return numbers.value(x, width, look.glyphs, decimals=2)


def _signs(cell: CellContent, look: Look, most: int) -> str:
    """Return the arrows of the greedy actions, or what stands in a cell where nothing can be done."""
    if cell.value is None:
        return {CellKind.HOLE: look.glyphs.hole, CellKind.GOAL: look.glyphs.goal}.get(cell.kind, "")
    signs = "".join(look.glyphs.direction(each) if isinstance(each, tuple) else each for each in cell.greedy)
    return signs if len(signs) <= most else SEVERAL


def _sign_style(cell: CellContent, look: Look, style: Style) -> Style:
    return style if cell.value is None else style + Style(bold=True)


def _mark(cell: CellContent, look: Look) -> str:
    if cell.agent:
        return look.glyphs.agent
    return START if cell.kind is CellKind.START else ""


def _put_mark(canvas: Canvas, x: int, y: int, cell: CellContent, look: Look, style: Style) -> None:
    mark = _mark(cell, look)
    if mark:
        canvas.put(x, y, mark, style + (look.palette.agent if cell.agent else look.palette.start))
