from __future__ import annotations

import os
from dataclasses import fields
from itertools import combinations, pairwise, product
from typing import Literal, get_args

import pytest
from colour_vision import contrast, distance, least_distance, luminance
from rich.color import Color, ColorSystem, ColorType
from rich.segment import Segment
from rich.style import Style
from rich.terminal_theme import TerminalTheme
from textual.app import App
from textual.strip import Strip

from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.screen.theme.look import (
    Depth,
    Palette,
    can_encode,
    choose_look,
    depth_of,
    environment_for,
    is_native,
    palette_for,
)
from rl_tui.screen.theme.roles import PALEST, paled, readable
from rl_tui.screen.theme.themes import PICTURE_DARK, PICTURE_LIGHT, themes_for

DEPTHS: tuple[Depth, ...] = get_args(Depth)
BOTH = (True, False)
VGA = TerminalTheme(
    (0, 0, 0),
    (170, 170, 170),
    [
        *((0, 0, 0), (170, 0, 0), (0, 170, 0), (170, 85, 0)),
        *((0, 0, 170), (170, 0, 170), (0, 170, 170), (170, 170, 170)),
    ],
    [
        *((85, 85, 85), (255, 85, 85), (85, 255, 85), (255, 255, 85)),
        *((85, 85, 255), (255, 85, 255), (85, 255, 255), (255, 255, 255)),
    ],
)
RGB_PALETTES = [palette_for(depth, dark) for depth in ("truecolor", "256") for dark in BOTH]
NAMES = [palette.name for palette in RGB_PALETTES]
LINES = (
    *("text", "dim", "strong", "press", "best", "you", "optimum", "greedy_line", "episodes", "good", "bad"),
    *("lane_1", "lane_2", "lane_3", "lane_4"),
)
GRAPHIC = ("hole", "cliff", "wall")  # signs as large as their cell, or hatching, not text


def roles(palette: Palette) -> dict[str, Style]:
    own = [each.name for each in fields(palette) if isinstance(getattr(palette, each.name), Style)]
    lanes = {f"lane_{number}": style for number, style in enumerate(palette.lanes, 1)}
    return {name: getattr(palette, name) for name in own} | lanes


def all_styles(palette: Palette) -> list[Style]:
    return [*palette.values, *palette.signed, *palette.visits, *roles(palette).values()]


def texts(palette: Palette) -> list[Style]:
    """All styles that may have text on their own background."""
    graphic = [roles(palette)[name] for name in GRAPHIC]
    return [style for style in all_styles(palette) if style.bgcolor is not None and style not in graphic]


def backgrounds(styles: tuple[Style, ...]) -> list[Color]:
    return [style.bgcolor for style in styles if style.bgcolor is not None]


def background_of_theme(palette: Palette) -> Color:
    depth: Depth = "256" if palette.name.startswith("256") else "truecolor"
    dark, light = themes_for(depth)
    background = (dark if palette.name.endswith("dark") else light).background
    assert background is not None
    return Color.parse(background)


