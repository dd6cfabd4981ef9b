"""How a world is drawn: one file for each kind of drawing."""

from __future__ import annotations

from rl_tui.tui.panels.world.arms.arms import ArmsView
from rl_tui.tui.panels.world.graph.graph import GraphView
from rl_tui.tui.panels.world.grid.grid import GridView
from rl_tui.tui.panels.world.view import WorldView
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.world import World


def make_world_view(world: World, look: Look, *, id: str | None = None) -> WorldView:  # noqa: A002
    """Return the view for how ``world`` is drawn."""
    match world.drawing:
        case Grid():
            return GridView(world, look, id=id)
        case Graph():
            return GraphView(world, look, id=id)
        case Arms():
            return ArmsView(world, look, id=id)
