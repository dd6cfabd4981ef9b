"""The choice of the view that draws a world."""

from __future__ import annotations

from textual.widgets import Static

from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.world import World


def make_world_view(
    world: World,
    look: Look,
    *,
    id: str | None = None,  # noqa: A002
    classes: str | None = None,
) -> WorldView:
    """Return the view for how ``world`` is drawn."""
    match world.drawing:
        case Grid():
            return GridView(world, look, id=id, classes=classes)
        case Graph():
            return GraphView(world, look, id=id, classes=classes)
        case Arms():
            return ArmsView(world, look, id=id, classes=classes)


class WorldPlaceholder(Static, BoardPanel):
    """Stands in the place of the view until the first snapshot tells its kind."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(f"preparing {look.glyphs.ellipsis}", id=id, classes=classes)
