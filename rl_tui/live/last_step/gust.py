"""The effect of wind on the last step."""

from __future__ import annotations

from typing import NamedTuple

from rl_tui.agents.last_step import LastStep
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION
from rl_tui.worlds.world import World


class LastGust(NamedTuple):
    """A gust in `column` that moved the agent by `pushed` cells, positive upwards."""

    column: int
    pushed: int


def gust_of(world: World, last: LastStep | None) -> LastGust | None:
    """Return the gust on the step `last`, if any."""
    grid, mdp = world.drawing, world.mdp
    if last is None or last.planned or mdp is None or last.outcome == UNKNOWN_ACTION:
        return None
    if not isinstance(grid, Grid) or not grid.wind:
        return None
    row, column = divmod(int(grid.cell_of_state[last.state]), grid.columns)
    happened = int(mdp.outcome_action[last.outcome])
    step = grid.directions[int(mdp.pair_action[last.pair]) if happened == UNKNOWN_ACTION else happened]
    down, right = step or (0, 0)
    target = (row + down, column + right)
    without_wind = row + down if _is_open(grid, *target) else row
    pushed = without_wind - int(grid.cell_of_state[last.next_state]) // grid.columns
    return LastGust(column, pushed) if pushed * grid.wind[column] > 0 else None


def _is_open(grid: Grid, row: int, column: int) -> bool:
    inside = 0 <= row < grid.rows and 0 <= column < grid.columns
    return inside and grid.kinds[row * grid.columns + column] is not CellKind.WALL
