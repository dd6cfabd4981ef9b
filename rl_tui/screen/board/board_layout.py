"""The arrangement of the board as a Textual layout."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from textual.geometry import NULL_OFFSET, NULL_SPACING, Region, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.widget import Widget

from rl_tui.screen.frame.arrange import arrange
from rl_tui.screen.frame.shape import WORLDS, Arrangement, Shape, docks_lesson
from rl_tui.screen.kit.row import DISCOUNT, LESSON, WORLD, PanelRow, beside
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView

_SENTENCE_ROWS: Final = 4  # of a panel with one sentence, between heading and keys


class BoardLayout(Layout):
    """A layout that gives each panel its region, in characters of the screen."""

    name = "board"

    def __init__(self, shape: Shape, panels: Sequence[PanelRow]) -> None:
        self.shape = shape
        self.zoomed: str | None = None
        self.opened: str | None = None
        self.placed: frozenset[str] = frozenset()
        self._rows = {row.id: row for row in panels}

    @property
    def is_big(self) -> bool:
        """True if a world is in full screen."""
        return self.zoomed in WORLDS

    def in_view(self, size: Size) -> frozenset[str] | None:
        """Return the ids of the panels in view, or None for all.

        All are in view with two runs, during editing, and beside an opened panel without space for a page.
        """
        is_opened = self.opened is not None and not docks_lesson(size, None)
        return None if is_opened or self.shape.lanes or self.shape.is_drawn else self.shape.shown

    def has_lesson_in_a_row(self, size: Size) -> bool:
        """Return True if a lesson has only one row."""
        shape = self.shape
        is_page = shape.reads or docks_lesson(size, self.in_view(size)) or self.zoomed == LESSON
        return shape.has_lesson and (self.is_big or not is_page)

    def has_page(self, size: Size) -> bool:
        """Return True if the page of a lesson is in view, not only its row."""
        return not self.has_lesson_in_a_row(size) and LESSON in self.regions(size, self.zoomed)

    def has_place(self, panel: str, size: Size) -> bool:
        """Return True if ``panel`` has a place while the lesson page has one row, or is beside the world."""
        return panel in self._place(size, replace(self.shape, reads=False), self.zoomed).regions

    def is_pair(self, size: Size) -> bool:
        """Return True if two runs are side by side."""
        return self.shape.lanes and beside(WORLD) in self.regions(size, None)

    def regions(self, size: Size, zoomed: str | None) -> dict[str, Region]:
        """Return the region of each panel in view, or only that of ``zoomed``."""
        regions = self._place(size, self.shape, zoomed).regions
        if zoomed in WORLDS:
            return regions
        return {panel: region.translate((0, -1)) for panel, region in regions.items()}

    def _place(self, size: Size, shape: Shape, zoomed: str | None) -> Arrangement:
        wide_rows = 0 if self.opened is None else self._rows[self.opened].wide_rows
        if self.opened == DISCOUNT and shape.hides_exact:
            wide_rows = _SENTENCE_ROWS
        shape = replace(shape, shown=self.in_view(size))
        return arrange(size, shape, self.opened, zoomed=zoomed, wide_rows=wide_rows)

    def arrange(
        self, parent: Widget, children: list[Widget], size: Size, greedy: bool = True
    ) -> ArrangeResult:
        """Return the places of ``children``, and set the cells of worlds and tables."""
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
