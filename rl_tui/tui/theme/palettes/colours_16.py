"""Palettes in the 16 named colours, whose order of luminance holds in every terminal's version of them.

Ordinary text keeps the colours of the terminal, so that it is readable whatever its background is.
"""

from __future__ import annotations

from typing import Final

from rich.style import Style

from rl_tui.tui.theme.roles import Palette, styles

DARK: Final = Palette(
    name="16 dark",
    values=styles("bright_white on blue", "black on cyan", "black on white", "black on bright_white"),
    signed=styles("bright_white on red", "bright_red", "default", "bright_cyan", "bright_white on blue"),
    unvisited=Style.parse("dim"),
    text=Style.parse("default"),
    dim=Style.parse("dim"),
    strong=Style.parse("bold"),
    accent=Style.parse("bright_cyan"),
    agent=Style.parse("bold bright_white on red"),
    greedy=Style.parse("bold bright_yellow"),
    updated=Style.parse("bold bright_white on magenta"),
    source=Style.parse("bold underline black on bright_green"),
    hole=Style.parse("cyan"),
    cliff=Style.parse("bright_red"),
    goal=Style.parse("bold black on green"),
    wall=Style.parse("white on white"),
    start=Style.parse("bold underline"),
    optimum=Style.parse("default"),
    greedy_line=Style.parse("bright_yellow"),
    episodes=Style.parse("bright_cyan"),
    band=Style.parse("cyan"),
    lane_1=Style.parse("bright_cyan"),
    lane_2=Style.parse("bright_magenta"),
    lane_3=Style.parse("bright_green"),
    lane_4=Style.parse("bright_red"),
    good=Style.parse("bright_green"),
    bad=Style.parse("bright_red"),
    slider_done=Style.parse("bright_cyan"),
    slider_rest=Style.parse("dim"),
    slider_thumb=Style.parse("bold"),
    focus=Style.parse("bold black on bright_yellow"),
    breakpoint=Style.parse("bold black on bright_red"),
)

LIGHT: Final = Palette(
    name="16 light",
    values=styles("black on white", "black on cyan", "bright_white on blue", "bright_white on black"),
    signed=styles("bright_white on red", "red", "default", "blue", "bright_white on blue"),
    unvisited=Style.parse("dim"),
    text=Style.parse("default"),
    dim=Style.parse("dim"),
    strong=Style.parse("bold"),
    accent=Style.parse("blue"),
    agent=Style.parse("bold bright_white on red"),
    greedy=Style.parse("bold red"),
    updated=Style.parse("bold bright_white on magenta"),
    source=Style.parse("bold underline black on bright_green"),
    hole=Style.parse("blue"),
    cliff=Style.parse("red"),
    goal=Style.parse("bold black on green"),
    wall=Style.parse("black on black"),
    start=Style.parse("bold underline"),
    optimum=Style.parse("default"),
    greedy_line=Style.parse("red"),
    episodes=Style.parse("blue"),
    band=Style.parse("bright_blue"),
    lane_1=Style.parse("blue"),
    lane_2=Style.parse("magenta"),
    lane_3=Style.parse("default"),
    lane_4=Style.parse("bright_black"),
    good=Style.parse("bold blue"),
    bad=Style.parse("bold red"),
    slider_done=Style.parse("blue"),
    slider_rest=Style.parse("dim"),
    slider_thumb=Style.parse("bold"),
    focus=Style.parse("bold black on bright_yellow"),
    breakpoint=Style.parse("bold black on bright_red"),
)
