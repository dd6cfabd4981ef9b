"""Contrast between colours, and inks on a tint: the better of two, and paler ones."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

from rich.color import Color, ColorSystem, ColorType, blend_rgb
from rich.color_triplet import ColorTriplet
from rich.style import Style

PALEST: Final = 3.0
"""The least contrast of a sign with its cell."""
_SLIGHT: Final = 1.0 / 3.0
_STEPS: Final = 24
_NO_LEAD, _SOME_LEAD, _CLEAR_LEAD = Style(dim=True), Style(bold=False), Style(bold=True)


def contrast(one: Color, other: Color) -> float:
    """Return the contrast ratio of WCAG 2.2 of two colours, 1 to 21."""
    low, high = sorted((_luminance(one.get_truecolor()), _luminance(other.get_truecolor())))
    return (high + 0.05) / (low + 0.05)


def _luminance(color: ColorTriplet) -> float:
    """Return the relative luminance of WCAG 2.2, 0 to 1."""
    red, green, blue = (
        channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4
        for channel in color.normalized
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def with_ink(style: Style, *inks: str) -> Style:
    """Return ``style``; where it has a background alone, with that of ``inks`` which contrasts most."""
    ground = style.bgcolor
    if ground is None or style.color is not None:
        return style
    return style + Style(color=max(map(Color.parse, inks), key=lambda ink: contrast(ink, ground)))


@lru_cache(4_096)
def paled(style: Style, share: float) -> Style:
    """Return ``style`` with its ink so pale that ``share`` (0 to 1) of its contrast above 3 is left.

    The 16 colours of a terminal have no paler ones: they stay as they are. Where there is no background, ink
    is dim, usual or bold.
    """
    ink, ground = style.color, style.bgcolor
    if ink is None or ground is None:
        return style + (_NO_LEAD if share < _SLIGHT else _SOME_LEAD if share < 2 * _SLIGHT else _CLEAR_LEAD)
    if share >= 1.0 or ink.type not in (ColorType.TRUECOLOR, ColorType.EIGHT_BIT):
        return style
    least = PALEST + share * (contrast(ink, ground) - PALEST)
    for step in range(1, _STEPS):
        mixed = blend_rgb(ground.get_truecolor(), ink.get_truecolor(), step / _STEPS)
        pale = Color.from_triplet(mixed)
        if ink.type is ColorType.EIGHT_BIT:
            pale = pale.downgrade(ColorSystem.EIGHT_BIT)
        if contrast(pale, ground) >= least:
            return style + Style(color=pale)
    return style
