"""The roles of a palette."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Final

from rich.color import Color, ColorSystem, ColorType, blend_rgb
from rich.color_triplet import ColorTriplet
from rich.style import Style

# Inks

PALEST: Final = 3.0  # the least contrast of a symbol with its cell
_SLIGHT: Final = 1.0 / 3.0
_STEPS: Final = 24
_MIXABLE: Final = (ColorType.TRUECOLOR, ColorType.EIGHT_BIT)
_NO_LEAD, _SOME_LEAD, _CLEAR_LEAD = Style(dim=True), Style(bold=False), Style(bold=True)


def contrast(one: Color, other: Color) -> float:
    """Return the contrast ratio by WCAG 2.2, from 1 to 21."""
    low, high = sorted((_luminance(one.get_truecolor()), _luminance(other.get_truecolor())))
    return (high + 0.05) / (low + 0.05)


def _luminance(color: ColorTriplet) -> float:
    red, green, blue = (
        channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4
        for channel in color.normalized
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _with_ink(text: str, inks: Sequence[str]) -> Style:
    """Return the style ``text``. A lone colour is a background with the ink of highest contrast."""
    if not text.startswith("#") and not text.isdigit():
        return Style.parse(text)
    ground = Color.parse(f"color({text})" if text.isdigit() else text)
    return Style(color=max(map(Color.parse, inks), key=lambda ink: contrast(ink, ground)), bgcolor=ground)


@lru_cache(4_096)
def paled(style: Style, share: float) -> Style:
    """Keep ``share`` (0 to 1) of the ink's contrast above 3."""
    ink, ground = style.color, style.bgcolor
    if ink is None or ground is None:
        return style + (_NO_LEAD if share < _SLIGHT else _SOME_LEAD if share < 2 * _SLIGHT else _CLEAR_LEAD)
    if share >= 1.0 or ink.type not in _MIXABLE:
        return style
    least = PALEST + share * (contrast(ink, ground) - PALEST)
    for step in range(1, _STEPS):
        pale = faded(style, step / _STEPS)
        assert pale.color is not None
        if contrast(pale.color, ground) >= least:
            return pale
    return style


@lru_cache(4_096)
def faded(style: Style, share: float) -> Style:
    """Mix ``share`` (0 to 1) of the ink with its ground."""
    ink, ground = style.color, style.bgcolor
    if ink is None or ground is None or ink.type not in _MIXABLE:
        return style
    mixed = Color.from_triplet(blend_rgb(ground.get_truecolor(), ink.get_truecolor(), share))
    return style + Style(
        color=mixed.downgrade(ColorSystem.EIGHT_BIT) if ink.type is ColorType.EIGHT_BIT else mixed
    )


@lru_cache(4_096)
def readable(style: Style, on: Style) -> Style:
    """Mix the ink with that of ``on`` until it is a readable symbol on its ground."""
    ink, ground = style.color, on.bgcolor
    if ink is None or on.color is None or ground is None or ink.type not in _MIXABLE:
        return style
    for step in range(_STEPS + 1):
        mixed = faded(Style(color=on.color, bgcolor=ink), step / _STEPS).color
        if mixed is not None and contrast(mixed, ground) >= PALEST:
            return style + Style(color=mixed)
    return style


# Roles


@dataclass(frozen=True)
class Palette:
    """The styles of one colour depth on a dark or a light background, none of them empty.

    One colour has one meaning: ``press`` can be pressed, ``best`` looks best, ``you`` (``focus`` at a cursor)
    is a person's choice, ``source`` is the origin of an update's estimate.

    ``values``, ``signed`` and ``visits`` go from low to high. ``unvisited`` must not look like a zero.
    ``agent``, ``updated``, ``source``, ``breakpoint``, ``focus`` and terminal cells may cover any cell.
    """

    name: str
    values: tuple[Style, ...]
    signed: tuple[Style, ...]
    visits: tuple[Style, ...]
    lanes: tuple[Style, ...]
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
    good: Style
    bad: Style
    slider_rest: Style
    focus: Style
    breakpoint: Style

    @cached_property
    def tells_lanes_apart(self) -> bool:
        """True if fixed colours distinguish the runs for every eye."""
        return all(
            style.color is not None and style.color.type in (ColorType.EIGHT_BIT, ColorType.TRUECOLOR)
            for style in self.lanes
        )

    @cached_property
    def tints(self) -> bool:
        """True if values have background colours."""
        return any(style.bgcolor is not None for style in self.values)

    @cached_property
    def has_shades(self) -> bool:
        """True if there are paler inks and colours on tints."""
        return self.tints and self.tells_lanes_apart

    @property
    def source_line(self) -> Style:
        """The lines from an estimate's source."""
        return Style(color=self.source.bgcolor)

    def value(self, fraction: float) -> Style:
        """Return the style at ``fraction`` (0 to 1, clamped, NaN as 0) of the values."""
        return _at(self.values, fraction)

    def visit_count(self, fraction: float) -> Style:
        """Return the style at ``fraction`` (0 to 1, clamped, NaN as 0) of the visits."""
        return _at(self.visits, fraction)

    def signed_value(self, fraction: float) -> Style:
        """Return the style at ``fraction`` (−1 to 1, clamped, NaN as 0) of the largest magnitude."""
        return _at(self.signed, 0.5 if math.isnan(fraction) else (fraction + 1.0) / 2.0)

    def error(self, sign: int) -> Style:
        """Return the style of an error's ``sign``."""
        return self.good if sign > 0 else self.bad if sign < 0 else self.dim


def dark_and_light(
    depth: str,
    inks: tuple[str, str],
    values: tuple[str, str],
    signed: tuple[str, str],
    visits: tuple[str, str],
    lanes: tuple[str, str],
    **roles: tuple[str, str],
) -> tuple[Palette, Palette]:
    """Return the dark and the light palette of ``depth``.

    The styles of a ramp are separated by commas. A lone colour gets the more readable of ``inks``.
    """

    def palette(name: str, column: int) -> Palette:
        low_to_high, around_0, few_to_many = (
            tuple(_with_ink(text, inks) for text in ramp[column].split(", "))
            for ramp in (values, signed, visits)
        )
        others: dict[str, Any] = {role: Style.parse(row[column]) for role, row in roles.items()}
        inks_of_lanes = styles(*lanes[column].split(", "))
        return Palette(f"{depth} {name}", low_to_high, around_0, few_to_many, inks_of_lanes, **others)

    return palette("dark", 0), palette("light", 1)


def styles(*texts: str) -> tuple[Style, ...]:
    """Parse styles written as ``foreground on background``."""
    return tuple(Style.parse(text) for text in texts)


def _at(ramp: Sequence[Style], fraction: float) -> Style:
    last = len(ramp) - 1
    if not fraction > 0.0:
        return ramp[0]
    return ramp[min(last, round(fraction * last))] if fraction < 1.0 else ramp[last]
