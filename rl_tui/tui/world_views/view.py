"""What the pictures of all kinds of worlds have in common."""

from __future__ import annotations

from typing import ClassVar, Final

from textual import events
from textual.binding import Binding, BindingType
from textual.strip import Strip

from rl_tui.lab.snapshot import Snapshot
from rl_tui.lab.windows import Cells
from rl_tui.tui.canvas import Canvas, shortened
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets.panel import Panel
from rl_tui.worlds.world import World

WAITING: Final = "the world is being built"
_WHEEL: Final = 3


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
        Binding("pageup", "page(-1, 0)", "Page up", show=False, id="world.page_up", tooltip="A page up"),
        Binding(
            "pagedown", "page(1, 0)", "Page down", show=False, id="world.page_down", tooltip="A page down"
        ),
        Binding(
            "shift+left", "page(0, -1)", "Page left", show=False, id="world.page_left", tooltip="A page left"
        ),
        Binding(
            "shift+right",
            "page(0, 1)",
            "Page right",
            show=False,
            id="world.page_right",
            tooltip="A page right",
        ),
        Binding("home", "follow", "Follow", show=False, id="world.follow", tooltip="Scroll back by itself"),
        Binding(
            "escape,full_stop",
            "back",
            "Follow",
            show=False,
            id="world.back",
            tooltip="Scroll back by itself, where it was scrolled by hand",
        ),
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
        self.enter(world)

    def enter(self, world: World) -> None:
        """Take ``world`` for the one that is drawn from here on."""
        self.world = world

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``; another seed may have made another world of the same kind."""
        if snapshot.world is not self.world:
            self.enter(snapshot.world)
        super().show(snapshot)

    @property
    def cells(self) -> Cells | None:
        """The cells of the map in view, None where all of it is or there is no map."""
        return None

    @property
    def is_complete(self) -> bool:
        """Whether the newest snapshot has all that is in view."""
        return True

    @property
    def is_scrolled(self) -> bool:
        """Whether it was scrolled by hand and not back."""
        return False

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

    def page(self, rows: int, columns: int) -> None:
        """Scroll by so many pages down and to the right, where there is more than fits."""

    def follow(self) -> None:
        """Undo all scrolling by hand."""

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave escape to the screen while there is nothing to go back from."""
        return self.is_scrolled if action == "back" else True

    def action_pan(self, rows: int, columns: int) -> None:
        """Scroll by hand."""
        self.pan(rows, columns)
        self.redraw()

    def action_page(self, rows: int, columns: int) -> None:
        """Scroll by pages."""
        self.page(rows, columns)
        self.redraw()

    def action_back(self) -> None:
        """Scroll by itself again."""
        self.action_follow()

    def action_follow(self) -> None:
        """Scroll by itself again."""
        self.follow()
        self.redraw()

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Scroll down; to the right with shift or ctrl."""
        self._turn_wheel(_WHEEL, event)

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Scroll up; to the left with shift or ctrl."""
        self._turn_wheel(-_WHEEL, event)

    def _turn_wheel(self, lines: int, event: events.MouseEvent) -> None:
        event.stop()
        sideways = event.shift or event.ctrl
        self.action_pan(0 if sideways else lines, lines if sideways else 0)
