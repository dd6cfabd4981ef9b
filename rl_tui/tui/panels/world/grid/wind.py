"""The wind of a map: its strength below each column, lit where it has just blown."""

from __future__ import annotations

from typing import Final, NamedTuple

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.legend import LegendSign
from rl_tui.tui.panels.world.grid.form import CellForm
from rl_tui.tui.panels.world.grid.map import MapPart
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

WIND: Final = "wind"


class LastGust(NamedTuple):
    """The wind that moved the agent on its last step: in which ``column``, and by how many cells up."""

    column: int
    pushed: int


def last_gust(grid: Grid, snapshot: Snapshot) -> LastGust | None:
    """Return the wind that moved the agent on the last step of ``snapshot``, None where none did."""
    last, mdp = snapshot.counters.last_step, snapshot.world.mdp
    if last is None or last.planned or mdp is None or last.outcome == UNKNOWN_ACTION:
        return None
    row, column = divmod(int(grid.cell_of_state[last.state]), grid.columns)
    happened = int(mdp.outcome_action[last.outcome])
    step = grid.directions[int(mdp.pair_action[last.pair]) if happened == UNKNOWN_ACTION else happened]
    if not grid.wind[column]:
        return None
    down, right = step or (0, 0)
    target = (row + down, column + right)
    without_wind = row + down if _is_open(grid, *target) else row
    pushed = without_wind - int(grid.cell_of_state[last.next_state]) // grid.columns
    return LastGust(column, pushed) if pushed * grid.wind[column] > 0 else None


def _is_open(grid: Grid, row: int, column: int) -> bool:
    inside = 0 <= row < grid.rows and 0 <= column < grid.columns
    return inside and grid.kinds[row * grid.columns + column] is not CellKind.WALL


def wind_strip(
    grid: Grid, part: MapPart, form: CellForm, left: int, width: int, gust: LastGust | None, look: Look
) -> Strip:
    """Return a row of ``width`` cells with the wind of each column of ``part``, which begins at ``left``."""
    palette = look.palette
    label = WIND if left > len(WIND) else ""
    segments = [Segment(label.rjust(left - 1 if label else 0).ljust(left), palette.dim)]
    for column in range(part.left, part.left + part.columns):
        strength = grid.wind[column]
        text, style = wind_text(strength, look), palette.text if strength else palette.dim
        if gust is not None and gust.column == column:
            is_stronger = abs(gust.pushed) > abs(strength) and len(text) + 1 < form.width
            text, style = text + "+" * is_stronger, palette.updated
        before = (form.width - len(text)) // 2 if form.height > 1 else max(0, form.width - len(text) - 1)
        segments += [
            Segment(" " * before, palette.text),
            Segment(text, style),
            Segment(" " * (form.width - before - len(text)), palette.text),
        ]
    return Strip(segments).adjust_cell_length(width, palette.text)


def wind_sign(grid: Grid, look: Look) -> LegendSign:
    """Return what the numbers below a map mean, by the strongest wind."""
    strongest = max(grid.wind, key=abs)
    arrow, where = ("↑", "up") if strongest > 0 else ("↓", "down")
    in_full = f"{WIND}: cells it blows {where}, lit when it did"
    return LegendSign(wind_text(strongest, look), f"{WIND} {arrow}", look.palette.text, in_full)


def wind_text(strength: int, look: Look) -> str:
    """Return how many cells the wind blows up, below 0 down."""
    return str(strength).replace("-", look.glyphs.minus)


def wind_line(grid: Grid, part: MapPart, look: Look) -> str:
    """Return the wind of the columns in ``part``, for the border: ``wind 0 0 1 2``."""
    winds = grid.wind[part.left : part.left + part.columns]
    return " ".join((WIND, *(wind_text(each, look) for each in winds)))
