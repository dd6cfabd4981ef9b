"""The band from the lowest to the highest return of a column: filled where colours allow, else its edges."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.screen.draw import braille
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.theme.look import Look

_HALVES: Final = np.array([0, ord("▀"), ord("▄"), ord(" ")])
_BOTH_HALVES: Final = 3
_MEANING: Final = "= lowest to highest"


class BandCells(NamedTuple):
    """The code of the character in each cell, [rows, columns], 0 for none, and which cells are ``filled``.

    A filled cell has the colour of the band behind whatever stands in it.
    """

    codes: npt.NDArray[np.int64]
    filled: npt.NDArray[np.bool_]


def band_cells(plot: Plot, band: Steps, look: Look) -> BandCells:
    """Return the cells of ``band``."""
    if look.palette.fills_bands:
        halves = plot.filled_halves(band)
        if look.glyphs.braille:
            return BandCells(_HALVES[halves], halves == _BOTH_HALVES)
        return BandCells(np.where(halves > 0, ord(" "), 0), halves > 0)
    codes = edge_codes(plot, band) if look.glyphs.braille else _dashes(plot, band)
    return BandCells(codes, np.zeros(codes.shape, dtype=np.bool_))


def edge_codes(plot: Plot, band: Steps) -> npt.NDArray[np.int64]:
    """Return the lowest and the highest of ``band`` as dotted lines, [rows, columns], 0 for no character."""
    codes = plot.braille_edges(band)
    return np.where(codes > braille.BLANK, codes, 0)


def _dashes(plot: Plot, band: Steps) -> npt.NDArray[np.int64]:
    """Return a dash in every other column where the lowest and the highest are."""
    codes = np.where(plot.edges(band), ord("-"), 0)
    codes[:, 1::2] = 0
    return codes


def band_signs(look: Look, *, lanes: bool) -> tuple[LegendSign, ...]:
    """Return what the legend says of the band of a run alone, or of the run shown among ``lanes``."""
    if lanes and not look.glyphs.braille:
        return ()
    if look.palette.fills_bands and not lanes:
        return (LegendSign("shade", _MEANING, look.palette.text),)
    return (LegendSign("dim dots" if look.glyphs.braille else "dashes", _MEANING, look.palette.band),)
