"""Axes: where values stand, from 0 to 1, and round numbers to label them with."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

MOST_TICKS: Final = 6
_STEPS: Final = (1.0, 2.0, 2.5, 5.0, 10.0)
_MINUS: Final = "−"
_LARGEST_PLAIN: Final = 1e7
_SMALLEST_PLAIN: Final = 1e-4
_FEWEST_LOG_TICKS: Final = 3


@dataclass(frozen=True, slots=True)
class ChartAxis:
    """An axis from ``low`` to ``high``, low < high, with ``labels`` at ``ticks``, which ascend."""

    label: str
    low: float
    high: float
    ticks: tuple[float, ...]
    labels: tuple[str, ...]
    logarithmic: bool = False

    def share(self, value: float) -> float:
        """Return where ``value`` stands: 0 at the low end, 1 at the high one, beyond them outside that."""
        if not self.logarithmic:
            return (value - self.low) / (self.high - self.low)
        low = math.log(self.low)
        width = math.log(self.high) - low or 1.0  # numbers may lie closer than their logarithms tell
        return (math.log(value) - low) / width if value > 0.0 else -math.inf

    @property
    def tick_shares(self) -> list[float]:
        """Where the ticks stand."""
        return [self.share(tick) for tick in self.ticks]


def round_axis(
    label: str, values: Iterable[float], *, zero: bool = False, most: int = MOST_TICKS
) -> ChartAxis:
    """Return an axis between round numbers that holds ``values``, and 0 if ``zero``.

    It has at most ``most`` ticks, at least two of them.
    """
    low, high = _range_of(values)
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if low == high:
        low, high = low - (abs(low) or 1.0) / 2, high + (abs(high) or 1.0) / 2
    step = _step((high - low) / max(1, most - 2))
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    ticks = tuple(each * step for each in range(first, last + 1))
    return ChartAxis(label, ticks[0], ticks[-1], ticks, labels_of(ticks, step))


def close_axis(label: str, values: Iterable[float], *, logarithmic: bool = False) -> ChartAxis:
    """Return an axis from the least of ``values`` to the largest, with round ticks between them.

    A logarithmic one needs values above 0.
    """
    low, high = _range_of(values)
    if low == high:
        low, high = (low / 2, high * 2) if logarithmic else (low - 0.5, high + 0.5)
    if logarithmic:
        return _logarithmic(label, low, high)
    step = _step((high - low) / MOST_TICKS)
    ticks = tuple(
        each * step for each in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
    )
    return ChartAxis(label, low, high, ticks, labels_of(ticks, step))


def fixed_axis(label: str, ticks: Sequence[float]) -> ChartAxis:
    """Return an axis from the first of ``ticks`` to the last."""
    step = min(later - earlier for earlier, later in pairwise(ticks))
    return ChartAxis(label, ticks[0], ticks[-1], tuple(ticks), labels_of(ticks, step))


def word_axis(label: str, words: Sequence[str]) -> ChartAxis:
    """Return an axis on which ``words`` stand at 0, 1, 2 …"""
    ticks = tuple(float(place) for place in range(len(words)))
    return ChartAxis(label, -0.5, len(words) - 0.5, ticks, tuple(words))


def labels_of(ticks: Sequence[float], step: float) -> tuple[str, ...]:
    """Return how ``ticks`` are written that are ``step`` apart, all of them with as many decimals."""
    largest = max(map(abs, ticks), default=0.0)
    if largest >= _LARGEST_PLAIN or step < _SMALLEST_PLAIN:
        digits = 1 + max(0, math.floor(math.log10(largest)) - math.floor(math.log10(step)))
        return tuple(number_text(tick, digits) for tick in ticks)
    decimals = next(d for d in range(12) if abs(step * 10**d - round(step * 10**d)) < 1e-6)
    return tuple(_signed(f"{abs(tick):,.{decimals}f}", tick) for tick in ticks)


def number_text(value: float, digits: int = 4) -> str:
    """Return ``value`` with so many digits, or all before the point, and no zeros at the end."""
    size = abs(value)
    if size and not _SMALLEST_PLAIN <= size < _LARGEST_PLAIN:
        text = f"{value:.{digits - 1}e}"
        number, exponent = text.split("e")
        number = number.rstrip("0").rstrip(".") if "." in number else number
        return f"{number}e{int(exponent)}".replace("-", _MINUS)
    decimals = max(0, digits - 1 - math.floor(math.log10(size))) if size else 0
    plain = f"{size:,.{decimals}f}"
    return _signed(plain.rstrip("0").rstrip(".") if "." in plain else plain, value)


def _signed(text: str, value: float) -> str:
    return _MINUS + text if value < 0.0 and any(digit in text for digit in "123456789") else text


def _range_of(values: Iterable[float]) -> tuple[float, float]:
    finite = [value for value in values if math.isfinite(value)]
    return (min(finite), max(finite)) if finite else (0.0, 1.0)


def _step(least: float) -> float:
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in _STEPS if step * power >= least * (1.0 - 1e-9))


def _logarithmic(label: str, low: float, high: float) -> ChartAxis:
    for digits in ((1,), (1, 3), (1, 2, 5)):
        powers = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
        ticks = [digit * 10.0**power for power in powers for digit in digits]
        inside = [tick for tick in ticks if low * (1 - 1e-9) <= tick <= high * (1 + 1e-9)]
        if len(inside) >= _FEWEST_LOG_TICKS:
            break
    inside = inside if len(inside) > 1 else [low, high]
    every = math.ceil(len(inside) / MOST_TICKS)
    shown = tuple(inside[::every])
    return ChartAxis(label, low, high, shown, tuple(number_text(tick) for tick in shown), logarithmic=True)
