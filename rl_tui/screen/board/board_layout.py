"""The arrangement as Textual asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from textual.geometry import NULL_OFFSET, NULL_SPACING, Region, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.widget import Widget

from rl_tui.screen.frame.arrange import arrange
from rl_tui.screen.frame.shape import WORLDS, Arrangement, Shape, docks_lesson
from rl_tui.screen.kit.row import LESSON, WORLD, PanelRow, beside
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView


class BoardLayout(Layout):
    """Gives each panel the region that the arrangement has for it: of its ``shape``, and what is open.

    Sizes are those of the screen. The board begins below the header, where there is one.
    """

    name = "board"

    def __init__(self, shape: Shape, panels: Sequence[PanelRow]) -> None:
        self.shape = shape
        self.zoomed: str | None = None
        self.opened: str | None = None
        self.placed: frozenset[str] = frozenset()
        self._rows = {row.id: row for row in panels}

    @property
    def is_big(self) -> bool:
        """Whether a world has all of the screen but the rows below it."""
        return self.zoomed in WORLDS

    def in_view(self, size: Size) -> frozenset[str] | None:
        """Return the ids of the panels in view, None: all, as with two runs or while the world is edited.

        So it is beside a panel that a key has opened, where that leaves no room for a page of a lesson.
        """
        is_opened = self.opened is not None and not docks_lesson(size, None)
        return None if is_opened or self.shape.lanes or self.shape.is_drawn else self.shape.shown

    def has_lesson_in_a_row(self, size: Size) -> bool:
        """Return whether a lesson has one row only: its page is not read, and has no room beside all else."""
        shape = self.shape
        is_page = shape.reads or docks_lesson(size, self.in_view(size)) or self.zoomed == LESSON
        return shape.has_lesson and (self.is_big or not is_page)

    def has_page(self, size: Size) -> bool:
        """Return whether the page of a lesson is in view, and not its row."""
        return not self.has_lesson_in_a_row(size) and LESSON in self.regions(size, self.zoomed)

    def has_place(self, panel: str, size: Size) -> bool:
        """Return whether ``panel`` has a place, with the page of a lesson beside it or in turn with it."""
        return panel in self._place(size, replace(self.shape, reads=False), self.zoomed).regions

    def is_pair(self, size: Size) -> bool:
        """Return whether two lanes stand side by side."""
        return self.shape.lanes and beside(WORLD) in self.regions(size, None)

    def regions(self, size: Size, zoomed: str | None) -> dict[str, Region]:
        """Return where each panel stands whose place is in view, with ``zoomed`` alone if it is not None."""
        regions = self._place(size, self.shape, zoomed).regions
        if zoomed in WORLDS:
            return regions
        return {panel: region.translate((0, -1)) for panel, region in regions.items()}

    def _place(self, size: Size, shape: Shape, zoomed: str | None) -> Arrangement:
        wide_rows = 0 if self.opened is None else self._rows[self.opened].wide_rows
        shape = replace(shape, shown=self.in_view(size))
        return arrange(size, shape, self.opened, zoomed=zoomed, wide_rows=wide_rows)

    def arrange(
        self, parent: Widget, children: list[Widget], size: Size, greedy: bool = True
    ) -> ArrangeResult:
        """Return the places of ``children``, and give worlds and tables the size of the cells."""
        screen = parent.screen.size
        regions, cell = self.regions(screen, self.zoomed), self._place(screen, self.shape, self.zoomed).cell
        self.placed = frozenset(regions)
        for child in children:
            if isinstance(child, WorldView | QTable) and child.cell != cell:
                child.cell = cell
                child.call_later(child.redraw)
        return [
            WidgetPlacement(regions[child.id], NULL_OFFSET, NULL_SPACING, child)
            for child in children
            if child.id in regions
        ]
