"""Palettes in the 16 named colours, whose order of luminance holds in every terminal's version of them.

Ordinary text keeps the colours of the terminal, so that it is readable whatever its background is.
"""

from __future__ import annotations

from rl_tui.screen.theme.roles import dark_and_light

DARK, LIGHT = dark_and_light(
    "16",
    inks=("black", "bright_white"),
    values=(
        ("bright_white on blue", "black on bright_yellow"),
        ("black on cyan", "black on bright_cyan"),
        ("black on bright_cyan", "black on cyan"),
        ("black on bright_yellow", "bright_white on blue"),
    ),
    signed=(
        ("bright_white on red", "bright_white on red"),
        ("bright_red", "red"),
        ("default", "default"),
        ("bright_cyan", "blue"),
        ("black on cyan", "black on cyan"),
    ),
    visits=(
        ("bright_white on black", "black on bright_white"),
        ("black on white", "black on white"),
        ("black on bright_white", "bright_white on black"),
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
    lane_1=("bright_cyan", "blue"),
    lane_2=("bright_magenta", "magenta"),
    lane_3=("bright_green", "default"),
    lane_4=("bright_red", "bright_black"),
    good=("bright_green", "bold blue"),
    bad=("bright_red", "bold red"),
    slider_done=("bright_blue", "blue"),
    slider_rest=("dim", "dim"),
    slider_thumb=("bold", "bold"),
    focus=("bold black on bright_magenta", "bold black on bright_magenta"),
    breakpoint=("bold black on bright_red", "bold black on bright_red"),
)
