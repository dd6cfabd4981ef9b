"""The arrangement as Textual asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from textual.geometry import NULL_OFFSET, NULL_SPACING, Region, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.widget import Widget

from rl_tui.screen.frame.arrangement import Shape, arrangement, docks_lesson, has_lines_below
from rl_tui.screen.kit.row import LESSON, WORLD, PanelRow, beside


class BoardLayout(Layout):
    """Gives each panel the region that the arrangement has for it: of its ``shape``, and what is open."""

    name = "board"

    def __init__(self, shape: Shape, panels: Sequence[PanelRow]) -> None:
        self.shape = shape
        self.zoomed: str | None = None
        self.opened: str | None = None
        self.placed: frozenset[str] = frozenset()
        self._panels = panels

    def styles(self, size: Size) -> frozenset[str]:
        """Return the style classes of the board: panels lose borders for which there is no room."""
        if self.is_pair(size):
            return frozenset({"-lanes", "-lines"})
        has_lines = self.shape.has_lesson and has_lines_below(size, self.shape)
        return frozenset({"-lines"} if has_lines else ())

    def has_lesson_in_a_row(self, size: Size) -> bool:
        """Return whether a lesson has one row only: its page is not read, and has no room beside all else."""
        shape = self.shape
        is_page = shape.reads or docks_lesson(size) or self.zoomed == LESSON
        return shape.has_lesson and not is_page

    def has_place(self, panel: str, size: Size) -> bool:
        """Return whether ``panel`` has a place, with the page of a lesson beside it or in turn with it."""
        shape = replace(self.shape, reads=False)
        return panel in arrangement(size, shape, self.zoomed, self.opened, self._panels)

    def is_pair(self, size: Size) -> bool:
        """Return whether two lanes stand side by side."""
        return self.shape.lanes and beside(WORLD) in self.regions(size, None)

    def regions(self, size: Size, zoomed: str | None) -> dict[str, Region]:
        """Return where each panel stands whose place is in view, with ``zoomed`` alone if it is not None."""
        return arrangement(size, self.shape, zoomed, self.opened, self._panels)

    def arrange(
        self, parent: Widget, children: list[Widget], size: Size, greedy: bool = True
    ) -> ArrangeResult:
        """Return the places of ``children``."""
        regions = self.regions(size, self.zoomed)
        self.placed = frozenset(regions)
        return [
            WidgetPlacement(regions[child.id], NULL_OFFSET, NULL_SPACING, child)
            for child in children
            if child.id in regions
        ]
