"""Curves as dots, with eight dots to a braille character."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

DOTS_ACROSS: Final = 2
DOTS_DOWN: Final = 4
BLANK: Final = 0x2800
LEVELS: Final = tuple(map(ord, "⠉⠒⠤⣀"))
"""Level lines, highest first."""
TURN: Final = 2  # columns in which one of several lines in the same cells is seen
# Bits of the dots in the Unicode block "Braille Patterns", [row in the cell][column in the cell]
_BITS: Final = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.uint8)


class Steps(NamedTuple):
    """A function between ``low`` and ``high`` on N intervals, [N] each. NaN is a gap."""

    start: FloatArray
    end: FloatArray
    low: FloatArray
    high: FloatArray


NO_STEPS: Final = Steps(*(np.empty(0) for _ in Steps._fields))


class Span(NamedTuple):
    """First and last dot row of each dot column, [C]. Empty columns have top > bottom."""

    top: IntArray
    bottom: IntArray


def decimated(steps: Steps, right: float, columns: int) -> tuple[FloatArray, FloatArray]:
    """Return the least and largest value in each of ``columns`` parts of 0 .. ``right``.

    Returns:
        Two arrays [columns], with +∞ and −∞ in a part without values.
    """
    low, high = np.full(columns, np.inf), np.full(columns, -np.inf)
    if not len(steps.start):
        return low, high
    edges = np.linspace(0.0, right, columns + 1)
    first = np.searchsorted(steps.end, edges[:-1], side="left")
    behind = np.searchsorted(steps.start, edges[1:], side="left")
    touched = np.flatnonzero(first < behind)
    if len(touched):
        # reduceat takes pairs (first, behind); the results between two pairs are discarded
        bounds = np.column_stack((first[touched], behind[touched])).ravel()
        low[touched] = np.minimum.reduceat(_padded(steps.low, np.inf), bounds)[::2]
        high[touched] = np.maximum.reduceat(_padded(steps.high, -np.inf), bounds)[::2]
    return low, high


def _padded(values: FloatArray, filling: float) -> FloatArray:
    return np.append(np.where(np.isnan(values), filling, values), filling)


def span(low: FloatArray, high: FloatArray, bottom: float, top: float, dots: int) -> Span:
    """Return the dot rows of ``low`` to ``high``, [C] each, from ``top`` down."""
    scale = (dots - 1) / (top - bottom)
    empty = low > high
    with np.errstate(invalid="ignore"):
        upper = np.rint((top - np.where(empty, bottom, high)) * scale).astype(np.int64)
        lower = np.rint((top - np.where(empty, bottom, low)) * scale).astype(np.int64)
    upper, lower = (np.minimum(np.maximum(each, -1), dots) for each in (upper, lower))
    upper[empty], lower[empty] = dots, -1
    return Span(upper, lower)


def joined(line: Span) -> Span:
    """Extend each column to the one before it."""
    top, bottom = line.top.copy(), line.bottom.copy()
    both = (line.top[1:] <= line.bottom[1:]) & (line.top[:-1] <= line.bottom[:-1])
    falls = both & (line.top[1:] > line.bottom[:-1] + 1)
    rises = both & (line.bottom[1:] < line.top[:-1] - 1)
    top[1:][falls] = line.bottom[:-1][falls] + 1
    bottom[1:][rises] = line.top[:-1][rises] - 1
    return Span(top, bottom)


def dots_of(line: Span, dots: int) -> BoolArray:
    """Return the dots of ``line``, [dots, columns]."""
    rows = np.arange(dots)[:, None]
    return np.asarray((rows >= line.top) & (rows <= line.bottom))


def braille_codes(dots: BoolArray) -> IntArray:
    """Return the code points, [rows / 4, columns / 2]."""
    codes = np.zeros((dots.shape[0] // DOTS_DOWN, dots.shape[1] // DOTS_ACROSS), dtype=np.uint8)
    for row in range(DOTS_DOWN):
        for column in range(DOTS_ACROSS):
            codes |= dots[row::DOTS_DOWN, column::DOTS_ACROSS] * _BITS[row, column]
    return codes + np.int64(BLANK)


def in_turns(there: BoolArray) -> IntArray:
    """Return which line each cell shows, −1 for none. ``there`` is [lines, rows, columns].

    Lines that share cells take turns.
    """
    among = np.cumsum(there, axis=0)
    count = among[-1]
    turn = np.arange(there.shape[2]) // TURN % np.maximum(count, 1)
    chosen = there & (among == turn + 1)
    return np.where(count > 0, chosen.argmax(axis=0), -1)
