"""Small charts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.screen.draw.canvas import Line, Piece
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import FloatArray


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar from 0 to ``value``."""

    value: float
    axis: tuple[float, float]
    style: Style

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Draw the bar across the full width."""
        glyphs, (low, high) = look.glyphs, self.axis
        per_cell, is_left = (width - 1) / (high - low), self.value < 0.0
        zero = round(-low * per_cell)
        room = zero if is_left else width - 1 - zero
        halves = max(int(self.value != 0.0), round(2.0 * abs(self.value) * per_cell))
        cells, half = divmod(min(2 * room, halves), 2)
        bar = glyphs.bar * cells + glyphs.half_bar[is_left] * half
        if self.value < low:
            bar = bar[:-1] + glyphs.cut
        left, right = (bar[::-1], "") if is_left else ("", bar)
        return [
            [
                Piece(f"{left:>{zero}}", self.style),
                Piece(glyphs.axis_vertical, look.palette.dim),
                Piece(f"{right:{width - 1 - zero}}", self.style),
            ]
        ]


_OUTLIER: Final = 8.0  # times the largest other value
_ROOM: Final = 1.5  # of the largest other value: the cut bar is clearly longer


def axis_of(values: Iterable[float]) -> tuple[float, float]:
    """Return an axis with 0, but without an extremely low value, next to which the others look equal."""
    known = [0.0, *values]
    low, high = min(known), max(known)
    others = max((abs(each) for each in known if not math.isclose(each, low)), default=0.0)
    if 0.0 < _OUTLIER * others < -low:
        low = -_ROOM * others
    return (low, high) if low < high else (0.0, 1.0)


_HIGHEST: Final = 4  # seeds in one column that fill the row


@dataclass(frozen=True, slots=True)
class SeedMarks:
    """The ``values`` of seeds above an axis with mean ± ``error``."""

    values: FloatArray
    own: float | None
    mean: float
    error: float
    axis: tuple[float, float]
    ends: tuple[str, str]
    style: Style

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Draw seeds and axis."""
        glyphs, palette = look.glyphs, look.palette
        left, right = (f"{self.ends[0]} ", f" {self.ends[1]}")
        columns = width - len(left) - len(right)
        if columns < 2:
            return []
        seeds = np.bincount(self._column(self.values, columns), minlength=columns)
        last = len(glyphs.eighths) - 1
        levels = np.ceil(last * seeds / max(_HIGHEST, int(seeds.max()))).astype(np.int64)
        above = [Piece(glyphs.eighths[level], palette.dim) for level in levels]
        if self.own is not None:
            above[self._column(self.own, columns)] = Piece(glyphs.world_mark, self.style)
        first, mean, end = (
            int(self._column(self.mean + away, columns)) for away in (-self.error, 0.0, self.error)
        )
        return [
            [Piece(" " * len(left), palette.text), *above, Piece(" " * len(right), palette.text)],
            [
                Piece(left + glyphs.thin * first, palette.dim),
                Piece(glyphs.bold * (mean - first), self.style),
                Piece(glyphs.estimate, self.style),
                Piece(glyphs.bold * (end - mean), self.style),
                Piece(glyphs.thin * (columns - 1 - end) + right, palette.dim),
            ],
        ]

    def _column(self, values: FloatArray | float, columns: int) -> np.ndarray:
        low, high = self.axis
        return np.clip(np.rint((values - low) / (high - low) * (columns - 1)), 0, columns - 1).astype(
            np.int64
        )
