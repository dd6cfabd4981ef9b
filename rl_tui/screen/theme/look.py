"""Palettes, and the look of a screen, chosen once from the terminal and the theme.

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

from rich.style import Style

from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs
from rl_tui.screen.theme.roles import Palette, dark_and_light, styles

# Palettes in 24-bit colours: navy to yellow for values; red, grey and teal for signed ones, as for errors
DARK, LIGHT = dark_and_light(
    "truecolor",
    inks=("#05080b", "#ffffff"),
    values=(
        "#1b3350, #1c3f5c, #1b4c69, #1c5a75, #1f687f, #287687, #3f8d8c, #5ea189, #86b582, #b2c67d, #dfd884",
        "#e3e6a8, #d6e6b0, #c5e3bd, #a6d7bd, #83c9be, #62b8c1, #48a3c0, #3587b4, #2a69a2, #234d8c, #1a3470",
    ),
    signed=(
        "#ff978f, #da6e68, #af5450, #87433f, #673c38, #3a4048, #185064, #176476, #24808c, #38a1a8, #58cdcc",
        "#a51a31, #c7444a, #de756e, #ee9f95, #f4c0b7, #e3e4e2, #9fd4ed, #6cbade, #419dc8, #0079b0, #00538c",
    ),
    visits=(
        "#2a323a, #3d464f, #57616b, #848e98, #a3adb6, #d3dae0",
        "#dcdfe1, #c5cacd, #a5acb1, #8a9299, #555f67, #2c353c",
    ),
    unvisited=("#93a1ae on #2a323a", "#596168 on #d7dbdd"),
    page=("#0e1318", "#fbfbf9"),
    rule=("#3a4651", "#c3c8cb"),
    text=("#dde3e8", "#1d242a"),
    dim=("#8d9aa7", "#5d666e"),
    strong=("bold #f4f8fa", "bold #05080b"),
    press=("#6cb6eb", "#00629b"),
    agent=("bold #ffffff on #05080b", "bold #ffffff on #14181c"),
    best=("bold #ffc266", "bold #8a4a00"),
    you=("#ff86d6", "#a8106e"),
    updated=("bold #f4f8fa on #3a4651", "bold #05080b on #c3c8cb"),
    source=("bold underline #05080b on #c08cff", "bold underline #ffffff on #7a2fb8"),
    hole=("#56687a on #04060a", "#48525a on #9ca6ad"),
    cliff=("#a56f61 on #3d130d", "#b2665a on #f0c8bf"),
    goal=("bold #ffd166 on #2b2108", "bold #7a5200 on #fff0c2"),
    wall=("#6d7a86 on #4d5964", "#8a939a on #a9b1b7"),
    start=("underline", "underline"),
    optimum=("#dde3e8", "#1d242a"),
    greedy_line=("#ffc266", "#8a4a00"),
    episodes=("#6cb6eb", "#00629b"),
    lanes=("#6cb6eb, #f838a8, #8cf000, #c83cf0", "#0069b0, #c80870, #a014f0, #640064"),
    good=("#6fd6cc", "#0b6e57"),
    bad=("#ff8c69", "#b3261e"),
    slider_rest=("#56636f", "#a0a8ae"),
    focus=("bold #1a0014 on #ff86d6", "bold #ffffff on #a8106e"),
    breakpoint=("bold #ffffff on #c2183a", "bold #ffffff on #c2183a"),
)

# Palettes in the 240 fixed colours of xterm, for terminals behind ssh. The first 16 are left out, because
# every terminal draws them differently. The conversion to RGB and back moves light greys to their neighbours,
# an invisible difference.
DARK_256, LIGHT_256 = dark_and_light(
    "256",
    inks=("color(16)", "color(231)"),
    values=("18, 24, 30, 72, 114, 186, 227", "187, 150, 115, 73, 31, 25, 18"),
    signed=("210, 167, 95, 237, 25, 67, 74", "124, 167, 181, 188, 110, 67, 25"),
    visits=("236, 239, 145, 188", "188, 145, 239, 236"),
    unvisited=("color(145) on color(236)", "color(240) on color(188)"),
    page=("color(233)", "color(231)"),
    rule=("color(238)", "color(145)"),
    text=("color(231)", "color(16)"),
    dim=("color(246)", "color(241)"),
    strong=("bold color(231)", "bold color(16)"),
    press=("color(75)", "color(25)"),
    agent=("bold color(231) on color(16)", "bold color(231) on color(16)"),
    best=("bold color(215)", "bold color(94)"),
    you=("color(212)", "color(125)"),
    updated=("bold color(231) on color(239)", "bold color(16) on color(188)"),
    source=("bold underline color(16) on color(141)", "bold underline color(231) on color(92)"),
    hole=("color(242) on color(16)", "color(238) on color(246)"),
    cliff=("color(173) on color(88)", "color(88) on color(217)"),
    goal=("bold color(221) on color(58)", "bold color(94) on color(230)"),
    wall=("color(243) on color(240)", "color(243) on color(145)"),
    start=("underline", "underline"),
    optimum=("color(231)", "color(16)"),
    greedy_line=("color(215)", "color(94)"),
    episodes=("color(75)", "color(25)"),
    lanes=("color(75), color(205), color(154), color(49)", "color(25), color(125), color(129), color(18)"),
    good=("color(79)", "color(23)"),
    bad=("color(209)", "color(124)"),
    slider_rest=("color(241)", "color(246)"),
    focus=("bold color(16) on color(212)", "bold color(231) on color(125)"),
    breakpoint=("bold color(231) on color(160)", "bold color(231) on color(160)"),
)

# Palettes in the 16 named colours, in an order of luminance that holds in every terminal. Ordinary text keeps
# the colours of the terminal, so that it is readable on any background. The middle of visits is green: no ink
# is readable on every dark grey, and the light grey is nearly white.
DARK_16, LIGHT_16 = dark_and_light(
    "16",
    inks=("black", "bright_white"),
    values=(
        "bright_white on blue, black on cyan, black on bright_cyan, black on bright_yellow",
        "black on bright_yellow, black on bright_cyan, black on cyan, bright_white on blue",
    ),
    signed=(
        "black on bright_red, bright_white on red, default, black on cyan, black on bright_cyan",
        "bright_white on red, black on bright_red, default, black on cyan, bright_white on blue",
    ),
    visits=(
        "bright_white on black, black on green, black on bright_white",
        "black on bright_white, black on green, bright_white on black",
    ),
    unvisited=("dim", "dim"),
    page=("black", "bright_white"),
    rule=("bright_black", "white"),
    text=("default", "default"),
    dim=("dim", "dim"),
    strong=("bold", "bold"),
    press=("bright_blue", "blue"),
    agent=("bold bright_white on black", "bold bright_white on black"),
    best=("bold yellow", "bold red"),
    you=("bright_magenta", "magenta"),
    updated=("bold black on bright_white", "bold bright_white on black"),
    source=("bold underline bright_white on magenta", "bold underline bright_white on magenta"),
    hole=("white", "bright_black"),
    cliff=("bright_red", "red"),
    goal=("bold bright_yellow on black", "bold bright_yellow on black"),
    wall=("white on bright_black", "bright_black on white"),
    start=("underline", "underline"),
    optimum=("default", "default"),
    greedy_line=("yellow", "red"),
    episodes=("bright_blue", "blue"),
    lanes=("bright_cyan, bright_magenta, bright_green, bright_red", "blue, magenta, default, bright_black"),
    good=("bright_green", "bold blue"),
    bad=("bright_red", "bold red"),
    slider_rest=("dim", "dim"),
    focus=("bold black on bright_magenta", "bold black on bright_magenta"),
    breakpoint=("bold black on bright_red", "bold black on bright_red"),
)

# The palette without colours. Reverse is reserved for cursor, agent and latest update.
NO_COLOURS: Final = Palette(
    name="none",
    values=styles("not bold", "bold"),
    signed=styles("bold underline", "underline", "not bold", "bold", "bold italic"),
    visits=styles("not bold", "bold"),
    unvisited=Style.parse("dim"),
    page=Style.parse("dim"),
    rule=Style.parse("dim"),
    text=Style.parse("not bold"),
    dim=Style.parse("dim"),
    strong=Style.parse("bold"),
    press=Style.parse("bold"),
    agent=Style.parse("bold reverse"),
    best=Style.parse("bold"),
    you=Style.parse("bold"),
    updated=Style.parse("bold reverse"),
    source=Style.parse("italic reverse"),
    hole=Style.parse("dim"),
    cliff=Style.parse("dim"),
    goal=Style.parse("bold"),
    wall=Style.parse("dim"),
    start=Style.parse("underline"),
    optimum=Style.parse("not bold"),
    greedy_line=Style.parse("bold"),
    episodes=Style.parse("not bold"),
    lanes=styles(*["not bold"] * 4),
    good=Style.parse("bold"),
    bad=Style.parse("bold underline"),
    slider_rest=Style.parse("dim"),
    focus=Style.parse("underline reverse"),
    breakpoint=Style.parse("bold underline reverse"),
)


# Palettes for each colour depth


__all__ = ["Depth", "Palette", "palette_for"]

Depth = Literal["none", "16", "256", "truecolor"]

_PALETTES: Final[Mapping[Depth, tuple[Palette, Palette]]] = {  # light, dark
    "none": (NO_COLOURS, NO_COLOURS),
    "16": (LIGHT_16, DARK_16),
    "256": (LIGHT_256, DARK_256),
    "truecolor": (LIGHT, DARK),
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