def is_monotone(numbers: list[float]) -> bool:
    steps = [second - first for first, second in pairwise(numbers)]
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("dark", BOTH)
def test_no_style_is_empty_and_the_signed_ramp_has_a_middle(depth: Depth, dark: bool) -> None:
    palette = palette_for(depth, dark)
    assert all(all_styles(palette)), "a style without colour and attribute"
    assert len(palette.signed) % 2 == 1
    assert palette.updated != palette.focus


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_ramps_are_monotone_in_luminance(palette: Palette) -> None:
    values = backgrounds(palette.values)
    assert len(values) == len(palette.values)
    assert is_monotone([luminance(color) for color in values])
    visits = backgrounds(palette.visits)
    assert len(visits) == len(palette.visits)
    assert is_monotone([luminance(color) for color in visits])
    signed = [luminance(color) for color in backgrounds(palette.signed)]
    assert len(signed) == len(palette.signed)
    middle = len(signed) // 2
    assert is_monotone(signed[: middle + 1])
    assert is_monotone(signed[middle:])
    assert (signed[0] > signed[middle]) == (signed[-1] > signed[middle])


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_every_text_is_readable_on_its_background(palette: Palette) -> None:
    for style in texts(palette):
        assert style.color is not None
        assert style.bgcolor is not None
        assert contrast(style.color, style.bgcolor) >= 4.5, style
    for name in LINES:
        color = roles(palette)[name].color
        assert color is not None
        assert contrast(color, background_of_theme(palette)) >= 4.5, name


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_colour_blind_eyes_tell_apart_what_must_be_told_apart(palette: Palette) -> None:
    signed = backgrounds(palette.signed)
    for ramp in (backgrounds(palette.values), signed):
        assert min(least_distance(*neighbours) for neighbours in pairwise(ramp)) > 3
    for place in range(len(signed) // 2):
        assert least_distance(signed[place], signed[-1 - place]) > 20
    lines = [style.color for style in (palette.greedy_line, palette.episodes, palette.optimum) if style.color]
    assert len(lines) == 3
    assert min(least_distance(*couple) for couple in combinations(lines, 2)) > 30
    assert palette.good.color is not None
    assert palette.bad.color is not None
    assert least_distance(palette.good.color, palette.bad.color) > 20


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_negative_values_do_not_look_best(palette: Palette) -> None:
    assert palette.best.color is not None
    for ground in backgrounds(palette.signed)[: len(palette.signed) // 2]:
        assert distance(ground, palette.best.color, "all cones") > 35


def at(palette: Palette, name: str) -> tuple[Color, Color]:
    style = roles(palette)[name]
    assert style.color is not None
    assert style.bgcolor is not None
    return style.color, style.bgcolor


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_a_map_is_seen_before_anything_is_known(palette: Palette) -> None:
    page = background_of_theme(palette)
    floor = at(palette, "unvisited")[1]
    assert palette.page.color is not None
    assert palette.page.color.get_truecolor() == page.get_truecolor()
    assert contrast(floor, page) >= 1.3
    assert contrast(at(palette, "hole")[1], floor) >= 1.5
    assert contrast(at(palette, "wall")[1], floor) >= 1.4
    assert contrast(*at(palette, "hole")) >= 3.0
    assert contrast(*at(palette, "cliff")) >= 2.0
    assert contrast(*at(palette, "goal")) >= 4.5
    for name in ("hole", "wall", "cliff", "goal"):
        assert least_distance(at(palette, name)[1], floor) > 10, name


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_agent_and_goal_are_told_from_the_hottest_cell_and_the_coldest_from_the_page(
    palette: Palette,
) -> None:
    coldest, *_, hottest = backgrounds(palette.values)
    disc, plate = at(palette, "agent")
    # on a light page the hottest cell is dark: the disc is readable there
    assert max(contrast(disc, hottest), contrast(plate, hottest)) >= 3.0
    assert contrast(disc, plate) >= 15.0
    assert contrast(at(palette, "goal")[1], hottest) >= 3.0
    assert contrast(coldest, background_of_theme(palette)) >= 1.1
    assert least_distance(coldest, at(palette, "unvisited")[1]) > 5


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_an_ink_is_as_pale_as_was_asked_for_and_never_below_3(palette: Palette, share: float) -> None:
    for style in (*palette.values, *palette.signed, *palette.visits, palette.unvisited):
        pale = paled(style, share)
        assert style.color is not None
        assert style.bgcolor is not None
        assert pale.color is not None
        wanted = 3.0 + share * (contrast(style.color, style.bgcolor) - 3.0)
        assert contrast(pale.color, style.bgcolor) >= wanted - 0.01
        assert (pale == style) or share < 1.0


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_the_frame_of_an_update_and_a_slip_are_readable_on_every_ground(palette: Palette) -> None:
    cells = (*palette.values, *palette.signed, *palette.visits, palette.unvisited, palette.agent)
    for sign, cell in product((palette.good, palette.bad), cells):
        mixed = readable(sign, cell).color
        assert mixed is not None
        assert cell.bgcolor is not None
        assert contrast(mixed, cell.bgcolor) >= PALEST


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_colour_blind_eyes_tell_lanes_apart_from_each_other_and_from_the_other_lines(
    palette: Palette,
) -> None:
    lines = [style.color for style in (*palette.lanes, palette.greedy_line, palette.optimum) if style.color]
    assert len(lines) == 6
    assert min(least_distance(*couple) for couple in combinations(lines, 2)) > 20


@pytest.mark.parametrize("dark", BOTH)
def test_lanes_have_colours_of_their_own_wherever_there_are_any(dark: bool) -> None:
    told = {depth: palette_for(depth, dark).tells_lanes_apart for depth in DEPTHS}
    assert told == {"none": False, "16": False, "256": True, "truecolor": True}
    assert len(set(palette_for("16", dark).lanes)) == 4


@pytest.mark.parametrize("palette", RGB_PALETTES, ids=NAMES)
def test_unvisited_looks_like_no_value(palette: Palette) -> None:
    assert palette.unvisited not in (*palette.values, *palette.signed)
    assert palette.value(0.0).bgcolor is not None
    assert palette.signed_value(0.0).bgcolor is not None


def shade(number: int) -> int:
    """The lightness, 0 to 255, of a grey in xterm's ramp or cube."""
    return 8 + 10 * (number - 232) if number >= 232 else {145: 175, 188: 215}.get(number, -1)


@pytest.mark.parametrize("dark", BOTH)
def test_256_colours_come_back_from_rgb_as_they_were(dark: bool) -> None:
    for style in all_styles(palette_for("256", dark)):
        for color in (style.color, style.bgcolor):
            if color is not None:
                assert color.type is ColorType.EIGHT_BIT
                assert color.number is not None
                assert color.number >= 16
                again = Color.from_triplet(color.get_truecolor()).downgrade(ColorSystem.EIGHT_BIT)
                assert again.number is not None
                assert again.number == color.number or shade(again.number) - shade(color.number) == -7


@pytest.mark.parametrize("dark", BOTH)
def test_16_colours_are_names_and_monotone_in_every_terminal(dark: bool) -> None:
    palette = palette_for("16", dark)
    for style in all_styles(palette):
        for color in (style.color, style.bgcolor):
            assert color is None or color.type in (ColorType.STANDARD, ColorType.DEFAULT)
    for terminal in (VGA, PICTURE_DARK, PICTURE_LIGHT):
        ramp = [
            luminance(Color.from_triplet(color.get_truecolor(terminal)))
            for color in backgrounds(palette.values)
        ]
        assert len(ramp) == len(palette.values)
        assert is_monotone(ramp)


def test_without_colours_there_are_attributes_only() -> None:
    palette = palette_for("none", True)
    assert all(style.color is None and style.bgcolor is None for style in all_styles(palette))
    assert len(set(palette.values)) == len(palette.values)
    assert len({palette.updated, palette.focus, palette.agent, *palette.values}) >= len(palette.values) + 2


def test_fractions_are_clamped() -> None:
    palette = palette_for("truecolor", True)
    assert palette.value(-3.0) == palette.value(0.0) == palette.values[0] == palette.value(float("nan"))
    assert palette.value(7.0) == palette.value(1.0) == palette.values[-1]
    assert palette.value(0.5) == palette.values[5]
    assert palette.signed_value(-1.0) == palette.signed_value(float("-inf")) == palette.signed[0]
    assert palette.signed_value(0.0) == palette.signed_value(float("nan")) == palette.signed[5]
    assert palette.signed_value(2.0) == palette.signed[-1]


@pytest.mark.parametrize(
    ("environ", "depth"),
    [
        ({"TERM": "xterm-256color"}, "256"),
        ({"TERM": "screen-256color", "COLORTERM": ""}, "256"),
        ({"TERM": "xterm-256color", "COLORTERM": "truecolor"}, "truecolor"),
        ({"TERM": "xterm-kitty"}, "truecolor"),
        ({"TERM": "linux"}, "16"),
        ({"TERM": "xterm"}, "16"),
        ({}, "16"),
        ({"TERM": "vt100"}, "none"),
        ({"TERM": "xterm-256color", "COLORTERM": "truecolor", "NO_COLOR": "1"}, "none"),
        ({"TERM": "xterm-256color", "NO_COLOR": ""}, "256"),
    ],
)
def test_the_environment_says_how_many_colours(environ: dict[str, str], depth: Depth) -> None:
    assert depth_of("auto", environ) == depth


@pytest.mark.parametrize("depth", DEPTHS)
def test_what_is_asked_for_beats_the_environment(depth: Depth) -> None:
    assert depth_of(depth, {"TERM": "xterm-256color", "NO_COLOR": "1"}) == depth


@pytest.mark.parametrize(
    ("encoding", "is_enough"),
    [("utf-8", True), ("ascii", False), ("latin-1", False), (None, False), ("?", False)],
)
def test_characters_depend_on_the_encoding(encoding: str | None, is_enough: bool) -> None:
    assert can_encode(encoding) is is_enough
    look = choose_look("16", False, True, {}, encoding)
    assert look.glyphs is (UNICODE if is_enough else ASCII)
    assert look.palette is palette_for("16", True)
    assert choose_look("auto", True, False, {"TERM": "xterm-256color"}, "utf-8").glyphs is ASCII


@pytest.mark.parametrize(
    ("depth", "system"),
    [("none", "standard"), ("16", "standard"), ("256", "256"), ("truecolor", "truecolor")],
)
def test_an_app_made_for_a_depth_keeps_to_it(
    depth: Depth, system: Literal["standard", "256", "truecolor"], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "xterm-kitty")
    monkeypatch.setenv("NO_COLOR", "1")
    with environment_for(depth):
        app: App[None] = App(ansi_color=is_native(depth))
    assert app.console.color_system == system
    assert app.no_color is (depth == "none")
    assert (os.environ["TERM"], os.environ["NO_COLOR"]) == ("xterm-kitty", "1")


def test_256_colours_reach_the_terminal_by_their_numbers() -> None:
    with environment_for("256"):
        app: App[None] = App(ansi_color=False)
    strip = Strip([Segment("x", Style.parse("color(231) on color(24)"))])
    assert strip.render(app.console) == "\x1b[38;5;231;48;5;24mx\x1b[0m"


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("picture", BOTH)
async def test_the_themes_of_every_depth_can_be_used(depth: Depth, picture: bool) -> None:
    with environment_for(depth):
        app: App[None] = App(ansi_color=is_native(depth) and not picture)
    dark, light = themes_for(depth, picture=picture)
    assert (dark.name, dark.dark, light.name, light.dark) == ("dark", True, "light", False)
    for theme in (dark, light):
        app.register_theme(theme)
    async with app.run_test():
        for theme in (dark, light):
            app.theme = theme.name
            assert app.current_theme is theme


def test_every_kings_move_has_an_arrow() -> None:
    steps = [(rows, columns) for rows in (-1, 0, 1) for columns in (-1, 0, 1)]
    assert "".join(map(UNICODE.direction, steps)) == "↖↑↗←▫→↙↓↘"
    assert [ASCII.direction(step) for step in steps] == ["^<", "^", "^>", "<", ".", ">", "v<", "v", "v>"]


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("dark", BOTH)
def test_a_cliff_is_neither_hole_nor_wall(depth: Depth, dark: bool) -> None:
    palette = palette_for(depth, dark)
    assert len({palette.cliff, palette.hole, palette.wall}) == 3 or depth == "none"
    assert len({UNICODE.cliff, UNICODE.hole, UNICODE.wall}) == 3
