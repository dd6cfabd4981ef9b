"""The inputs of an arrangement, and the cells of a map."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Final, NamedTuple

from textual.geometry import Region, Size

from rl_tui.screen.kit import row
from rl_tui.screen.panels.margins import LEAST_WITH_TITLES, wanted_margins
from rl_tui.worlds.drawing import Drawing, Grid

ROOMY_WIDTH: Final = 100
ROOMY_HEIGHT: Final = 36
MESSAGE_HEIGHT: Final = 30
"""Rows from which a message has its own row above the keys."""
MEDIUM_WIDTH: Final = 76
MEDIUM_HEIGHT: Final = 22

# What is asked


@dataclass(frozen=True, slots=True)
class Shape:
    """Everything but the size and the open panel that affects the arrangement.

    ``actions``: most actions of a state. ``reads`` gives the screen to the lesson page if there is no space
    for both. ``spotlight``: the panel that the page points at. ``is_fresh``: no step was taken. ``shown``:
    panels in view, None for all.
    """

    drawing: Drawing | None = None
    table_rows: int = 11
    actions: int = 4
    lanes: bool = False
    is_program: bool = False
    has_lesson: bool = False
    reads: bool = False
    spotlight: str | None = None
    is_fresh: bool = False
    is_drawn: bool = False
    shown: frozenset[str] | None = None
    hides_exact: bool = False

    @property
    def settings(self) -> str:
        """The panel of settings, or of the program."""
        return row.PROGRAM if self.is_program else row.CONTROLS

    def at_first(self) -> Shape:
        """Drop panels that are empty at first."""
        pointed = {self.spotlight} if self.spotlight else set()
        pointed |= {row.CURVE, row.TIMELINE} if pointed & {row.CURVE, row.TIMELINE} else set()
        return replace(self, shown=frozenset({row.WORLD, row.BUDGET, row.CONTROLS} | pointed))


class SizeClass(IntEnum):
    """Size class of a screen."""

    SMALL = 0
    MEDIUM = 1
    ROOMY = 2


SMALL, MEDIUM, ROOMY = SizeClass
_BELOW_A_PAGE: Final = {row.TABLE: 5, row.BUDGET: 4, row.LAST_STEP: 3, row.CURVE: 4, row.CONTROLS: 1}  # rows
_AT_THE_RIGHT: Final = frozenset({row.TABLE, row.LAST_STEP, row.CONTROLS})


def size_class(size: Size) -> SizeClass:
    """Return a screen's size class."""
    if size.width >= ROOMY_WIDTH and size.height >= ROOMY_HEIGHT:
        return ROOMY
    return MEDIUM if size.width >= MEDIUM_WIDTH and size.height >= MEDIUM_HEIGHT else SMALL


def docks_lesson(size: Size, shown: Collection[str] | None) -> bool:
    """Return whether a page fits beside ``shown`` panels."""
    room = size_class(size)
    return room is ROOMY or (room is MEDIUM and shown is not None and not _AT_THE_RIGHT.intersection(shown))


# Cells of a map


_MOST_HEIGHT: Final = 12  # of a cell
_LOW: Final = {1: (1, 7), 2: (3, 8)}  # rows of a cell: its least and most columns
_ODD_FROM: Final = 5  # columns: an odd number has a middle
_HUGE: Final = Size(80, 40)  # cells: a larger map scrolls at a readable size
_READABLE: Final = 3  # columns
_LEAST_WITH_LETTERS: Final = 2


