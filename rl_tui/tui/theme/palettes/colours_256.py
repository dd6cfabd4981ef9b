"""Palettes in the 240 fixed colours of xterm: what a terminal behind ssh has.

The first 16 are left out, for every terminal draws them as it likes; so are the greys from 247 on, because
the way through RGB and back does not lead to the same one.
"""

from __future__ import annotations

from typing import Final

from rich.style import Style

from rl_tui.tui.theme.roles import Palette, styles

DARK: Final = Palette(
    name="256 dark",
    values=styles(
        "color(231) on color(17)",
        "color(231) on color(24)",
        "color(16) on color(30)",
        "color(16) on color(72)",
        "color(16) on color(114)",
        "color(16) on color(186)",
        "color(16) on color(227)",
    ),
    signed=styles(
        "color(16) on color(215)",
        "color(16) on color(172)",
        "color(231) on color(94)",
        "color(231) on color(236)",
        "color(231) on color(25)",
        "color(16) on color(74)",
        "color(16) on color(117)",
    ),
    unvisited=Style.parse("color(244)"),
    text=Style.parse("color(231)"),
    dim=Style.parse("color(246)"),
    strong=Style.parse("bold color(231)"),
    accent=Style.parse("color(75)"),
    agent=Style.parse("bold color(16) on color(231)"),
    greedy=Style.parse("bold color(222)"),
    updated=Style.parse("bold color(16) on color(231)"),
    source=Style.parse("bold underline color(16) on color(141)"),
    hole=Style.parse("color(103) on color(16)"),
    cliff=Style.parse("color(216) on color(52)"),
    goal=Style.parse("bold color(16) on color(214)"),
    wall=Style.parse("color(240) on color(240)"),
    start=Style.parse("bold underline"),
    optimum=Style.parse("color(231)"),
    greedy_line=Style.parse("color(215)"),
    episodes=Style.parse("color(75)"),
    band=Style.parse("color(24)"),
    lane_1=Style.parse("color(75)"),
    lane_2=Style.parse("color(205)"),
    lane_3=Style.parse("color(154)"),
    lane_4=Style.parse("color(49)"),
    good=Style.parse("color(79)"),
    bad=Style.parse("color(209)"),
    slider_done=Style.parse("color(75)"),
    slider_rest=Style.parse("color(241)"),
    slider_thumb=Style.parse("bold color(231)"),
    focus=Style.parse("bold color(16) on color(212)"),
    breakpoint=Style.parse("bold color(231) on color(160)"),
)

LIGHT: Final = Palette(
    name="256 light",
    values=styles(
        "color(16) on color(230)",
        "color(16) on color(193)",
        "color(16) on color(151)",
        "color(16) on color(73)",
        "color(16) on color(31)",
        "color(231) on color(25)",
        "color(231) on color(18)",
    ),
    signed=styles(
        "color(231) on color(94)",
        "color(16) on color(172)",
        "color(16) on color(223)",
        "color(16) on color(231)",
        "color(16) on color(153)",
        "color(16) on color(74)",
        "color(231) on color(25)",
    ),
    unvisited=Style.parse("color(242)"),
    text=Style.parse("color(16)"),
    dim=Style.parse("color(241)"),
    strong=Style.parse("bold color(16)"),
    accent=Style.parse("color(25)"),
    agent=Style.parse("bold color(231) on color(16)"),
    greedy=Style.parse("bold color(88)"),
    updated=Style.parse("bold color(231) on color(16)"),
    source=Style.parse("bold underline color(231) on color(92)"),
    hole=Style.parse("color(24) on color(189)"),
    cliff=Style.parse("color(88) on color(224)"),
    goal=Style.parse("bold color(16) on color(214)"),
    wall=Style.parse("color(246) on color(246)"),
    start=Style.parse("bold underline"),
    optimum=Style.parse("color(16)"),
    greedy_line=Style.parse("color(130)"),
    episodes=Style.parse("color(25)"),
    band=Style.parse("color(153)"),
    lane_1=Style.parse("color(25)"),
    lane_2=Style.parse("color(161)"),
    lane_3=Style.parse("color(129)"),
    lane_4=Style.parse("color(18)"),
    good=Style.parse("color(23)"),
    bad=Style.parse("color(124)"),
    slider_done=Style.parse("color(25)"),
    slider_rest=Style.parse("color(246)"),
    slider_thumb=Style.parse("bold color(16)"),
    focus=Style.parse("bold color(231) on color(125)"),
    breakpoint=Style.parse("bold color(231) on color(160)"),
)
