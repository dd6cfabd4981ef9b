"""A picture of results as data: charts and heat maps with their axes, without colours or pixels.

Values far from the others would flatten a chart. Its axis leaves them out, and a note says so.
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


# Charts and panels


@dataclass(frozen=True, slots=True)
class ChartCurve:
    """A line through points, in the order of ``x``, with a band around it where ``low`` and ``high`` are.

    All are of one length but for ``low`` and ``high``, which may be empty. None is a gap.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float | None, ...]
    low: tuple[float | None, ...] = ()
    high: tuple[float | None, ...] = ()
    colour: int = 0
    """Its place among the colours; curves that belong together share it."""
    dashed: bool = False

    @property
    def stretches(self) -> list[range]:
        """The places of the points between gaps: one line each."""
        return _stretches([value is not None for value in self.y])

    @property
    def band_stretches(self) -> list[range]:
        """The places of the points of the band, likewise."""
        pairs = zip(self.low, self.high, strict=True)
        return _stretches([low is not None and high is not None for low, high in pairs])


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over one pair of axes. The title may be empty, and so may the names of all curves."""

    title: str
    x: ChartAxis
    y: ChartAxis
    curves: tuple[ChartCurve, ...]
    connected: bool = True
    """Whether lines join the points; if not, each has its interval beside it."""

    @property
    def has_few_points(self) -> bool:
        """Whether each point is worth a mark of its own."""
        return all(len(curve.x) <= _MOST_MARKED for curve in self.curves)


@dataclass(frozen=True, slots=True)
class AtlasChart:
    """A measure over two settings, a cell for each pair of values. The title may be empty.

    ``values`` and ``alike`` are [rows][columns]; the first row is the lowest. None is a cell without a value.
    """

    title: str
    x_label: str
    y_label: str
    columns: tuple[str, ...]
    """The names of the columns."""
    rows: tuple[str, ...]
    """The names of the rows."""
    values: tuple[tuple[float | None, ...], ...]
    scale: ChartAxis
    """What the colours mean."""
    alike: tuple[tuple[bool, ...], ...]
    """Whether a cell does not differ from the best."""
    best: tuple[int, int] | None
    """Row and column of the best cell, None where nothing says which is."""

    @property
    def marked(self) -> set[tuple[int, int]]:
        """Rows and columns of the cells that do not differ from the best, without it."""
        alike = {
            (row, column)
            for row, cells in enumerate(self.alike)
            for column, is_alike in enumerate(cells)
            if is_alike
        }
        return alike - {self.best}


@dataclass(frozen=True, slots=True)
class Picture:
    """What is drawn: ``panels`` one below the other, under a ``title``, with ``notes`` at the end.

    ``summary`` tells the picture to those who cannot see it.
    """

    title: str
    summary: str
    panels: tuple[Chart | AtlasChart, ...]
    notes: tuple[str, ...] = ()
    band: str = ""
    """What the bands around curves mean; said where they are drawn."""


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
"""So many times as far from the middle half as that is wide: what lies further does not count."""


def kept_range(values: Sequence[float]) -> tuple[float, float]:
    """Return the least and the largest of ``values`` that do not lie far from their middle half."""
    ordered = sorted(values)
    low, high = ordered[len(ordered) // 4], ordered[(3 * len(ordered)) // 4]
    margin = _FAR * (high - low)
    if not margin:
        return ordered[0], ordered[-1]
    kept = [value for value in ordered if low - margin <= value <= high + margin]
    return kept[0], kept[-1]


def axis_with_cut(label: str, curves: Sequence[ChartCurve]) -> tuple[ChartAxis, str]:
    """Return an axis for ``curves`` with their bands, and what to say of values that it leaves out."""
    values = [value for curve in curves for value in curve.y if value is not None]
    low, high = kept_range(values)
    edges = [
        value
        for curve in curves
        for edge in (curve.low, curve.high)
        for value in edge
        # a band may reach as far again as the curves do, not further
        if value is not None and 2 * low - high <= value <= 2 * high - low
    ]
    axis = round_axis(label, [low, high, *edges])
    return axis, words_of_cut(values, axis)


def words_of_cut(values: Sequence[float], axis: ChartAxis) -> str:
    """Return that some of ``values`` lie beyond ``axis``; empty if none does."""
    beyond = []
    if min(values) < axis.low:
        beyond.append(f"below {number_text(axis.low)}, down to {number_text(min(values))},")
    if max(values) > axis.high:
        beyond.append(f"above {number_text(axis.high)}, up to {number_text(max(values))},")
    if not beyond or not math.isfinite(axis.high - axis.low):
        return ""
    return f"What lies {' or '.join(beyond)} is cut."
