"""Colours on white, distinguishable by colour-blind readers and in print."""

from __future__ import annotations

from typing import Final

BACKGROUND: Final = "#ffffff"
TEXT: Final = "#1d242a"
DIM: Final = "#59636b"
GRID: Final = "#e3e7ea"
FRAME: Final = "#8a949b"
MISSING: Final = "#eceff1"
LINES: Final = ("#0068a8", "#c85000", "#6414dc", "#d4709c", "#8c3c28", "#1d242a")
"""Colours of curves. From the seventh on they repeat with another dash."""
DASHES: Final = ("", "7 4", "2 3", "9 3 2 3")
"""Dash patterns in pixels of line and gap, for each round of colours."""
RAMP: Final = (
    *("#fbf8d0", "#ebf2c3", "#d3e9bf", "#b1dcbd", "#8bcdbd", "#66bac0"),
    *("#48a3c0", "#3587b4", "#2a69a2", "#234d8c", "#1a3470"),
)
"""Colours of a heat map from the smallest to the largest value, with decreasing luminance."""
_ON_DARK, _ON_LIGHT = "#ffffff", "#05080b"


def line_colour(place: int) -> str:
    """Return the colour of curve `place`, from 0."""
    return LINES[place % len(LINES)]


def line_dash(place: int, *, dashed: bool) -> str:
    """Return the dash pattern of curve `place`, empty for a solid line."""
    return DASHES[(place // len(LINES) + dashed) % len(DASHES)]


def ramp_colour(share: float) -> str:
    """Return the interpolated colour at `share`, 0 to 1."""
    place = min(max(share, 0.0), 1.0) * (len(RAMP) - 1)
    left = min(int(place), len(RAMP) - 2)
    part = place - left
    mixed = (
        round(one + (other - one) * part)
        for one, other in zip(_channels(RAMP[left]), _channels(RAMP[left + 1]), strict=True)
    )
    return "#" + "".join(f"{channel:02x}" for channel in mixed)


def text_on_ramp(share: float) -> str:
    """Return the colour of text on `ramp_colour` of `share`."""
    return max(_ON_DARK, _ON_LIGHT, key=lambda text: contrast(text, ramp_colour(share)))


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours, 1 to 21 (WCAG 2.2)."""
    low, high = sorted((_luminance(one), _luminance(other)))
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    parts = (channel / 255 for channel in _channels(colour))
    red, green, blue = (
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _channels(colour: str) -> list[int]:
    return [int(colour[first : first + 2], 16) for first in (1, 3, 5)]
