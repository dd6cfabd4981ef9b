"""Palettes in the 240 fixed colours of xterm: what a terminal behind ssh has.

The first 16 are left out, for every terminal draws them as it likes; so are the greys from 247 on, because
the way through RGB and back does not lead to the same one.
"""

from __future__ import annotations

from rl_tui.screen.theme.roles import dark_and_light

DARK, LIGHT = dark_and_light(
    "256",
    values=(
        ("color(231) on color(17)", "color(16) on color(230)"),
        ("color(231) on color(24)", "color(16) on color(193)"),
        ("color(16) on color(30)", "color(16) on color(151)"),
        ("color(16) on color(72)", "color(16) on color(73)"),
        ("color(16) on color(114)", "color(16) on color(31)"),
        ("color(16) on color(186)", "color(231) on color(25)"),
        ("color(16) on color(227)", "color(231) on color(18)"),
    ),
    signed=(
        ("color(16) on color(215)", "color(231) on color(94)"),
        ("color(16) on color(172)", "color(16) on color(172)"),
        ("color(231) on color(94)", "color(16) on color(223)"),
        ("color(231) on color(236)", "color(16) on color(231)"),
        ("color(231) on color(25)", "color(16) on color(153)"),
        ("color(16) on color(74)", "color(16) on color(74)"),
        ("color(16) on color(117)", "color(231) on color(25)"),
    ),
    unvisited=("color(244)", "color(242)"),
    text=("color(231)", "color(16)"),
    dim=("color(246)", "color(241)"),
    strong=("bold color(231)", "bold color(16)"),
    accent=("color(75)", "color(25)"),
    agent=("bold color(16) on color(231)", "bold color(231) on color(16)"),
    greedy=("bold color(222)", "bold color(88)"),
    updated=("bold color(16) on color(231)", "bold color(231) on color(16)"),
    source=("bold underline color(16) on color(141)", "bold underline color(231) on color(92)"),
    hole=("color(103) on color(16)", "color(24) on color(189)"),
    cliff=("color(216) on color(52)", "color(88) on color(224)"),
    goal=("bold color(16) on color(214)", "bold color(16) on color(214)"),
    wall=("color(240) on color(240)", "color(246) on color(246)"),
    start=("bold underline", "bold underline"),
    optimum=("color(231)", "color(16)"),
    greedy_line=("color(215)", "color(130)"),
    episodes=("color(75)", "color(25)"),
    band=("color(238)", "color(153)"),
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
