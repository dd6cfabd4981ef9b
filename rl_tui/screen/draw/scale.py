"""Steady axes: bounds and labels change in round steps only."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from rl_tui.screen.draw import numbers
from rl_tui.screen.theme.glyphs import Glyphs

FIRST_RANGE: Final = 10.0
_MOST_TICKS: Final = 4
_MOST_EMPTY: Final = 0.28  # of the axis, at either end; 0 to .74 gets an axis that ends at 1
_LEAST_SHARE: Final = 0.5  # of the axis; it shrinks if data take less
_ROOM: Final = 1.2  # times the data: the range for which a shrunk axis has steps
_MOST_STEPS: Final = 10  # of a tight axis
_MOST_FIXED: Final = 4  # decimals of a label; beyond that it has an exponent
# Each is at most a quarter more than the one before
_ROUND: Final = (1.0, 1.2, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0)


@dataclass(frozen=True, slots=True)
class Scale:
    """A vertical axis with labels every ``step``."""

    low: float
    high: float
    step: float

    @property
    def ticks(self) -> list[float]:
        """The two to four labelled values."""
        first, last = math.ceil(self.low / self.step - 1e-9), math.floor(self.high / self.step + 1e-9)
        return [each * self.step for each in range(first, last + 1)]


def round_scale(low: float, high: float) -> Scale:
    """Return a close axis that includes 0, with round labels."""
    low, high = min(low, 0.0), max(high, 0.0)
    if high - low < numbers.NEGLIGIBLE:
        return Scale(0.0, 1.0, 1.0)
    power = 10.0 ** (math.floor(math.log10(high - low)) - 1)
    steps = [digit * power * ten for ten in (1.0, 10.0, 100.0) for digit in (1.0, 2.0, 5.0)]
    for parts in (1.0, 2.0, 5.0):
        for step in steps:
            part = step / parts
            first, last = math.floor(low / part + 1e-9), math.ceil(high / part - 1e-9)
            scale = Scale(first * part, last * part, step)
            empty = max(low - scale.low, scale.high - high)
            if empty <= _MOST_EMPTY * (scale.high - scale.low) and 2 <= len(scale.ticks) <= _MOST_TICKS:
                return scale
    raise AssertionError("no step gives two to four labels")


def tight_scale(low: float, high: float, room: float = 1.0) -> Scale:
    """Return a close axis with round ends. Its steps are for ``room`` times the range.

    The ends are the next ticks, because a farther one may be an impossible value.
    """
    if high - low < numbers.NEGLIGIBLE:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low < numbers.NEGLIGIBLE:
        return Scale(0.0, 1.0, 1.0)
    size = room * (high - low)
    step = 10.0 ** (math.floor(math.log10(size)) - 1)
    step = next(step * digit for digit in (1.0, 2.0, 5.0, 10.0) if size <= _MOST_STEPS * step * digit)
    return Scale(math.floor(low / step + 1e-9) * step, math.ceil(high / step - 1e-9) * step, step)


def settled(previous: Scale | None, low: float, high: float) -> Scale:
    """Return ``previous`` if it suits, else a new axis."""
    if previous is not None and low >= previous.low and high <= previous.high:
        # The room keeps values near an end from making it grow again at once
        is_lost = _ROOM * (high - low) <= _LEAST_SHARE * (previous.high - previous.low)
        return tight_scale(low, high, _ROOM) if is_lost else previous
    return tight_scale(low, high)


def round_range(last: float) -> float:
    """Return an axis's right end, which changes in steps."""
    needed = max(last, FIRST_RANGE)
    power = 10.0 ** math.floor(math.log10(needed))
    return next(power * digit for digit in _ROUND if needed <= power * digit * (1.0 + 1e-12))


def round_step(least: float) -> float:
    """Return the smallest 1, 2 or 5 times a power of ten ≥ ``least`` > 0."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(digit * power for digit in (1.0, 2.0, 5.0, 10.0) if least <= digit * power * (1.0 + 1e-9))


def tick_label(x: float, step: float, glyphs: Glyphs) -> str:
    """Write ``x`` as precisely as ``step``: ``0``, ``0.5``, ``−200``, ``20k``."""
    if abs(x) < numbers.NEGLIGIBLE * step:
        return "0"
    if abs(x) >= 1e15:
        return numbers.value(x, 5, glyphs)
    if step >= 1_000.0:
        short = numbers.count(round(abs(x)), 4).replace(".0", "")
        return (glyphs.minus if x < 0 else "") + short
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return numbers.fixed(x, decimals, glyphs) if decimals <= _MOST_FIXED else numbers.value(x, 5, glyphs)


def tick_step(right: float, most: int) -> float:
    """Return the smallest round step ≥ 1, with at most ``most`` steps."""
    step = 10.0 ** max(0, math.floor(math.log10(max(1.0, right / max(1, most)))))
    return next(step * digit for digit in (1.0, 2.0, 5.0, 10.0) if right / (step * digit) <= max(1, most))
