"""A policy as text: arrows on a map, or one line per state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.commands.line.output import can_print, columns
from rl_tui.screen.draw.action_order import shown_order
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.world import World

MOST_ROWS: Final = 100
MOST_COLUMNS: Final = 40
UNKNOWN: Final = "."
BLANK: Final = "All actions look equal in every state."


def policy_map(world: World, policy: Sequence[Sequence[str]]) -> str:
    """Return a drawing of the actions in each state; several are a tie.

    An arrow is a move, a letter the first letter of another action. A dot means that all available actions
    look equally good. Without a transition table, outer rows and columns without knowledge are cut off.
    """
    drawing, policy = world.drawing, as_shown(world, policy)
    if isinstance(drawing, Grid) and is_drawn(world):
        return _grid(world, drawing, policy)
    states = zip(world.space.state_names, policy, strict=True)
    rows = [(name, ", ".join(actions)) for name, actions in states if actions]
    more = f"\n... and {len(rows) - MOST_ROWS:,} more: --json has all" if len(rows) > MOST_ROWS else ""
    return columns([("state", "greedy"), *rows[:MOST_ROWS]]) + more


def is_drawn(world: World) -> bool:
    """Return True if the map is small enough to draw a policy on."""
    drawing = world.drawing
    return isinstance(drawing, Grid) and drawing.rows <= MOST_ROWS and drawing.columns <= MOST_COLUMNS


def as_shown(world: World, policy: Sequence[Sequence[str]]) -> list[list[str]]:
    """Return `policy` with actions in the order of the screen."""
    order = [world.space.action_names[action] for action in shown_order(world)]
    return [[name for name in order if name in actions] for actions in policy]


def _grid(world: World, grid: Grid, policy: Sequence[Sequence[str]]) -> str:
    glyphs = UNICODE if can_print("←↓→↑↖●▓★█") else ASCII
    space = world.space
    directions = zip(space.action_names, grid.directions, strict=True)
    arrows = {name: glyphs.direction(step) if step else name[0] for name, step in directions}
    cells = [_cell(kind, glyphs) for kind in grid.kinds]
    known = [False] * len(cells)
    for state, actions in enumerate(policy):
        legal = len(space.pairs_of(state))
        if legal:
            unknown = legal > 1 and len(actions) == legal
            drawn = UNKNOWN if unknown else "".join(arrows[action] for action in actions)
            cells[grid.cell_of_state[state]] = drawn
            known[grid.cell_of_state[state]] = not unknown
    rows = [cells[first : first + grid.columns] for first in range(0, len(cells), grid.columns)]
    if world.mdp is not None:
        return columns(rows)
    if not any(known):
        return BLANK
    places = [divmod(cell, grid.columns) for cell, is_known in enumerate(known) if is_known]
    down, across = zip(*places, strict=True)
    top, bottom, left, right = min(down), max(down), min(across), max(across)
    drawing = columns([row[left : right + 1] for row in rows[top : bottom + 1]])
    if (top, bottom, left, right) == (0, grid.rows - 1, 0, grid.columns - 1):
        return drawing
    return f"{drawing}\n({_part(grid, top, bottom, left, right)}; nothing is known outside)"


def _part(grid: Grid, top: int, bottom: int, left: int, right: int) -> str:
    # Rows and columns are shown by label if they have labels
    axes = grid.axes
    labels = axes and (axes.rows[top], axes.rows[bottom], axes.columns[left], axes.columns[right])
    first, last, *across = labels if labels and all(labels) else (top, bottom, left, right)
    counted = "" if labels and all(labels) else ", counted from 0"
    return f"rows {first} to {last} and columns {across[0]} to {across[1]}{counted}"


def _cell(kind: CellKind, glyphs: Glyphs) -> str:
    special = {
        CellKind.HOLE: glyphs.hole,
        CellKind.CLIFF: glyphs.cliff,
        CellKind.GOAL: glyphs.goal,
        CellKind.WALL: glyphs.wall,
    }
    return special.get(kind, " ")
