"""The colours of borders, lists and boxes: a dark and a light theme for each colour depth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from rich.terminal_theme import TerminalTheme
from textual.theme import BUILTIN_THEMES, Theme

from rl_tui.tui.theme.palette import Depth

DARK: Final = Theme(
    name="dark",
    primary="#6cb6eb",
    secondary="#8fb8b0",
    accent="#f0b45f",
    foreground="#dde3e8",
    background="#0e1318",
    surface="#151c23",
    panel="#1f2932",
    success="#7fc8a9",
    warning="#e8c267",
    error="#f08a7a",
    dark=True,
    variables={
        "border": "#6cb6eb",
        "border-blurred": "#3d4a56",
        "scrollbar": "#4a5a68",
        "scrollbar-background": "#151c23",
    },
)

LIGHT: Final = Theme(
    name="light",
    primary="#00629b",
    secondary="#3d6b64",
    accent="#9a5b00",
    foreground="#1d242a",
    background="#fbfbf9",
    surface="#f2f2ee",
    panel="#e4e5e0",
    success="#1c7a52",
    warning="#8a6400",
    error="#b3261e",
    dark=False,
    variables={
        "border": "#00629b",
        "border-blurred": "#a8b0b6",
        "scrollbar": "#a8b0b6",
        "scrollbar-background": "#e9eae5",
    },
)

DARK_256: Final = Theme(
    name=DARK.name,
    primary="#5fafff",
    secondary="#87afaf",
    accent="#ffaf5f",
    foreground="#ffffff",
    background="#121212",
    surface="#1c1c1c",
    panel="#262626",
    success="#5fd7af",
    warning="#ffd75f",
    error="#ff875f",
    dark=True,
    variables={
        "border": "#5fafff",
        "border-blurred": "#585858",
        "scrollbar": "#626262",
        "scrollbar-background": "#1c1c1c",
    },
)

LIGHT_256: Final = Theme(
    name=LIGHT.name,
    primary="#005faf",
    secondary="#005f5f",
    accent="#875f00",
    foreground="#000000",
    background="#ffffff",
    surface="#eeeeee",
    panel="#dadada",
    success="#005f5f",
    warning="#875f00",
    error="#af0000",
    dark=False,
    variables={
        "border": "#005faf",
        "border-blurred": "#949494",
        "scrollbar": "#949494",
        "scrollbar-background": "#eeeeee",
    },
)

DARK_16: Final = Theme(
    name=DARK.name,
    ansi=True,
    primary="ansi_bright_cyan",
    secondary="ansi_cyan",
    accent="ansi_bright_yellow",
    foreground="ansi_default",
    background="ansi_default",
    surface="ansi_default",
    panel="ansi_default",
    boost="ansi_default",
    success="ansi_bright_green",
    warning="ansi_bright_yellow",
    error="ansi_bright_red",
    dark=True,
    variables=BUILTIN_THEMES["ansi-dark"].variables
    | {
        "border": "ansi_bright_cyan",
        "border-blurred": "ansi_white",
        "text-muted": "ansi_default",
        "block-cursor-foreground": "ansi_black",
        "block-cursor-background": "ansi_bright_yellow",
        "input-cursor-foreground": "ansi_black",
        "input-cursor-background": "ansi_white",
        "input-selection-foreground": "ansi_black",
        "input-selection-background": "ansi_cyan",
        "scrollbar": "ansi_white",
        "scrollbar-background": "ansi_default",
    },
)

LIGHT_16: Final = Theme(
    name=LIGHT.name,
    ansi=True,
    primary="ansi_blue",
    secondary="ansi_blue",
    accent="ansi_magenta",
    foreground="ansi_default",
    background="ansi_default",
    surface="ansi_default",
    panel="ansi_default",
    boost="ansi_default",
    success="ansi_blue",
    warning="ansi_magenta",
    error="ansi_red",
    dark=False,
    variables=BUILTIN_THEMES["ansi-light"].variables
    | {
        "border": "ansi_blue",
        "border-blurred": "ansi_bright_black",
        "text-muted": "ansi_default",
        "block-cursor-foreground": "ansi_black",
        "block-cursor-background": "ansi_bright_yellow",
        "input-cursor-foreground": "ansi_bright_white",
        "input-cursor-background": "ansi_black",
        "input-selection-foreground": "ansi_bright_white",
        "input-selection-background": "ansi_blue",
        "scrollbar": "ansi_bright_black",
        "scrollbar-background": "ansi_default",
    },
)

_NAMES: Final = ("black", "red", "green", "yellow", "blue", "magenta", "cyan", "white")
_NORMAL: Final = (
    (0, 0, 0),
    (205, 0, 0),
    (0, 205, 0),
    (205, 205, 0),
    (0, 0, 238),
    (205, 0, 205),
    (0, 205, 205),
    (229, 229, 229),
)
_BRIGHT: Final = (
    (127, 127, 127),
    (255, 0, 0),
    (0, 255, 0),
    (255, 255, 0),
    (92, 92, 255),
    (255, 0, 255),
    (0, 255, 255),
    (255, 255, 255),
)

# what xterm makes of the 16 colours
PICTURE_DARK: Final = TerminalTheme((0, 0, 0), (229, 229, 229), list(_NORMAL), list(_BRIGHT))
PICTURE_LIGHT: Final = TerminalTheme((255, 255, 255), (0, 0, 0), list(_NORMAL), list(_BRIGHT))


def themes_for(depth: Depth, *, picture: bool = False) -> tuple[Theme, Theme]:
    """Return the dark and the light theme of ``depth``; for a ``picture`` all of their colours are RGB."""
    if depth == "truecolor":
        return DARK, LIGHT
    if depth == "256":
        return DARK_256, LIGHT_256
    if picture:
        return _in_rgb(DARK_16, PICTURE_DARK), _in_rgb(LIGHT_16, PICTURE_LIGHT)
    return DARK_16, LIGHT_16


def _in_rgb(theme: Theme, terminal: TerminalTheme) -> Theme:
    colours, background = _rgb_of_names(terminal), terminal.background_color.hex

    def rgb(name: str | None) -> str:
        return colours[name or "ansi_default"]

    return replace(
        theme,
        ansi=False,
        primary=rgb(theme.primary),
        secondary=rgb(theme.secondary),
        accent=rgb(theme.accent),
        foreground=rgb(theme.foreground),
        success=rgb(theme.success),
        warning=rgb(theme.warning),
        error=rgb(theme.error),
        background=background,
        surface=background,
        panel=background,
        boost=background,
        variables={name: colours.get(value, value) for name, value in theme.variables.items()}
        | {"scrollbar-background": background},
    )


def _rgb_of_names(terminal: TerminalTheme) -> Mapping[str, str]:
    colours = {f"ansi_{name}": terminal.ansi_colors[index].hex for index, name in enumerate(_NAMES)}
    colours |= {
        f"ansi_bright_{name}": terminal.ansi_colors[index + 8].hex for index, name in enumerate(_NAMES)
    }
    return colours | {"ansi_default": terminal.foreground_color.hex}
