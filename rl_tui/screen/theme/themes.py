"""Themes and scroll bars."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Final

from rich.color import Color
from rich.terminal_theme import TerminalTheme
from textual.scrollbar import ScrollBar, ScrollBarRender
from textual.theme import BUILTIN_THEMES, Theme

from rl_tui.screen.theme.look import Depth


def _dark_and_light(
    *, variables: Mapping[str, tuple[str, str]], ansi: bool = False, **colours: tuple[str, str]
) -> tuple[Theme, Theme]:
    def theme(name: str, column: int) -> Theme:
        chosen: dict[str, Any] = {role: row[column] for role, row in colours.items()}
        own = {variable: row[column] for variable, row in variables.items()}
        usual = BUILTIN_THEMES[f"ansi-{name}"].variables if ansi else {}
        own_and_usual = usual | {"border": chosen["primary"]} | own
        return Theme(name=name, dark=name == "dark", ansi=ansi, variables=own_and_usual, **chosen)

    return theme("dark", 0), theme("light", 1)


DARK, LIGHT = _dark_and_light(
    primary=("#6cb6eb", "#00629b"),
    secondary=("#8fb8b0", "#3d6b64"),
    accent=("#ff86d6", "#a8106e"),
    foreground=("#dde3e8", "#1d242a"),
    background=("#0e1318", "#fbfbf9"),
    surface=("#151c23", "#f2f2ee"),
    panel=("#1f2932", "#e4e5e0"),
    success=("#7fc8a9", "#1c7a52"),
    warning=("#e8c267", "#8a6400"),
    error=("#f08a7a", "#b3261e"),
    variables={
        "border-blurred": ("#3d4a56", "#a8b0b6"),
        "scrollbar": ("#4a5a68", "#a8b0b6"),
        "scrollbar-background": ("#151c23", "#e9eae5"),
    },
)

DARK_256, LIGHT_256 = _dark_and_light(
    primary=("#5fafff", "#005faf"),
    secondary=("#87afaf", "#005f5f"),
    accent=("#ff87d7", "#af005f"),
    foreground=("#ffffff", "#000000"),
    background=("#121212", "#ffffff"),
    surface=("#1c1c1c", "#eeeeee"),
    panel=("#262626", "#dadada"),
    success=("#5fd7af", "#005f5f"),
    warning=("#ffd75f", "#875f00"),
    error=("#ff875f", "#af0000"),
    variables={
        "border-blurred": ("#585858", "#949494"),
        "scrollbar": ("#626262", "#949494"),
        "scrollbar-background": ("#1c1c1c", "#eeeeee"),
    },
)

DARK_16, LIGHT_16 = _dark_and_light(
    ansi=True,
    primary=("ansi_bright_blue", "ansi_blue"),
    secondary=("ansi_cyan", "ansi_blue"),
    accent=("ansi_bright_magenta", "ansi_magenta"),
    foreground=("ansi_default", "ansi_default"),
    background=("ansi_default", "ansi_default"),
    surface=("ansi_default", "ansi_default"),
    panel=("ansi_default", "ansi_default"),
    boost=("ansi_default", "ansi_default"),
    success=("ansi_bright_green", "ansi_blue"),
    warning=("ansi_bright_yellow", "ansi_magenta"),
    error=("ansi_bright_red", "ansi_red"),
    variables={
        "border-blurred": ("ansi_white", "ansi_bright_black"),
        "text-muted": ("ansi_default", "ansi_default"),
        "block-cursor-foreground": ("ansi_black", "ansi_bright_white"),
        "block-cursor-background": ("ansi_bright_blue", "ansi_blue"),
        "input-cursor-foreground": ("ansi_black", "ansi_bright_white"),
        "input-cursor-background": ("ansi_white", "ansi_black"),
        "input-selection-foreground": ("ansi_black", "ansi_bright_white"),
        "input-selection-background": ("ansi_cyan", "ansi_blue"),
        "scrollbar": ("ansi_white", "ansi_bright_black"),
        "scrollbar-background": ("ansi_default", "ansi_default"),
    },
)

_NAMES: Final = ("black", "red", "green", "yellow", "blue", "magenta", "cyan", "white")
# the 16 colours of xterm
_NORMAL, _BRIGHT = (
    [Color.parse(f"#{rgb}").get_truecolor() for rgb in row.split()]
    for row in (
        "000000 cd0000 00cd00 cdcd00 0000ee cd00cd 00cdcd e5e5e5",
        "7f7f7f ff0000 00ff00 ffff00 5c5cff ff00ff 00ffff ffffff",
    )
)
PICTURE_DARK: Final = TerminalTheme((0, 0, 0), (229, 229, 229), [*_NORMAL], [*_BRIGHT])
PICTURE_LIGHT: Final = TerminalTheme((255, 255, 255), (0, 0, 0), [*_NORMAL], [*_BRIGHT])


def themes_for(depth: Depth, *, picture: bool = False) -> tuple[Theme, Theme]:
    """Return the dark and light theme, in RGB for a ``picture``."""
    known = {"truecolor": (DARK, LIGHT), "256": (DARK_256, LIGHT_256)}
    if picture and depth not in known:
        return _in_rgb(DARK_16, PICTURE_DARK), _in_rgb(LIGHT_16, PICTURE_LIGHT)
    return known.get(depth, (DARK_16, LIGHT_16))


def _in_rgb(theme: Theme, terminal: TerminalTheme) -> Theme:
    names = [*(f"ansi_{name}" for name in _NAMES), *(f"ansi_bright_{name}" for name in _NAMES)]
    colours = {name: terminal.ansi_colors[number].hex for number, name in enumerate(names)}
    colours["ansi_default"] = terminal.foreground_color.hex
    background = terminal.background_color.hex
    drawn = ("primary", "secondary", "accent", "foreground", "success", "warning", "error")
    replaced: dict[str, Any] = {role: colours[getattr(theme, role)] for role in drawn}
    replaced |= dict.fromkeys(("background", "surface", "panel", "boost"), background)
    variables = {name: colours.get(value, value) for name, value in theme.variables.items()}
    variables["scrollbar-background"] = background
    return replace(theme, ansi=False, variables=variables, **replaced)


class PlainScrollBar(ScrollBarRender):
    """A scroll bar of whole cells: a part of one looks like a stray line."""

    VERTICAL_BARS: ClassVar[list[str]] = [" "] * len(ScrollBarRender.VERTICAL_BARS)
    HORIZONTAL_BARS: ClassVar[list[str]] = [" "] * len(ScrollBarRender.HORIZONTAL_BARS)


def use_plain_scroll_bars() -> None:
    """Draw all scroll bars in whole cells."""
    ScrollBar.renderer = PlainScrollBar