def cell_size(
    rows: int, columns: int, width: int, height: int, *, is_broad: bool = False, fills: bool = False
) -> Size:
    """Return the tallest, then widest cell of which rows × columns fit into width × height.

    On screen a cell is 1 to 1.5 times as wide as high, or up to 2 times if it ``is_broad``. If the map
    ``fills`` the screen, a cell may be a quarter narrower and of even width. If none fits, the map scrolls.
    """
    for tall in range(min(_MOST_HEIGHT, height // rows), 0, -1):
        narrowest, widest = 3 * tall // 2 if fills else 2 * tall - 1, (4 if is_broad else 3) * tall - 1
        least, most = _LOW.get(tall, (narrowest, widest))
        wide = min(most, width // columns)
        wide -= wide >= _ODD_FROM and wide % 2 == 0 and not fills
        if wide >= least:
            return Size(wide, tall)
    is_huge = rows > _HUGE.height or columns > _HUGE.width
    return Size(_READABLE if is_huge else max(1, min(_READABLE, width // columns)), 1)


class MapSize(NamedTuple):
    """The size of a ``cell``, and of the map with margins."""

    cell: Size
    picture: Size


def map_size(grid: Grid, width: int, height: int, *, is_broad: bool = False, fills: bool = False) -> MapSize:
    """Return a map's size, without labels if it would scroll."""
    margins = wanted_margins(grid, height)
    left, above = margins.left, margins.above
    cell = cell_size(grid.rows, grid.columns, width - left, height - above, is_broad=is_broad, fills=fills)
    is_whole = cell.width * grid.columns <= width - left and cell.height * grid.rows <= height - above
    if not is_whole and not margins.body:
        bare = cell_size(grid.rows, grid.columns, width, height, is_broad=is_broad, fills=fills)
        fits = bare.width * grid.columns <= width and bare.height * grid.rows <= height
        if (fits and height < LEAST_WITH_TITLES) or bare.width > cell.width:
            cell, left, above = bare, 0, 0
        if not fits and grid.axes is not None and cell.width < _LEAST_WITH_LETTERS:
            part = next((each.columns for each in grid.axes.titles), width)
            if (2 * part + 1) * _LEAST_WITH_LETTERS <= width:  # two parts with letters, not all as tints
                cell = Size(_LEAST_WITH_LETTERS, cell.height)
    return MapSize(
        cell,
        Size(
            min(width, cell.width * grid.columns + left),
            min(height, cell.height * grid.rows + above),
        ),
    )


# Where panels are put


WORLDS: Final = (row.WORLD, row.beside(row.WORLD))
"""The ids of the worlds, which fill the screen in full screen."""


class Arrangement(NamedTuple):
    """The panels' ``regions`` by id, a map's ``cell``, and whether the first row is the header."""

    regions: dict[str, Region]
    cell: Size
    has_header: bool = True


@dataclass
class ScreenPlan:
    """The regions put so far."""

    size: Size
    shape: Shape
    regions: dict[str, Region] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.room = size_class(self.size)
        self.margin, self.gap = (2, 3) if self.room is ROOMY else (1, 2)
        self.top = 2 if self.room is ROOMY else 1
        self.foot = self.size.height - (2 if self.size.height >= MESSAGE_HEIGHT else 1)
        self.usable = self.size.width - 2 * self.margin
        self.lanes = self.shape.lanes and self.room is not SMALL
        self.blank = 1 if self.room is ROOMY else 0
        if row.CAPTION in (self.shape.shown or ()):
            self.put_caption(row.CAPTION)

    def shows(self, panel: str) -> bool:
        """Return whether ``panel`` should be in view."""
        return self.shape.shown is None or {row.PROGRAM: row.CONTROLS}.get(panel, panel) in self.shape.shown

    def put(self, panel: str, region: Region) -> None:
        """Put ``panel``, unless the region is empty."""
        if region.width > 0 and region.height > 0:
            self.regions[panel] = region

    def put_caption(self, panel: str) -> None:
        """Put ``panel`` above the keys, where high screens show messages."""
        self.foot = self.size.height - 2
        self.put(panel, Region(self.margin, self.foot, self.usable, 1))

    def alone(self, panel: str) -> Arrangement:
        """Arrange ``panel`` alone, curve and timeline as one."""
        if panel in WORLDS:
            return self._big(panel)
        body = Region(self.margin, 1, self.usable, self.foot - 1)
        if panel in (row.CURVE, row.TIMELINE):
            self.put(row.CURVE, Region(*body[:3], body.height - 1))
            self.put(row.TIMELINE, Region(body.x, body.bottom - 1, body.width, 1))
            return Arrangement(self.regions, Size(0, 0))
        self.put(panel, body)
        return Arrangement(self.regions, Size(0, 0))

    def page(self) -> Arrangement:
        """Arrange a page above its spotlight."""
        panel = self.shape.spotlight
        rows = _BELOW_A_PAGE.get(panel or "", 0) if self.room is MEDIUM else 0
        if panel is not None and rows and self.shows(panel):
            self.foot -= rows
            panel = self.shape.settings if panel == row.CONTROLS else panel
            self.put(panel, Region(self.margin, self.foot, self.usable, rows))
        self.put(row.LESSON, Region(self.margin, 1, self.usable, self.foot - 1))
        return Arrangement(self.regions, Size(0, 0))

    def _big(self, world: str) -> Arrangement:
        self.put_caption(row.LESSON if self.shape.has_lesson else row.CAPTION)
        self.foot -= 1
        if self.shows(row.CURVE):
            self.put(row.CURVE, Region(self.margin, self.foot, self.usable, 1))
        drawing, cell, high = self.shape.drawing, Size(0, 0), self.foot
        left, top = 0, int(self.room is ROOMY)
        if isinstance(drawing, Grid):
            below = 1 + bool(drawing.wind)
            cell, picture = map_size(drawing, self.usable, self.foot - below, is_broad=True, fills=True)
            high = picture.height + below
            left, top = (self.usable - picture.width) // 2, (self.foot - high + 1) // 2
        region = Region(self.margin - 1 + left, top, self.usable + 1 - left, min(high, self.foot - top))
        self.put(world, region)
        return Arrangement(self.regions, cell, has_header=top > 0)
