"""The wind of a map: its strength below each column, lit where it has just blown."""

from __future__ import annotations

from typing import Final

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.lab.last_step.gust import gust_of
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.legend import LegendSign
from rl_tui.tui.panels.world.grid.form import CellForm
from rl_tui.tui.panels.world.grid.map import MapPart
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Grid

WIND: Final = "wind"


def wind_strip(
    grid: Grid, part: MapPart, form: CellForm, left: int, width: int, snapshot: Snapshot, look: Look
) -> Strip:
    """Return a row of ``width`` cells with the wind of each column of ``part``, which begins at ``left``."""
    palette = look.palette
    gust = gust_of(snapshot.world, snapshot.counters.last_step)
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
