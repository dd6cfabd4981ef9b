"""The scale of the arms: it holds every value and widens in steps, so that bars do not tremble."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final, NamedTuple

from rl_tui.tui.theme.glyphs import Glyphs

_STEPS: Final = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


class ArmsScale(NamedTuple):
    """The ends of an axis that holds 0: low ≤ 0 ≤ high."""

    low: float
    high: float


NO_SCALE: Final = ArmsScale(0.0, 0.0)


def grown(scale: ArmsScale, values: Iterable[float]) -> ArmsScale:
    """Return ``scale``, widened to the next round ends that hold all finite ``values``."""
    low, high = scale
    for value in values:
        if math.isfinite(value):
            low = min(low, -round_up(-value)) if value < low else low
            high = max(high, round_up(value)) if value > high else high
    return ArmsScale(low, high)


def shown_scale(scale: ArmsScale) -> ArmsScale:
    """Return what is drawn: −1 … 1 while there is no value yet."""
    return scale if scale.low < scale.high else ArmsScale(-1.0, 1.0)


def round_up(value: float) -> float:
    """Return the least of 1, 2, 3, 4, 5, 6, 8 times a power of ten that is not below ``value`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(value))
    # 3 × 0.1 is not 0.3
    ends = (float(f"{step * power:.3g}") for step in _STEPS)
    return next((end for end in ends if value <= end), 10.0 * power)


def ticks(scale: ArmsScale, most: int) -> list[float]:
    """Return round values at even distances inside the scale, 0 among them, at most about ``most``."""
    span = scale.high - scale.low
    rough = span / max(1, most - 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(each * power for each in (1.0, 2.0, 5.0, 10.0) if rough <= each * power * (1 + 1e-9))
    first, last = math.ceil(scale.low / step - 1e-9), math.floor(scale.high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def bound_text(value: float, glyphs: Glyphs) -> str:
    """Return a round value in the fewest characters, with its sign if negative."""
    return f"{value:.6g}".replace("-", glyphs.minus) if value else "0"
