"""Palettes in the 240 fixed colours of xterm: what a terminal behind ssh has.

The first 16 are left out, for every terminal draws them as it likes. On the way through RGB and back light
greys come to their neighbours, whose difference nobody sees.
"""

from __future__ import annotations

from rl_tui.screen.theme.roles import dark_and_light

DARK, LIGHT = dark_and_light(
    "256",
    inks=("color(16)", "color(231)"),
    values=(
        ("on color(18)", "on color(187)"),
        ("on color(24)", "on color(150)"),
        ("on color(30)", "on color(115)"),
        ("on color(72)", "on color(73)"),
        ("on color(114)", "on color(31)"),
        ("on color(186)", "on color(25)"),
        ("on color(227)", "on color(18)"),
    ),
    signed=(
        ("on color(215)", "on color(94)"),
        ("on color(172)", "on color(172)"),
        ("on color(130)", "on color(180)"),
        ("on color(237)", "on color(188)"),
        ("on color(30)", "on color(110)"),
        ("on color(73)", "on color(73)"),
        ("on color(151)", "on color(25)"),
    ),
    visits=(
        ("on color(236)", "on color(188)"),
        ("on color(239)", "on color(145)"),
        ("on color(145)", "on color(239)"),
        ("on color(188)", "on color(236)"),
    ),
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
    lane_1=("color(75)", "color(25)"),
    lane_2=("color(205)", "color(161)"),
    lane_3=("color(154)", "color(129)"),
    lane_4=("color(49)", "color(18)"),
    good=("color(79)", "color(23)"),
    bad=("color(209)", "color(124)"),
    slider_done=("color(75)", "color(25)"),
    slider_rest=("color(241)", "color(246)"),
    slider_thumb=("bold color(231)", "bold color(16)"),
    focus=("bold color(16) on color(212)", "bold color(231) on color(125)"),
    breakpoint=("bold color(231) on color(160)", "bold color(231) on color(160)"),
)
