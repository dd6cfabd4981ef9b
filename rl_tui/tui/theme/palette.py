"""The palette of each colour depth, hand-picked: monotone in luminance and safe for colour-blind eyes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal

from rl_tui.tui.theme.palettes import colours_16, colours_256, colours_none, colours_truecolor
from rl_tui.tui.theme.roles import Palette

__all__ = ["Depth", "Palette", "palette_for"]

Depth = Literal["none", "16", "256", "truecolor"]

_PALETTES: Final[Mapping[tuple[Depth, bool], Palette]] = {
    ("none", True): colours_none.ANY,
    ("none", False): colours_none.ANY,
    ("16", True): colours_16.DARK,
    ("16", False): colours_16.LIGHT,
    ("256", True): colours_256.DARK,
    ("256", False): colours_256.LIGHT,
    ("truecolor", True): colours_truecolor.DARK,
    ("truecolor", False): colours_truecolor.LIGHT,
}


def palette_for(depth: Depth, dark: bool) -> Palette:
    """Return the palette for a terminal of ``depth`` with a ``dark`` or a light background."""
    return _PALETTES[depth, dark]
