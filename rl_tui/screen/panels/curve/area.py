"""The area under the moving mean, and the band of the middle half."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from rich.style import Style

from rl_tui.runs.results import Curve
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.panels.curve.moving_mean import MovingMean
from rl_tui.screen.theme.look import Look, Palette
from rl_tui.screen.theme.roles import faded
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# The area under the moving mean, in eighths of a character, darker below


FULL: Final = 8
_PALEST, _DEEPEST = 0.22, 0.62  # shares of ink in the lowest and the highest row


class Area(NamedTuple):
    """Eighths of each cell, [rows, columns], and columns off the axis, [columns]."""

    eighths: IntArray
    below: BoolArray
    above: BoolArray


def values_of(plot: Plot, mean: MovingMean) -> FloatArray:
    """Return the mean at each right edge, [columns], or NaN."""
    ends = plot.ends_of_columns(mean.finished)
    there = ~np.isnan(ends)
    ends[there] = mean.at(ends[there])
    return ends


def area_of(plot: Plot, mean: MovingMean) -> Area:
    """Fill the area under ``mean``."""
    values = values_of(plot, mean)
    share = np.clip((values - plot.scale.low) / (plot.top - plot.scale.low), 0.0, 1.0)
    level = np.rint(np.nan_to_num(share) * (FULL * plot.rows)).astype(np.int64)
    floor = FULL * np.arange(plot.rows)[::-1, None]
    return Area(np.clip(level - floor, 0, FULL), values < plot.scale.low, values > plot.top)


@lru_cache(64)
def area_styles(palette: Palette, rows: int) -> tuple[Style, ...]:
    """Return each row's style, highest first."""
    if not palette.has_shades:
        return (palette.episodes,) * rows
    return tuple(_shade(palette, _DEEPEST + (_PALEST - _DEEPEST) * (row + 0.5) / rows) for row in range(rows))


def _shade(palette: Palette, share: float) -> Style:
    ink = Style(color=palette.episodes.color, bgcolor=palette.page.color)
    return Style(color=faded(ink, share).color)


# The middle half


_LEAST_ROWS: Final = 7
_LEAST_VALUES: Final = 6  # distinct returns among the last episodes
_LAST: Final = 2_000  # episodes
_HEIGHTS: Final = (0.05, 0.7)  # shares of the axis that the band may take
_INSIDE: Final = 0.7  # share of columns with their mean in the band
_SHARES: Final = (0.2, 0.42, 1.0)  # shares of ink in area, band and mean
_PAGE, _AREA, _BAND, _MEAN = range(4)


class MiddleHalf(NamedTuple):
    """The returns' quartiles in each column's window, [columns] each, or NaN."""

    low: FloatArray
    high: FloatArray


def says_something(plot: Plot, curve: Curve, mean: MovingMean, look: Look) -> bool:
    """Return whether the band of the middle half is informative.

    It needs enough distinct returns, rows and colours, a height of 5 to 70 % of the axis, and a mean inside
    it in over 70 % of the columns.
    """
    if plot.rows < _LEAST_ROWS or not (look.glyphs.braille and look.palette.has_shades):
        return False
    recent = curve.samples[-max(1, _LAST // curve.sample_every) :]
    if len(np.unique(recent.round(6))) < _LEAST_VALUES:
        return False
    band, values = middle_half(plot, curve, mean), values_of(plot, mean)
    there = ~np.isnan(values)
    height = np.median((band.high - band.low)[there]) / (plot.scale.high - plot.scale.low)
    inside = ((band.low <= values) & (values <= band.high))[there].mean()
    return bool(_HEIGHTS[0] < height < _HEIGHTS[1] and inside > _INSIDE)


def middle_half(plot: Plot, curve: Curve, mean: MovingMean) -> MiddleHalf:
    """Return the quartiles at each right edge."""
    ends = plot.ends_of_columns(mean.finished)
    behind = np.ceil(ends / curve.sample_every)  # number of samples up to there, NaN beyond the last episode
    first = np.ceil(np.maximum(ends - mean.window, 0.0) / curve.sample_every)
    most = int(np.nanmax(behind - first))
    places = np.nan_to_num(behind)[:, None] - 1.0 - np.arange(most)
    inside = places >= np.nan_to_num(first)[:, None]
    found = np.where(inside, curve.samples[np.maximum(places, 0.0).astype(np.int64)], np.inf)
    found.sort(axis=1)
    last, rows = inside.sum(axis=1) - 1, np.arange(len(ends))
    low, high = (found[rows, np.rint(share * last).astype(np.int64)] for share in (0.25, 0.75))
    unknown = np.isnan(ends)
    return MiddleHalf(np.where(unknown, np.nan, low), np.where(unknown, np.nan, high))


def band_cells(plot: Plot, band: MiddleHalf, mean: MovingMean) -> tuple[IntArray, IntArray]:
    """Return characters (0: none) and kinds of cells, [rows, columns] each.

    The kind is 4 × the upper pixel + the lower one: 0 page, 1 area, 2 band, 3 mean.
    """
    per_unit = 2 * plot.rows / (plot.top - plot.scale.low)
    low, high, middle = ((each - plot.scale.low) * per_unit for each in (*band, values_of(plot, mean)))
    centre = np.arange(2 * plot.rows)[::-1, None] + 0.5
    pixels = np.where(centre < np.fmax(low, middle), _AREA, _PAGE)
    pixels[(low <= centre) & (centre <= high)] = _BAND
    pixels[np.abs(centre - middle) <= 0.5] = _MEAN
    upper, lower = pixels[::2], pixels[1::2]
    codes = np.where(upper == lower, ord("█"), np.where(upper == _PAGE, ord("▄"), ord("▀")))
    codes[(upper == _PAGE) & (lower == _PAGE)] = 0
    return codes, 4 * upper + lower


@lru_cache(64)
def pixel_styles(palette: Palette) -> tuple[Style, ...]:
    """Return inks of area, band and mean."""
    return tuple(_shade(palette, share) for share in _SHARES)


@lru_cache(64)
def band_styles(palette: Palette) -> list[Style]:
    """Return the styles of :func:`band_cells`."""
    colours = (None, *(style.color for style in pixel_styles(palette)))
    return [
        Style(color=lower if upper is None else upper, bgcolor=None if upper is None else lower)
        for upper in colours
        for lower in colours
    ]
