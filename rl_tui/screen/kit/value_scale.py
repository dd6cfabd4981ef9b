"""Colour scales. The layer Q uses the known V."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from functools import lru_cache
from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.kit.layers import Layer, layer_numbers, least_error, policy_numbers
from rl_tui.screen.kit.numbers_in_common import lanes_in_view
from rl_tui.screen.kit.snapshot_facts import is_kept_back, studied_kind
from rl_tui.screen.theme.look import Look
from rl_tui.screen.theme.roles import Palette
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.world import World

_LEAST_TO_CUT: Final = 8  # values: fewer cannot show outliers
_TAIL: Final = 16  # one in this many values at each end may be an outlier
_FAR: Final = 4.0  # times the range without the tails
_BOTH_SIGNS: Final = 0.1  # share of the larger end that the other end must reach
_POLICIES: Final = 2 * len(PolicyKind)  # of both runs
_NEAR_ZERO: Final = 0.5  # share of the maximum: a scale starts at 0 if its minimum is below


class Ramp(Enum):
    """Colours for values, for errors around 0, and for visits."""

    VALUES = auto()
    ERRORS = auto()
    VISITS = auto()


_COLUMNS: Final = {Ramp.VALUES: 11, Ramp.ERRORS: 11, Ramp.VISITS: 6}
RAMPS: Final = {Layer.ERROR: Ramp.ERRORS, Layer.LANES: Ramp.ERRORS, Layer.VISITS: Ramp.VISITS}
"""Colour ramps of layers, by default ``VALUES``."""


@dataclass(frozen=True, slots=True)
class ValueScale:
    """The range of numbers over which colours change.

    ``is_signed``: both signs matter. ``cuts``: numbers beyond the ends share their colours. Visits use a
    logarithmic scale.
    """

    low: float = 0.0
    high: float = 0.0
    ramp: Ramp = Ramp.VALUES
    cuts: tuple[bool, bool] = (False, False)
    is_signed: bool = field(init=False)
    ends: tuple[float, float] = field(init=False)

    def __post_init__(self) -> None:
        least, most = sorted((-self.low, self.high))
        has_both = self.low < 0.0 < self.high and least > _BOTH_SIGNS * most
        is_signed = self.ramp is Ramp.ERRORS or (self.ramp is Ramp.VALUES and has_both)
        object.__setattr__(self, "is_signed", is_signed)
        object.__setattr__(self, "ends", (-most, most) if is_signed else (self.low, self.high))

    def tints(self, palette: Palette) -> tuple[Style, ...]:
        """Return the colours from smallest to largest."""
        if self.ramp is Ramp.VISITS:
            return palette.visits
        return palette.signed if self.is_signed else palette.values

    def style(self, x: float, palette: Palette) -> Style:
        """Return a colour, plain for NaN."""
        if x != x:
            return palette.text
        low, high = self.ends
        if self.ramp is Ramp.VISITS:
            return palette.visit_count(math.log1p(x) / math.log1p(high) if high > 0.0 else 0.0)
        if self.is_signed:
            return palette.signed_value(x / high if high > 0.0 else 0.0)
        return palette.value((x - low) / (high - low) if high > low else 0.0)

    def side(self, x: float) -> int:
        """Return −1 below the scale, 1 above, else 0."""
        low, high = self.ends
        if low <= x <= high:
            return 0
        slack = 1e-9 * (high - low)
        return (x > high + slack) - (x < low - slack) if high > low else 0


def value_scale(values: FloatArray, ramp: Ramp = Ramp.VALUES) -> ValueScale | None:
    """Return a scale robust to outliers, or None without finite ``values``.

    It covers the middle 7/8 of the numbers other than 0 if the full range is over four times as wide, and
    starts at 0 if the minimum is below half of the maximum. Visits are not cut.
    """
    if not len(values):
        return None
    low, high = float(values.min()), float(values.max())
    if ramp is Ramp.VISITS:
        return ValueScale(0.0, high, ramp)
    learned = values[values != 0.0]
    if len(learned) >= _LEAST_TO_CUT:
        tail = len(learned) // _TAIL
        parts = np.partition(learned, (tail, len(learned) - 1 - tail))
        below, above = float(parts[tail]), float(parts[len(learned) - 1 - tail])
        if high - low > _FAR * (above - below) > 0.0:
            low, high = low and below, high and above  # a scale that ends at 0 still does
    if low == high:
        return ValueScale(min(low, 0.0), max(high, 0.0), ramp)
    return ValueScale(0.0 if 0.0 <= low < _NEAR_ZERO * high else low, high, ramp)


class SteadyScale:
    """The scales of layers. They only widen, so that colours do not flicker.

    While a policy is studied, V of all policies has one scale, whichever was studied before.
    """

    def __init__(self) -> None:
        self._scales: dict[Layer, ValueScale] = {}

    def clear(self) -> None:
        """Forget all scales."""
        self._scales.clear()

    @property
    def of_v(self) -> ValueScale:
        """The scale of V, updated by :meth:`of`."""
        return self._scales.get(Layer.Q, ValueScale())

    def of(self, snapshot: Snapshot, layer: Layer = Layer.Q) -> ValueScale:
        """Return both runs' common scale."""
        if layer not in (Layer.Q, Layer.LANDSCAPE):
            self.of(snapshot)
        layer = Layer.Q if layer is Layer.LANDSCAPE else layer
        (values, coloured), ramp = layer_numbers(snapshot, layer), RAMPS.get(layer, Ramp.VALUES)
        if layer is Layer.Q and studied_kind(snapshot) is not None:
            scale = self._of_policies(snapshot)
        else:
            if layer is Layer.Q:
                self._scales.pop(Layer.POLICY, None)  # the agent may learn before the next study
            now = value_scale(values, ramp)
            if now is not None and layer is Layer.ERROR:  # else rounding would be as red as a large error
                least = least_error(snapshot)
                now = _joined(now, ValueScale(-least, least, ramp))
            scale = self._widened(layer, now)
        if scale is None:
            return ValueScale(ramp=ramp)
        if len(coloured):
            cuts = scale.side(float(coloured.min())) < 0, scale.side(float(coloured.max())) > 0
            scale = replace(scale, cuts=cuts)
        return scale

    def _of_policies(self, snapshot: Snapshot) -> ValueScale | None:
        scales = [
            (kind, _policy_scale(lane.world, answer))
            for lane in lanes_in_view(snapshot)
            for kind, answer in lane.answers.policies.items()
            if answer.v is not None and not is_kept_back(lane, kind)
        ]
        optimal = (scale for kind, scale in scales if kind is PolicyKind.OPTIMAL)
        known = _joined(self._scales.get(Layer.Q), *optimal)
        most = 0.0 if known is None else _FAR * max(-known.low, known.high)
        if not most:  # the optimal values may follow, so nothing is kept
            return _joined(*(scale for _, scale in scales))
        # a policy that wanders has returns next to which all others look equal
        near = (each for _, each in scales if each and max(-each.low, each.high) <= most)
        return self._widened(Layer.POLICY, _joined(known, *near))

    def _widened(self, layer: Layer, now: ValueScale | None) -> ValueScale | None:
        scale = _joined(now, self._scales.get(layer))
        if scale is not None:
            self._scales[layer] = scale
        return scale


