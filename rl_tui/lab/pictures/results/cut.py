"""Axes that a few values far off do not spoil: what lies beyond is cut, and that is said."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from rl_tui.lab.pictures.axis import ChartAxis, number_text, round_axis
from rl_tui.lab.pictures.picture import ChartCurve

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
