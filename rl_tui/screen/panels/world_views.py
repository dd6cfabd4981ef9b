"""The choice of a world's view."""

from __future__ import annotations

from typing import Any, Final

from textual.widgets import Static

from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms, Drawing, Graph, Grid
from rl_tui.worlds.world import World

_VIEWS: Final[dict[type[Drawing], type[WorldView]]] = {Grid: GridView, Graph: GraphView, Arms: ArmsView}


def make_world_view(world: World, look: Look, **options: Any) -> WorldView:
    """Return the view for a world's drawing."""
    return _VIEWS[type(world.drawing)](world, look, **options)


class WorldPlaceholder(Static, BoardPanel):
    """Replaces the view until the first snapshot."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(f"preparing {look.glyphs.ellipsis}", id=id, classes=classes)
