"""The look of a screen: its characters and colours, chosen once from the terminal and the theme.

Textual passes rich styles through its line filters to ``Console(color_system=…)``, which rounds RGB to
what the terminal has. Two facts matter:

* Without ``ansi_color=True``, a filter turns every named, numbered and default colour into RGB (see
  ``App.ansi_theme_dark`` and ``_light``), and ``dim`` into a mixed colour. With 256 colours this is
  harmless: all colours of our palettes come back to the same number. With 16 it is not: the nearest
  colour is guessed, and the terminal's own background is painted over. So "16" and "none" need
  ``ansi_color=True``.
* Textual reads NO_COLOR when an App is made, whatever its value. With ``ansi_color`` it removes all
  colours and keeps bold, dim, underline and reverse; without, it only turns colours grey.
  ``TEXTUAL_COLOR_SYSTEM`` overrides detection and is read when textual is imported (``none`` crashes),
  so the command line removes it before that.

An app on a terminal therefore does::

    depth = depth_of(colors, os.environ)
    with environment_for(depth):
        super().__init__(ansi_color=is_native(depth))
    for theme in themes_for(depth):
        self.register_theme(theme)

It takes its palette from ``palette_for(depth, self.current_theme.dark)``, again when the theme changes.

Rich exports SVG in truecolor whatever the console says, and draws default colours on a dark background
of its own. So pictures need RGB from the start: ``ansi_color=False``, ``themes_for(depth,
picture=True)``, and ``self.ansi_theme_dark, self.ansi_theme_light = PICTURE_DARK, PICTURE_LIGHT``. No
terminal is asked there, so ``auto`` is truecolor.
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

_PALETTES: Final[Mapping[tuple[Depth, bool], Palette]] = {
    ("none", True): palettes.NO_COLOURS,
    ("none", False): palettes.NO_COLOURS,
    ("16", True): palettes.DARK_16,
    ("16", False): palettes.LIGHT_16,
    ("256", True): palettes.DARK_256,
    ("256", False): palettes.LIGHT_256,
    ("truecolor", True): palettes.DARK,
    ("truecolor", False): palettes.LIGHT,
}


def palette_for(depth: Depth, dark: bool) -> Palette:
    """Return the palette for a terminal of ``depth`` with a ``dark`` or a light background."""
    return _PALETTES[depth, dark]


@dataclass(frozen=True, slots=True)
class Look:
    """What every drawing widget is given."""

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
    """Return characters and colours for a terminal of this environment and ``encoding`` of its output."""
    glyphs = ASCII if ascii or not can_encode(encoding) else UNICODE
    return Look(glyphs, palette_for(depth_of(colors, environ), dark))


def depth_of(colors: Literal["auto"] | Depth, environ: Mapping[str, str]) -> Depth:
    """Return the colour depth asked for, else that of the environment; OpenSSH does not pass COLORTERM on."""
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
    """Return whether every character of the Unicode set can be written in ``encoding`` (None: not known)."""
    try:
        "".join(str(getattr(UNICODE, each.name)) for each in fields(UNICODE)).encode(encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def is_native(depth: Depth) -> bool:
    """Return whether an app on a terminal of ``depth`` needs ``ansi_color=True``."""
    return depth in ("16", "none")


@contextmanager
def environment_for(depth: Depth) -> Iterator[None]:
    """Let the environment say ``depth``, for as long as it takes to make an App."""
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
