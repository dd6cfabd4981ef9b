"""Colours are readable and equally strong."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from colour_vision import EYES, contrast, distance, least_distance, lightness
from rich.color import Color
from rich.style import Style
from rich.terminal_theme import TerminalTheme
from test_palette import LINES, NAMES, RGB_PALETTES, VGA, backgrounds, roles, texts

from rl_tui.screen.theme.look import Depth, Palette, palette_for
from rl_tui.screen.theme.themes import PICTURE_DARK, PICTURE_LIGHT, themes_for

READABLE = 4.5  # WCAG 2.2, 1.4.3: text against its background
VISIBLE = 3.0  # 1.4.11: lines and marks against adjacent colours
PAPER = TerminalTheme((255, 255, 255), (0, 0, 0), [tuple(VGA.ansi_colors[number]) for number in range(16)])
SIXTEEN = [(True, VGA), (True, PICTURE_DARK), (False, PAPER), (False, PICTURE_LIGHT)]


def as_shown(color: Color | None, terminal: TerminalTheme, *, foreground: bool) -> Color:
    color = color or Color.default()
    return Color.from_triplet(color.get_truecolor(terminal, foreground=foreground))


def contrast_in(style: Style, terminal: TerminalTheme) -> float:
    return contrast(
        as_shown(style.color, terminal, foreground=True), as_shown(style.bgcolor, terminal, foreground=False)
    )


@pytest.mark.parametrize("eye", EYES)
def test_eyes_that_lack_a_cone_see_greys_as_they_are(eye: str) -> None:
    np.testing.assert_allclose(EYES[eye].sum(axis=1), 1.0, atol=2e-6)


def test_the_simulated_eyes_confuse_what_such_eyes_confuse() -> None:
    red, green = Color.parse("#c00000"), Color.parse("#607000")
    blue, teal = Color.parse("#0050c0"), Color.parse("#00707a")
    assert distance(red, green, "no medium cones") < distance(red, green, "all cones") / 2
    assert distance(red, green, "no long cones") < distance(red, green, "all cones")
    assert distance(blue, teal, "no short cones") < distance(blue, teal, "all cones") / 2


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_minus_is_as_strong_as_plus(palette: Palette) -> None:
    light = [lightness(color) for color in backgrounds(palette.signed)]
    apart = [abs(one - other) for one, other in zip(light, reversed(light), strict=True)]
    assert max(apart) <= 5.0


@pytest.mark.parametrize(("dark", "terminal"), SIXTEEN)
def test_16_colours_are_readable_and_their_signs_differ_for_every_eye(
    dark: bool, terminal: TerminalTheme
) -> None:
    palette = palette_for("16", dark)
    for style in texts(palette):
        assert contrast_in(style, terminal) >= READABLE, style
    for name in (*LINES, "cliff", "hole"):
        assert contrast_in(roles(palette)[name], terminal) >= VISIBLE, name
    low, high = palette.signed[0], palette.signed[-1]
    assert low.bgcolor is not None
    assert high.bgcolor is not None
    ends = [as_shown(style.bgcolor, terminal, foreground=False) for style in (low, high)]
    assert least_distance(*ends) > 20
    slight = [as_shown(style.bgcolor, terminal, foreground=False) for style in palette.signed[1:4:2]]
    assert least_distance(*slight) > 20


@pytest.mark.parametrize(("dark", "terminal"), SIXTEEN)
def test_16_colours_tell_few_visits_from_many_and_slight_errors_from_large_ones(
    dark: bool, terminal: TerminalTheme
) -> None:
    palette = palette_for("16", dark)
    for ramp in (palette.visits, palette.signed[2:], palette.signed[2::-1]):
        grounds = [as_shown(style.bgcolor, terminal, foreground=False) for style in ramp]
        assert all(least_distance(*each) > 10 for each in combinations(grounds, 2)), ramp


@pytest.mark.parametrize("depth", ["256", "truecolor"])
@pytest.mark.parametrize("at", [0, 1], ids=["dark", "light"])
def test_the_border_of_what_is_in_focus_stands_out(depth: Depth, at: int) -> None:
    theme = themes_for(depth)[at]
    border, blurred = (Color.parse(theme.variables[name]) for name in ("border", "border-blurred"))
    assert theme.background is not None
    assert contrast(border, Color.parse(theme.background)) >= VISIBLE
    assert least_distance(border, blurred) > 20
