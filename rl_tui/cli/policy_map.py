"""A policy in plain text: arrows on the map of a grid world, a line a state elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.cli.output import can_print, columns
from rl_tui.tui.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.world import World

MOST_ROWS: Final = 100
MOST_COLUMNS: Final = 40


def policy_map(world: World, policy: Sequence[Sequence[str]]) -> str:
    """Return a drawing of ``policy``, the names of the actions that it takes in each state (ties: several).

    An arrow is a move, a letter the action that begins with it. A dot says that all legal actions look
    equally good.
    """
    drawing = world.drawing
    if isinstance(drawing, Grid) and drawing.rows <= MOST_ROWS and drawing.columns <= MOST_COLUMNS:
        return _grid(world, drawing, policy)
    states = zip(world.space.state_names, policy, strict=True)
    rows = [(name, ", ".join(actions)) for name, actions in states if actions]
    more = f"\n... and {len(rows) - MOST_ROWS:,} more: --json has all" if len(rows) > MOST_ROWS else ""
    return columns([("state", "greedy"), *rows[:MOST_ROWS]]) + more


def _grid(world: World, grid: Grid, policy: Sequence[Sequence[str]]) -> str:
    glyphs = UNICODE if can_print("←↓→↑↖●▓★█") else ASCII
    space = world.space
    directions = zip(space.action_names, grid.directions, strict=True)
    arrows = {name: glyphs.direction(step) if step else name[0] for name, step in directions}
    cells = [_cell(kind, glyphs) for kind in grid.kinds]
    for state, actions in enumerate(policy):
        legal = len(space.pairs_of(state))
        if legal:
            unknown = legal > 1 and len(actions) == legal
            drawn = "." if unknown else "".join(arrows[action] for action in actions)
            cells[grid.cell_of_state[state]] = drawn
    rows = [cells[first : first + grid.columns] for first in range(0, len(cells), grid.columns)]
    return columns(rows)


def _cell(kind: CellKind, glyphs: Glyphs) -> str:
    special = {
        CellKind.HOLE: glyphs.hole,
        CellKind.CLIFF: glyphs.cliff,
        CellKind.GOAL: glyphs.goal,
        CellKind.WALL: glyphs.wall,
    }
    return special.get(kind, " ")
