"""A world as text, with the agent in it: what ``render`` returns in Gymnasium's mode ``ansi``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.world import World

AGENT: Final = "@"
_CHARACTERS: Final[Mapping[CellKind, str]] = {
    CellKind.FLOOR: ".",
    CellKind.START: "S",
    CellKind.GOAL: "G",
    CellKind.HOLE: "H",
    CellKind.WALL: "#",
    CellKind.CLIFF: "C",
}


def text_picture(world: World, state: int, action: int | None) -> str:
    """Return a line with the state and the ``action`` that led there, under it the map where there is one."""
    taken = "" if action is None else f", after {world.space.action_names[action]}"
    line = f"state {world.space.state_names[state]}{taken}"
    drawing = world.drawing
    return f"{line}\n{_map(drawing, state)}" if isinstance(drawing, Grid) else f"{line}\n"


def _map(grid: Grid, state: int) -> str:
    cells = [_CHARACTERS[kind] for kind in grid.kinds]
    cells[grid.cell_of_state[state]] = AGENT
    rows = range(0, grid.rows * grid.columns, grid.columns)
    return "".join(f"{''.join(cells[first : first + grid.columns])}\n" for first in rows)
