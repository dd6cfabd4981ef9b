"""The arrangement as Textual asks for it."""

from __future__ import annotations

from collections.abc import Sequence

from textual.geometry import NULL_OFFSET, NULL_SPACING, Region, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.widget import Widget

from rl_tui.tui.panels.catalogue import WORLD, PanelRow, beside
from rl_tui.tui.screens.playground.arrangement import Shape, arrangement


class BoardLayout(Layout):
    """Gives each panel the region that the arrangement has for it: of its ``shape``, and what is open."""

    name = "board"

    def __init__(self, panels: Sequence[PanelRow]) -> None:
        self.shape = Shape()
        self.zoomed: str | None = None
        self.opened: str | None = None
        self.placed: frozenset[str] = frozenset()
        self._panels = panels

    def is_pair(self, size: Size) -> bool:
        """Return whether two lanes stand side by side."""
        return beside(WORLD) in self.regions(size, None)

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