@lru_cache(_POLICIES)
def _policy_scale(world: World, answer: PolicyAnswer) -> ValueScale | None:
    return value_scale(policy_numbers(world, answer))


def _joined(*scales: ValueScale | None) -> ValueScale | None:
    known = [each for each in scales if each is not None]
    if not known:
        return None
    return ValueScale(min(each.low for each in known), max(each.high for each in known), known[0].ramp)


# A scale as text


_END: Final = 4  # characters of an end value
_TWO_DECIMALS_FROM: Final = 0.01


def scale_pieces(scale: ValueScale, look: Look, *, every: int = 1) -> tuple[Piece, ...]:
    """Draw a bar between the scale's ends. ``every`` leaves out columns of the bar."""
    low, high = scale.ends
    if high <= low:
        return ()
    palette = look.palette
    if scale.ramp is Ramp.VISITS:
        ends = [numbers.count(int(end)) for end in (low, high)]
    else:
        ends = [_end_text(end, look) for end in (low, high)]
    if not palette.tints:
        return (Piece(f"{ends[0]} to {ends[1]}", palette.dim),)
    colours, columns = scale.tints(palette), _COLUMNS[scale.ramp]
    tints = (Piece(" ", colours[place * len(colours) // columns]) for place in range(0, columns, every))
    first, last = ("≤" if scale.cuts[0] else "", "≥" if scale.cuts[1] else "")
    return Piece(f"{first}{ends[0]} ", palette.dim), *tints, Piece(f" {last}{ends[1]}", palette.dim)


def _end_text(end: float, look: Look) -> str:
    return numbers.value(end, _END, look.glyphs, 2 if abs(end) >= _TWO_DECIMALS_FROM else 3) if end else "0"
