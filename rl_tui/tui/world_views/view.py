"""What the pictures of all kinds of worlds have in common."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.strip import Strip

from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui.canvas import Canvas, shortened
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets.panel import Panel
from rl_tui.worlds.world import World

WAITING = "the world is being built"


class WorldView(Panel, can_focus=True):
    """A panel with the picture of one world. Before the first snapshot one line says what comes.

    Subclasses implement :meth:`drawing`, which may set ``heading`` and ``footing`` on the way.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "pan(-1, 0)", "Up", show=False, id="world.up", tooltip="Scroll the world up"),
        Binding("down", "pan(1, 0)", "Down", show=False, id="world.down", tooltip="Scroll the world down"),
        Binding("left", "pan(0, -1)", "Left", show=False, id="world.left", tooltip="Scroll the world left"),
        Binding(
            "right", "pan(0, 1)", "Right", show=False, id="world.right", tooltip="Scroll the world right"
        ),
        Binding("home", "follow", "Follow", show=False, id="world.follow", tooltip="Scroll back by itself"),
    ]

    def __init__(
        self,
        world: World,
        look: Look,
        *,
        id: str | None = None,  # noqa: A002
        classes: str | None = None,
    ) -> None:
        super().__init__(look, id=id, classes=classes)
        self.world = world

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the drawing of ``snapshot``, a moment of a run in this view's world."""
        if snapshot is not None:
            return self.drawing(snapshot, width, height)
        palette, glyphs = self.look.palette, self.look.glyphs
        canvas = Canvas(width, height, palette.text)
        text = shortened(WAITING, width, glyphs.ellipsis)
        canvas.put((width - len(text)) // 2, (height - 1) // 2, text, palette.dim)
        return canvas.strips()

    def drawing(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        """Return ``height`` strips of ``width`` cells (both at least 1)."""
        raise NotImplementedError

    def pan(self, rows: int, columns: int) -> None:
        """Scroll by so many steps down and to the right, where there is more than fits."""

    def follow(self) -> None:
        """Undo all scrolling by hand."""

    def action_pan(self, rows: int, columns: int) -> None:
        """Scroll by hand."""
        self.pan(rows, columns)
        self.redraw()

    def action_follow(self) -> None:
        """Scroll by itself again."""
        self.follow()
        self.redraw()
