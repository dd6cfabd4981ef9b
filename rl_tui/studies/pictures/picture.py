"""A picture of results as data, without colours or pixels.

Outliers would flatten a chart. Its axis leaves them out, and a note says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

# Axes and ticks


MOST_TICKS: Final = 6
_STEPS: Final = (1.0, 2.0, 2.5, 5.0, 10.0)
_MINUS: Final = "−"
_LARGEST_PLAIN: Final = 1e7
_SMALLEST_PLAIN: Final = 1e-4
_FEWEST_LOG_TICKS: Final = 3


@dataclass(frozen=True, slots=True)
class ChartAxis:
    """An axis from `low` to `high` (low < high) with ascending `ticks`."""

    label: str
    low: float
    high: float
    ticks: tuple[float, ...]
    labels: tuple[str, ...]
    logarithmic: bool = False

    def share(self, value: float) -> float:
        """Return the position of `value`, 0 at the low end, 1 at the high end."""
        if not self.logarithmic:
            return (value - self.low) / (self.high - self.low)
        low = math.log(self.low)
        width = math.log(self.high) - low or 1.0  # the logarithms of close numbers may be equal
        return (math.log(value) - low) / width if value > 0.0 else -math.inf

    @property
    def tick_shares(self) -> list[float]:
        """Positions of the ticks."""
        return [self.share(tick) for tick in self.ticks]


def round_axis(
    label: str, values: Iterable[float], *, zero: bool = False, most: int = MOST_TICKS
) -> ChartAxis:
    """Return an axis between round numbers (or `zero`) with 2 to `most` ticks."""
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
    """Return an axis from the smallest to the largest value, above 0 if logarithmic."""
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
    """Return an axis from the first of `ticks` to the last."""
    step = min(later - earlier for earlier, later in pairwise(ticks))
    return ChartAxis(label, ticks[0], ticks[-1], tuple(ticks), labels_of(ticks, step))


def word_axis(label: str, words: Sequence[str]) -> ChartAxis:
    """Return an axis with `words` at 0, 1, 2, …."""
    ticks = tuple(float(place) for place in range(len(words)))
    return ChartAxis(label, -0.5, len(words) - 0.5, ticks, tuple(words))


def labels_of(ticks: Sequence[float], step: float) -> tuple[str, ...]:
    """Return labels of `ticks` that are `step` apart, with equal decimals."""
    largest = max(map(abs, ticks), default=0.0)
    if largest >= _LARGEST_PLAIN or step < _SMALLEST_PLAIN:
        digits = 1 + max(0, math.floor(math.log10(largest)) - math.floor(math.log10(step)))
        return tuple(number_text(tick, digits) for tick in ticks)
    decimals = next(d for d in range(12) if abs(step * 10**d - round(step * 10**d)) < 1e-6)
    return tuple(_signed(f"{abs(tick):,.{decimals}f}", tick) for tick in ticks)


def number_text(value: float, digits: int = 4) -> str:
    """Format `value` with `digits` significant digits, or all integer digits."""
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


# Charts and panels


@dataclass(frozen=True, slots=True)
class ChartCurve:
    """A line through points in the order of `x`, with an optional band. None is a gap.

    Sequences have equal lengths, but `low` and `high` may be empty.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float | None, ...]
    low: tuple[float | None, ...] = ()
    high: tuple[float | None, ...] = ()
    colour: int = 0
    """Index of the colour, shared by related curves."""
    dashed: bool = False

    @property
    def stretches(self) -> list[range]:
        """Indexes of the points between gaps, one range for each line."""
        return _stretches([value is not None for value in self.y])

    @property
    def band_stretches(self) -> list[range]:
        """The same for the band."""
        pairs = zip(self.low, self.high, strict=True)
        return _stretches([low is not None and high is not None for low, high in pairs])


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over one pair of axes. Texts may be empty."""

    title: str
    x: ChartAxis
    y: ChartAxis
    curves: tuple[ChartCurve, ...]
    connected: bool = True
    """True if lines join the points. Otherwise each has an interval."""

    @property
    def has_few_points(self) -> bool:
        """True if each point gets a mark."""
        return all(len(curve.x) <= _MOST_MARKED for curve in self.curves)


@dataclass(frozen=True, slots=True)
class AtlasChart:
    """A metric over two settings, `[rows][columns]`, the lowest row first."""

    title: str
    x_label: str
    y_label: str
    columns: tuple[str, ...]
    rows: tuple[str, ...]
    values: tuple[tuple[float | None, ...], ...]
    scale: ChartAxis
    """Meaning of the colours."""
    alike: tuple[tuple[bool, ...], ...]
    """True for cells tied with the best."""
    best: tuple[int, int] | None
    """Row and column of the best cell, or None if unknown."""

    @property
    def marked(self) -> set[tuple[int, int]]:
        """Rows and columns of the other cells tied with the best."""
        alike = {
            (row, column)
            for row, cells in enumerate(self.alike)
            for column, is_alike in enumerate(cells)
            if is_alike
        }
        return alike - {self.best}


@dataclass(frozen=True, slots=True)
class Picture:
    """A title, `panels` one below the other, notes, and a text alternative."""

    title: str
    summary: str
    panels: tuple[Chart | AtlasChart, ...]
    notes: tuple[str, ...] = ()
    band: str = ""
    """Meaning of the bands, shown if there are any."""


_MOST_MARKED = 40


def _stretches(there: list[bool]) -> list[range]:
    stretches, start = [], None
    for place, is_there in enumerate([*there, False]):
        if is_there and start is None:
            start = place
        elif not is_there and start is not None:
            stretches.append(range(start, place))
            start = None
    return stretches


# Values beyond the axis


_FAR: Final = 6.0
"""Outliers are further from the middle half of the values than this many times its width."""


def kept_range(values: Sequence[float]) -> tuple[float, float]:
    """Return the smallest and largest of `values` without outliers."""
    ordered = sorted(values)
    low, high = ordered[len(ordered) // 4], ordered[(3 * len(ordered)) // 4]
    margin = _FAR * (high - low)
    if not margin:
        return ordered[0], ordered[-1]
    kept = [value for value in ordered if low - margin <= value <= high + margin]
    return kept[0], kept[-1]


def axis_with_cut(label: str, curves: Sequence[ChartCurve]) -> tuple[ChartAxis, str]:
    """Return an axis for `curves`, and a note about values beyond it."""
    values = [value for curve in curves for value in curve.y if value is not None]
    low, high = kept_range(values)
    edges = [
        value
        for curve in curves
        for edge in (curve.low, curve.high)
        for value in edge
        # a band may exceed the curves by their range at most
        if value is not None and 2 * low - high <= value <= 2 * high - low
    ]
    axis = round_axis(label, [low, high, *edges])
    return axis, words_of_cut(values, axis)


def words_of_cut(values: Sequence[float], axis: ChartAxis) -> str:
    """Return a note if `values` are beyond `axis`, or ""."""
    beyond = []
    if min(values) < axis.low:
        beyond.append(f"below {number_text(axis.low)}, down to {number_text(min(values))},")
    if max(values) > axis.high:
        beyond.append(f"above {number_text(axis.high)}, up to {number_text(max(values))},")
    if not beyond or not math.isfinite(axis.high - axis.low):
        return ""
    return f"What lies {' or '.join(beyond)} is cut."
