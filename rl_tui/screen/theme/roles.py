"""What every palette has to say: a style for each role, and the ramps of the heat maps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rich.color import ColorType
from rich.style import Style

from rl_tui.screen.theme.inks import with_ink


@dataclass(frozen=True, slots=True)
class Palette:
    """The styles of one colour depth on a dark or a light background. None of them is empty.

    One colour has one meaning: ``press`` can be pressed, ``best`` looks best, ``you`` (``focus`` where a
    cursor stands) is what a person does, white on ink is the ``agent``, ``source`` is where an update's
    estimate came from, ``good`` and ``bad`` are the signs of its error.

    ``values`` goes from low to high and is for values alone, ``signed`` (of odd length) from negative through
    a grey 0 to positive, ``visits`` from few to many; all have a background and a readable foreground where
    the depth has colours for it. ``unvisited`` is for estimates that were never updated, and the floor of a
    map, which must not look like a zero. ``agent``, ``updated``, ``source``, ``breakpoint``, ``focus`` and
    what ends an episode bring their own background, so that they may be laid over any cell; the other roles
    are foregrounds for the background of the panel. That is the colour of ``page``, by which cells are kept
    apart; the foreground of ``wall`` is its lit upper edge. ``lane_1`` to ``lane_4`` are those of the lines
    of runs side by side.
    """

    name: str
    values: tuple[Style, ...]
    signed: tuple[Style, ...]
    visits: tuple[Style, ...]
    unvisited: Style
    page: Style
    rule: Style
    text: Style
    dim: Style
    strong: Style
    press: Style
    agent: Style
    best: Style
    you: Style
    updated: Style
    source: Style
    hole: Style
    cliff: Style
    goal: Style
    wall: Style
    start: Style
    optimum: Style
    greedy_line: Style
    episodes: Style
    lane_1: Style
    lane_2: Style
    lane_3: Style
    lane_4: Style
    good: Style
    bad: Style
    slider_done: Style
    slider_rest: Style
    slider_thumb: Style
    focus: Style
    breakpoint: Style

    @property
    def lanes(self) -> tuple[Style, ...]:
        """The styles of runs side by side, in their order."""
        return self.lane_1, self.lane_2, self.lane_3, self.lane_4

    @property
    def tells_lanes_apart(self) -> bool:
        """Whether any eye tells the lanes by their colours; those of the terminal itself may be any."""
        return all(
            style.color is not None and style.color.type in (ColorType.EIGHT_BIT, ColorType.TRUECOLOR)
            for style in self.lanes
        )

    @property
    def tints(self) -> bool:
        """Whether values have colours behind them."""
        return any(style.bgcolor is not None for style in self.values)

    @property
    def has_shades(self) -> bool:
        """Whether there are paler inks and colours that any eye tells apart on a tint."""
        return self.tints and self.tells_lanes_apart

    def value(self, fraction: float) -> Style:
        """Return the style at ``fraction`` (0 to 1, clamped; NaN as 0) of the way from low to high."""
        return _at(self.values, fraction)

    def visit_count(self, fraction: float) -> Style:
        """Return the style at ``fraction`` (0 to 1, clamped; NaN as 0) of the way from few visits to many."""
        return _at(self.visits, fraction)

    def signed_value(self, fraction: float) -> Style:
        """Return the style at ``fraction`` (−1 to 1, clamped; NaN as 0) of the largest magnitude."""
        return _at(self.signed, 0.5 if math.isnan(fraction) else (fraction + 1.0) / 2.0)


def dark_and_light(
    depth: str,
    inks: tuple[str, str],
    values: Sequence[tuple[str, str]],
    signed: Sequence[tuple[str, str]],
    visits: Sequence[tuple[str, str]],
    **roles: tuple[str, str],
) -> tuple[Palette, Palette]:
    """Return the palettes of ``depth`` for a dark and a light background.

    In every row of every role the style of the dark one stands first, then that of the light one. What has a
    background alone gets the better one of ``inks``.
    """

    def palette(name: str, column: int) -> Palette:
        def ramp(rows: Sequence[tuple[str, str]]) -> tuple[Style, ...]:
            return tuple(with_ink(style, *inks) for style in styles(*(row[column] for row in rows)))

        return Palette(
            name=f"{depth} {name}",
            values=ramp(values),
            signed=ramp(signed),
            visits=ramp(visits),
            **{role: Style.parse(row[column]) for role, row in roles.items()},
        )

    return palette("dark", 0), palette("light", 1)


def styles(*texts: str) -> tuple[Style, ...]:
    """Return the styles written as ``foreground on background``."""
    return tuple(Style.parse(text) for text in texts)


def _at(ramp: Sequence[Style], fraction: float) -> Style:
    last = len(ramp) - 1
    if not fraction > 0.0:
        return ramp[0]
    return ramp[min(last, round(fraction * last))] if fraction < 1.0 else ramp[last]
