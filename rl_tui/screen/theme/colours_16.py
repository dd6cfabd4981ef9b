"""Palettes in the 16 named colours, whose order of luminance holds in every terminal's version of them.

Ordinary text keeps the colours of the terminal, so that it is readable whatever its background is.
"""

from __future__ import annotations

from rl_tui.screen.theme.roles import dark_and_light

DARK, LIGHT = dark_and_light(
    "16",
    values=(
        ("bright_white on blue", "black on white"),
        ("black on cyan", "black on cyan"),
        ("black on white", "bright_white on blue"),
        ("black on bright_white", "bright_white on black"),
    ),
    signed=(
        ("bright_white on red", "bright_white on red"),
        ("bright_red", "red"),
        ("default", "default"),
        ("bright_cyan", "blue"),
        ("bright_white on blue", "bright_white on blue"),
    ),
    unvisited=("dim", "dim"),
    text=("default", "default"),
    dim=("dim", "dim"),
    strong=("bold", "bold"),
    accent=("bright_cyan", "blue"),
    agent=("bold bright_white on red", "bold bright_white on red"),
    greedy=("bold bright_yellow", "bold red"),
    updated=("bold bright_white on magenta", "bold bright_white on magenta"),
    source=("bold underline black on bright_green", "bold underline black on bright_green"),
    hole=("cyan", "blue"),
    cliff=("bright_red", "red"),
    goal=("bold black on green", "bold black on green"),
    wall=("white on white", "black on black"),
    start=("bold underline", "bold underline"),
    optimum=("default", "default"),
    greedy_line=("bright_yellow", "red"),
    episodes=("bright_cyan", "blue"),
    band=("cyan", "bright_blue"),
    lane_1=("bright_cyan", "blue"),
    lane_2=("bright_magenta", "magenta"),
    lane_3=("bright_green", "default"),
    lane_4=("bright_red", "bright_black"),
    good=("bright_green", "bold blue"),
    bad=("bright_red", "bold red"),
    slider_done=("bright_cyan", "blue"),
    slider_rest=("dim", "dim"),
    slider_thumb=("bold", "bold"),
    focus=("bold black on bright_yellow", "bold black on bright_yellow"),
    breakpoint=("bold black on bright_red", "bold black on bright_red"),
)
