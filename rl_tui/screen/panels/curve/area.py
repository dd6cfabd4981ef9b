"""The area under the moving mean, in eighths of a character, darker below."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from rich.color import Color, ColorSystem, ColorType, blend_rgb
from rich.style import Style

from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.panels.curve.data import MovingMean
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Palette
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

FULL: Final = 8
_EIGHTHS: Final = " ▁▂▃▄▅▆▇█"
_EIGHTHS_ASCII: Final = " ..::||##"
_PALEST, _DEEPEST = 0.22, 0.62  # shares of the ink in the lowest and in the highest row


class Area(NamedTuple):
    """Eighths of each cell, [rows, columns], and the columns, [columns], whose mean is off the axis."""

    eighths: IntArray
    below: BoolArray
    above: BoolArray


def values_of(plot: Plot, mean: MovingMean) -> FloatArray:
    """Return the mean at the right edge of each column, [columns]; NaN where no episode is."""
    ends = plot.ends_of_columns(mean.finished)
    there = ~np.isnan(ends)
    ends[there] = mean.at(ends[there])
    return ends


def area_of(plot: Plot, mean: MovingMean) -> Area:
    """Return the area under ``mean``; a column shows the mean at its right edge."""
    values = values_of(plot, mean)
    share = np.clip((values - plot.scale.low) / (plot.top - plot.scale.low), 0.0, 1.0)
    level = np.rint(np.nan_to_num(share) * (FULL * plot.rows)).astype(np.int64)
    floor = FULL * np.arange(plot.rows)[::-1, None]
    return Area(np.clip(level - floor, 0, FULL), values < plot.scale.low, values > plot.top)


def eighths_of(glyphs: Glyphs) -> str:
    """Return the characters of 0 to 8 eighths."""
    return _EIGHTHS if glyphs.braille else _EIGHTHS_ASCII


@lru_cache(64)
def area_styles(palette: Palette, rows: int) -> tuple[Style, ...]:
    """Return the style of each row, the highest first; the same for all where there are few colours."""
    ink, page = palette.episodes.color, palette.page.color
    if not palette.has_shades or ink is None or page is None:
        return (palette.episodes,) * rows
    shades = []
    for row in range(rows):
        share = _DEEPEST + (_PALEST - _DEEPEST) * (row + 0.5) / rows
        mixed = Color.from_triplet(blend_rgb(page.get_truecolor(), ink.get_truecolor(), share))
        shades.append(mixed.downgrade(ColorSystem.EIGHT_BIT) if ink.type is ColorType.EIGHT_BIT else mixed)
    return tuple(Style(color=shade) for shade in shades)
