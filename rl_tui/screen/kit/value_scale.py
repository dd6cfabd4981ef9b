"""The scale of all tints of values, for map and table alike: that of V of what is known."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.numbers_in_common import known_v
from rl_tui.screen.theme.roles import Palette
from rl_tui.worlds.mdp.space import FloatArray

_LEAST_TO_CUT: Final = 8  # values; the ends of fewer say nothing of outliers
_TAIL: Final = 16  # of so many values one at each end may be an outlier
_FAR: Final = 4.0  # times the range without the tails
_BOTH_SIGNS: Final = 0.1  # of the larger end that the other one must reach
_NEAR_ZERO: Final = 0.5  # of the greatest value: a scale that begins below that begins at 0


@dataclass(frozen=True, slots=True)
class ValueScale:
    """The values between which tints change. What lies beyond has the tint of that end.

    ``is_signed`` says that both signs matter: then a 0 in the middle is grey, and both ``ends``, the values
    that have the tints of the ends, are as far from it.
    """

    low: float = 0.0
    high: float = 0.0
    is_signed: bool = field(init=False)
    ends: tuple[float, float] = field(init=False)

    def __post_init__(self) -> None:
        least, most = sorted((-self.low, self.high))
        is_signed = self.low < 0.0 < self.high and least > _BOTH_SIGNS * most
        object.__setattr__(self, "is_signed", is_signed)
        object.__setattr__(self, "ends", (-most, most) if is_signed else (self.low, self.high))

    def style(self, x: float, palette: Palette) -> Style:
        """Return the tint of ``x``; of NaN that of no value."""
        if x != x:
            return palette.text
        low, high = self.ends
        if self.is_signed:
            return palette.signed_value(x / high)
        return palette.value((x - low) / (high - low) if high > low else 0.0)

    def side(self, x: float) -> int:
        """Return −1 where ``x`` lies below the scale, 1 where above, else 0."""
        low, high = self.ends
        if low <= x <= high:
            return 0
        slack = 1e-9 * (high - low)
        return (x > high + slack) - (x < low - slack) if high > low else 0


def value_scale(values: FloatArray) -> ValueScale | None:
    """Return the scale of finite ``values``, robust to outliers; None where there are none.

    Where the least and the greatest are more than four times as far apart as the middle 7/8, it ends there.
    A scale of positive values begins at 0 where the least is less than half of the greatest; that of a single
    value has 0 as its other end.
    """
    if not len(values):
        return None
    low, high = float(values.min()), float(values.max())
    if len(values) >= _LEAST_TO_CUT:
        tail = len(values) // _TAIL
        parts = np.partition(values, (tail, len(values) - 1 - tail))
        below, above = float(parts[tail]), float(parts[len(values) - 1 - tail])
        if high - low > _FAR * (above - below) > 0.0:
            low, high = below, above
    if low == high:
        return ValueScale(min(low, 0.0), max(high, 0.0))
    return ValueScale(0.0 if 0.0 <= low < _NEAR_ZERO * high else low, high)


class SteadyScale:
    """The scale in force, which only gets wider until another run begins: tints must not flicker.

    While policies are studied they share it; after that it is the agent's again.
    """

    def __init__(self) -> None:
        self._scale: ValueScale | None = None
        self._is_study = False

    def clear(self) -> None:
        """Forget the scale: another run begins."""
        self._scale = None

    def of(self, snapshot: Snapshot) -> ValueScale:
        """Return the scale with what is known in ``snapshot``, in both lanes in view."""
        is_study, now = snapshot.answers.studied is not None, value_scale(known_v(snapshot))
        if self._is_study and not is_study:
            self.clear()
        self._is_study = is_study
        before = self._scale
        if now is not None and before is not None:
            now = ValueScale(min(before.low, now.low), max(before.high, now.high))
        self._scale = now or before
        return self._scale or ValueScale()
