"""The look of a screen, chosen once from the terminal and the theme.

Textual rounds RGB to the colours of the terminal. Two facts matter:

* Without ``ansi_color=True`` it first turns all colours into RGB. Of 256 colours all survive this, but of 16
  the nearest is guessed. So "16" and "none" need it: :func:`is_native`.
* It reads NO_COLOR when an App is made, see :func:`environment_for`. ``TEXTUAL_COLOR_SYSTEM`` overrides
  detection when textual is imported (``none`` crashes), so the command line removes it before.

Rich exports SVG in truecolor, and default colours on its own dark background. So pictures need RGB from the
start: ``ansi_color=False``, ``themes_for(depth, picture=True)``, and PICTURE_DARK and PICTURE_LIGHT as ANSI
themes of the app.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import Final, Literal

from rl_tui.screen.theme import palettes
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.screen.theme.roles import Palette

# Palettes for each colour depth


__all__ = ["Depth", "Palette", "palette_for"]

Depth = Literal["none", "16", "256", "truecolor"]

_PALETTES: Final[Mapping[Depth, tuple[Palette, Palette]]] = {  # light, dark
    "none": (palettes.NO_COLOURS, palettes.NO_COLOURS),
    "16": (palettes.LIGHT_16, palettes.DARK_16),
    "256": (palettes.LIGHT_256, palettes.DARK_256),
    "truecolor": (palettes.LIGHT, palettes.DARK),
}


def palette_for(depth: Depth, dark: bool) -> Palette:
    """Return the palette for the background."""
    return _PALETTES[depth][dark]


@dataclass(frozen=True, slots=True)
class Look:
    """Characters and colours of every widget."""

    glyphs: Glyphs
    palette: Palette


# Colour depth and characters


_TRUECOLOR_TERMS: Final = ("alacritty", "foot", "xterm-ghostty", "xterm-kitty", "wezterm")
_COLOURLESS_TERMS: Final = ("dumb", "unknown", "vt100", "vt102", "vt220")
_TERM_OF: Final[Mapping[Depth, tuple[str, str]]] = {
    "none": ("xterm-16color", ""),
    "16": ("xterm-16color", ""),
    "256": ("xterm-256color", ""),
    "truecolor": ("xterm-256color", "truecolor"),
}


def choose_look(
    colors: Literal["auto"] | Depth,
    ascii: bool,  # noqa: A002
    dark: bool,
    environ: Mapping[str, str],
    encoding: str | None,
) -> Look:
    """Return the look for a terminal's environment and ``encoding``."""
    glyphs = ASCII if ascii or not can_encode(encoding) else UNICODE
    return Look(glyphs, palette_for(depth_of(colors, environ), dark))


def depth_of(colors: Literal["auto"] | Depth, environ: Mapping[str, str]) -> Depth:
    """Return the depth asked for, else the environment's. OpenSSH does not pass COLORTERM."""
    if colors != "auto":
        return colors
    term = environ.get("TERM", "").lower()
    if environ.get("NO_COLOR") or term in _COLOURLESS_TERMS:
        return "none"
    says_truecolor = environ.get("COLORTERM", "").lower() in ("truecolor", "24bit")
    is_truecolor = term.startswith(_TRUECOLOR_TERMS) or term.endswith("-direct")
    if says_truecolor or is_truecolor or "WT_SESSION" in environ:
        return "truecolor"
    return "256" if "256color" in term else "16"


def can_encode(encoding: str | None) -> bool:
    """Return whether all Unicode glyphs can be written."""
    try:
        "".join(str(getattr(UNICODE, each.name)) for each in fields(UNICODE)).encode(encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def is_native(depth: Depth) -> bool:
    """Return whether an app needs ``ansi_color=True``."""
    return depth in ("16", "none")


@contextmanager
def environment_for(depth: Depth) -> Iterator[None]:
    """Set the environment while an App is made."""
    term, colorterm = _TERM_OF[depth]
    wanted = {"TERM": term, "COLORTERM": colorterm, "NO_COLOR": "1" if depth == "none" else None}
    before = {name: os.environ.get(name) for name in wanted}
    _set_environment(wanted)
    try:
        yield
    finally:
        _set_environment(before)


def _set_environment(values: Mapping[str, str | None]) -> None:
    for name, value in values.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value
