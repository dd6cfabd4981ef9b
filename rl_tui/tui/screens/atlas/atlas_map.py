"""The widget with the map and its cursor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.events import Click
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.tui.screens.atlas.picture import AtlasScene, draw_map, plan_of


class AtlasMap(Widget, can_focus=True):
    """Draws ``scene``; arrows and clicks move its cursor."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "move(0, -1)", "left", show=False),
        Binding("right", "move(0, 1)", "right", show=False),
        Binding("up", "move(1, 0)", "up", show=False),
        Binding("down", "move(-1, 0)", "down", show=False),
    ]

    @dataclass
    class CellPointed(Message):
        """The cursor is to stand at another cell."""

        cell: int

    def __init__(self, scene: AtlasScene) -> None:
        super().__init__(id="map")
        self.scene = scene
        self._strips: list[Strip] = []

    def show(self, scene: AtlasScene) -> None:
        """Draw ``scene`` from now on."""
        self.scene = scene
        self._strips = []
        self.refresh()

    def on_resize(self) -> None:
        """Draw anew for another size."""
        self._strips = []

    def render_line(self, y: int) -> Strip:
        """Return line ``y`` of the map."""
        width, height = self.size
        if not self._strips:
            self._strips = draw_map(plan_of(self.scene, width, height)).strips()
        strip = self._strips[y] if y < len(self._strips) else Strip.blank(width)
        return strip.apply_style(self.rich_style)

    def action_move(self, rows: int, columns: int) -> None:
        """Move the cursor so many rows up and columns to the right; at the edges it stays."""
        axes = len(self.scene.cells.variations)
        steps = {axes - 1: columns} | ({0: rows} if axes > 1 else {})
        self.post_message(self.CellPointed(self.scene.cells.moved(self.scene.cursor, steps)))

    def on_click(self, event: Click) -> None:
        """Put the cursor where the click was."""
        cell = plan_of(self.scene, *self.size).cell_at(event.x, event.y)
        if cell is not None:
            self.post_message(self.CellPointed(cell))
