"""The palette without colours. Reversed is kept for what must catch the eye: cursor, agent, latest update."""

from __future__ import annotations

from typing import Final

from rich.style import Style

from rl_tui.screen.theme.roles import Palette, styles

ANY: Final = Palette(
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
    cliff=Style.parse("dim underline"),
    goal=Style.parse("bold"),
    wall=Style.parse("dim"),
    start=Style.parse("underline"),
    optimum=Style.parse("not bold"),
    greedy_line=Style.parse("bold"),
    episodes=Style.parse("not bold"),
    lane_1=Style.parse("not bold"),
    lane_2=Style.parse("not bold"),
    lane_3=Style.parse("not bold"),
    lane_4=Style.parse("not bold"),
    good=Style.parse("bold"),
    bad=Style.parse("bold underline"),
    slider_done=Style.parse("bold"),
    slider_rest=Style.parse("dim"),
    slider_thumb=Style.parse("bold"),
    focus=Style.parse("underline reverse"),
    breakpoint=Style.parse("bold underline reverse"),
)
