from __future__ import annotations

import re
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from colour_vision import contrast
from drawn_grids import large_lake, one_way, paying, picture, q_of, small, style_at, visited, whole
from rich.style import Style
from sample_worlds import LEFT, RIGHT, UP, lake_world
from samples import lake, look
from snapshots import changed
from textual.geometry import Size

from rl_tui.screen.draw.block_signs import block_number
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.numbers_in_common import all_v
from rl_tui.screen.kit.value_scale import SteadyScale
from rl_tui.screen.panels.grid.cells import CellArtist
from rl_tui.screen.panels.grid.form import CellForm, cell_form
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.map import GridMap
from rl_tui.screen.panels.grid.marks import cell_rewards, lead_steps
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.world import World


@pytest.mark.parametrize(
    ("size", "form"),
    [
        ((40, 8), CellForm(10, 2)),  # 4×4 at 80×24
        ((60, 12), CellForm(14, 3)),  # at 120×40
        ((118, 36), CellForm(29, 9)),  # in a large preview
        ((20, 4), CellForm(5, 1)),
        ((19, 4), CellForm(4, 1)),  # only arrows
        ((8, 4), CellForm(2, 1)),
        ((7, 4), CellForm(5, 1)),  # does not fit
        ((40, 3), CellForm(8, 1)),  # nor is it low enough
    ],
)
def test_cells_of_a_4x4_map_take_the_largest_form_that_fits(size: tuple[int, int], form: CellForm) -> None:
    assert cell_form(4, 4, *size) == form


def test_an_8x8_map_fits_into_40_by_8() -> None:
    assert cell_form(8, 8, 40, 8) == CellForm(5, 1)
    assert cell_form(8, 8, 60, 16) == CellForm(7, 2)


def test_medium_cells_have_letters_above_values_and_the_agent_beside_them() -> None:
    start = lake(step=0)
    q = q_of(start, {(0, LEFT): 0.54, (6, LEFT): 0.36, (10, UP): 0.62, (14, RIGHT): 0.864})
    rows = picture(changed(start, q=q, state=6), 40, 8)
    assert rows[0] == "    ←   S▕    ·    ▕    ·    ▕    ·    ▕"
    assert rows[1] == "   .54   ▕         ▕         ▕         ▕"
    assert rows[2] == "    ·    ▕    ●    ▕ ◉  ←    ▕    ●    ▕"
    assert rows[3] == "         ▕         ▕   .36   ▕         ▕"
    assert rows[6] == "    ●    ▕    ·    ▕    →    ▕    ★    ▕"
    assert rows[7] == "         ▕         ▕   .86   ▕         ▕"


def test_large_cells_have_signs_of_blocks_and_seams() -> None:
    start = lake(step=0)
    q = q_of(start, {(0, LEFT): 0.54, (1, UP): 0.2})
    rows = picture(changed(start, q=q, state=1), 56, 12)
    assert rows[:4] == [
        "    ▗▄▟▛    S▕ ◉     ▟▙    ▕             ▕             ▕",
        "    ▝▀▜▙     ▕      ▟██▙   ▕      ·      ▕      ·      ▕",
        "     .54     ▕     .20     ▕             ▕             ▕",
        "             ▕    ▗▄▄▖     ▕             ▕    ▗▄▄▖     ▕",
    ]
    rows = picture(changed(start, q=q, state=1), 56, 16)
    assert rows[:4] == [
        "     ▗▄▟█   S▕ ◉     ▟▙    ▕             ▕             ▕",
        "   ▐█████    ▕      ▟██▙   ▕      ·      ▕      ·      ▕",
        "     ▝▀▜█    ▕     ▟████▙  ▕             ▕             ▕",
        "     .54     ▕     .20     ▕             ▕             ▕",
    ]


def test_small_cells_have_mark_arrow_and_value_in_one_row() -> None:
    start = lake(step=0)
    q = q_of(start, {(0, LEFT): 0.54, (6, LEFT): 0.36, (10, UP): 0.62})
    rows = small(changed(start, q=q, state=6))
    assert rows == [
        "S←.54  ·    ·    ·  ",
        "  ·    ●  ◉←.36  ●  ",
        "  ·    ·   ↑.62  ●  ",
        "  ●    ·    ·    ★  ",
    ]


@pytest.mark.parametrize(
    ("size", "agent", "arrow"),
    [
        ((20, 4), "◉", "→"),
        ((40, 8), " ◉ ", "→"),
        ((28, 12), " ◉ ", "→"),
        ((36, 16), " ◉ ", "▜▙▄▖"),
        ((60, 12), " ◉ ", "▜▙▄▖"),
        ((60, 16), " ◉ ", "█████▌"),
        ((60, 20), " ◉ ", "█████▌"),
    ],
)
def test_the_agent_hides_neither_arrow_nor_value_in_any_form(
    size: tuple[int, int], agent: str, arrow: str
) -> None:
    start = lake(step=0)
    text = "\n".join(picture(changed(start, q=q_of(start, {(1, RIGHT): 0.47}), state=1), *size))
    assert all(each in text for each in (agent, arrow, ".47"))


def test_in_very_high_cells_values_are_in_blocks_below_a_smaller_arrow() -> None:
    start = lake(step=0)
    view = GridView(start.world, look())
    view.cell = Size(29, 9)
    q = q_of(start, {(1, RIGHT): 0.17})
    rows = [strip.text[29:57] for strip in view.picture(changed(start, q=q, state=1), 116, 36)[:9]]
    assert [row[1:11].strip() for row in rows[1:5]] == ["▄████▄", "▟██████▙", "▜██████▛", "▀████▀"]
    assert [row[11:].strip() for row in rows[1:6]] == ["█▙▄▖", "█████▙▄▖", "█████▛▀▘", "█▛▀▘", ""]
    assert [row.strip() for row in rows[6:]] == ["▀█  ▀▀█", "█   ▄▀", "▀ ▀▀▀  ▀"]
    ascii_view = GridView(start.world, look(ascii=True))
    ascii_view.cell = Size(29, 9)
    assert any(".17" in strip.text for strip in ascii_view.picture(changed(start, q=q), 116, 36))


def test_an_agent_in_a_hole_stands_beside_it() -> None:
    rows = small(changed(lake(step=0), state=5))
    assert rows[1] == "  ·   ◉●    ·    ●  "


def test_ties_are_several_arrows_or_a_star_where_they_do_not_fit_and_a_tie_of_all_is_a_dot() -> None:
    start = lake(step=0)
    two = changed(start, q=q_of(start, {(1, LEFT): 0.5, (1, UP): 0.5}))
    assert "↑←" in picture(two, 40, 8)[0]
    assert small(two)[0] == "◉ ·   *.50  ·    ·  "
    four = picture(visited(start, 1), 40, 8)
    assert four[0][10:] == "    ·    ▕    ·    ▕    ·    ▕"
    assert four[1][10:] == "    0    ▕         ▕         ▕"
    assert small(visited(start, 1))[0] == "◉ ·      0  ·    ·  "


@pytest.mark.parametrize(
    ("size", "rows"), [((7, 3), ("       ", "  ↑←   ")), ((9, 4), ("▗▄▛  ▗█▖ ", "▝▀▙  ▟█▙ "))]
)
def test_two_tied_directions_are_arrows_side_by_side_or_letters(
    size: tuple[int, int], rows: tuple[str, ...]
) -> None:
    two = changed(lake(step=0), q=q_of(lake(step=0), {(1, LEFT): 0.5, (1, UP): 0.5}))
    view = GridView(two.world, look())
    view.cell = Size(*size)
    drawn = [strip.text for strip in view.picture(two, 60, 24)]
    cell = [row[size[0] : 2 * size[0] - 1] for row in drawn[size[1] == 4 :][: len(rows)]]
    assert cell == [row[: size[0] - 1] for row in rows]


def test_the_less_an_action_leads_the_paler_is_its_arrow() -> None:
    start = lake(step=0)
    q = q_of(
        start,
        {(1, UP): 1.0, (2, UP): 0.99, (3, UP): 0.99, (3, LEFT): 0.98999, (4, UP): 0.9, (2, LEFT): 0.989},
    )
    strip = GridView(start.world, look()).picture(changed(start, q=q), 40, 8)[0]
    assert strip.text[10:] == "    ↑    ▕    ↑    ▕    ↑    ▕"
    inks = [style_at(strip, column) for column in (14, 24, 34)]
    contrasts = [contrast(ink.color, ink.bgcolor) for ink in inks if ink and ink.color and ink.bgcolor]
    assert contrasts == sorted(contrasts, reverse=True)
    assert contrasts[0] > contrasts[1] > 0.6 * contrasts[0]  # a lead of 1 % of the range
    assert 3.0 <= contrasts[2] < 4.0


def test_neighbours_in_one_row_keep_apart() -> None:
    four = visited(lake(step=0), 0, 1, 2, 3)
    assert picture(four, 28, 4)[0] == " ◉   0▕     0▕     0▕     0▕"


@pytest.mark.parametrize("layer", [Layer.Q, Layer.VISITS])
def test_a_cell_too_narrow_has_no_number_and_a_wider_one_has_it_with_a_gap(layer: Layer) -> None:
    shown = changed(lake(), visits=np.full(44, 300))
    view = GridView(shown.world, look())
    view.wanted_layer = layer
    for width in (3, 4):
        view.cell = Size(width, 2)
        view.show(shown)
        lines = [strip.text for strip in view.picture(shown, 4 * width, 9)[:8]]
        numbers = re.findall(r"[.\dk▪]+", "\n".join(lines))
        assert {len(each) < width for each in numbers} == ({True} if width == 4 else set())


def test_a_value_too_small_for_a_narrow_cell_is_a_bound() -> None:
    start = lake(step=0)
    tiny = changed(start, q=q_of(start, {(1, LEFT): 2e-3, (2, LEFT): 0.13}))
    row = picture(tiny, 40, 8)[1]
    assert "<.01" in row
    assert ".13" in row
    drawn = ["".join(picture(tiny, *size)) for size in ((40, 8), (20, 4), (60, 12))]
    assert not any("e-" in each for each in drawn)
    assert "0⁺" in drawn[1]
    assert "<.01" in drawn[2]


def test_nothing_known_is_a_dot_on_the_floor_unlike_a_zero_that_was_visited() -> None:
    start = lake(step=0)
    palette = look().palette
    view = GridView(start.world, look())
    unknown = view.picture(start, 40, 8)
    assert not set("↑→↓←0") & set("".join(strip.text for strip in unknown))
    floor = style_at(unknown[1], 14)
    assert floor is not None
    assert floor.bgcolor == palette.unvisited.bgcolor
    known = view.picture(visited(start, 1), 40, 8)
    assert known[1].text[14] == "0"
    assert style_at(known[1], 14) == palette.value(0.0)


def test_optimistic_estimates_alone_are_not_knowledge() -> None:
    start = lake(step=0)
    rows = picture(changed(start, q=np.ones(start.world.space.pairs)), 40, 8)
    assert rows[1] == "   1.00  ▕   1.00  ▕   1.00  ▕   1.00  ▕"
    assert not set("↑→↓←") & set("".join(rows))


def test_where_both_signs_matter_tints_are_as_far_from_a_grey_zero() -> None:
    start = lake(step=0)
    palette = look().palette
    q = q_of(start, {(0, place): -1.0 - place for place in range(4)} | {(1, 0): -0.5, (2, 0): 3.0})
    strip = GridView(start.world, look()).picture(changed(start, q=q), 40, 8)[1]
    assert strip.text == "   −1.0  ▕    0    ▕   3.0   ▕         ▕"
    bold = Style(bold=True)
    assert style_at(strip, 3) == palette.signed_value(-1.0 / 3.0) + bold
    assert style_at(strip, 14) == palette.signed_value(0.0)
    assert style_at(strip, 24) == palette.signed_value(1.0) + bold


def test_a_tint_does_not_move_while_values_shrink_until_another_run_begins() -> None:
    start = lake(step=0)
    view = GridView(start.world, look())
    high, low = (changed(start, q=q_of(start, {(0, LEFT): top, (1, LEFT): 1.0})) for top in (4.0, 2.0))
    tints = [style_at(view.picture(each, 40, 8)[1], 14) for each in (low, high, low)]
    assert tints[0] != tints[1] == tints[2]
    view.show(low)
    view.show(changed(low, recipe=replace(low.recipe, seed=1)))
    assert style_at(view.picture(low, 40, 8)[1], 14) == tints[0]


def test_terminal_cells_never_show_a_value() -> None:
    for size in ((20, 4), (40, 8), (60, 12)):
        text = "".join(picture(lake(), *size))
        # eleven live states of sixteen
        assert text.count(".") == 11


def test_walls_fill_their_cell_and_other_actions_show_their_first_letter() -> None:
    world = lake_world()
    kinds = (CellKind.WALL, *world.drawing.kinds[1:])  # type: ignore[union-attr]
    drawing = replace(world.drawing, kinds=kinds, directions=(None, (1, 0), (0, 1), (-1, 0)))  # type: ignore[arg-type]
    other = World(world.space, drawing)  # type: ignore[arg-type]
    start = changed(lake(step=0), world=other, state=2)
    rows = small(changed(start, q=q_of(start, {(1, LEFT): 0.5})))
    assert rows[0].startswith("      l.50")


def test_ascii() -> None:
    start = lake(step=0)
    rows = picture(
        changed(start, q=q_of(start, {(6, LEFT): -0.36, (6, UP): -0.1}), state=6), 20, 4, ascii=True
    )
    assert "".join(rows).isascii()
    assert rows[1] == "  .    O  @*  0  O  "


def test_values_of_three_digits_are_never_number_signs() -> None:
    snapshot = large_lake()
    q = np.full_like(snapshot.agent.q, -100.0)
    view = GridView(snapshot.world, look())
    assert view.picture(changed(snapshot, q=q), 60, 10)[1].text.startswith("  −100▕  −100▕  −100▕")
    assert "−12k" in view.picture(changed(snapshot, q=120 * q), 60, 10)[1].text
    zero = view.picture(visited(changed(snapshot, q=0 * q), 40), 60, 10)[1].text
    assert zero.startswith("     0▕")  # as wide as ever before
    medium = large_lake(10)
    view = GridView(medium.world, look())
    view.picture(medium, 50, 10)
    below = changed(medium, q=np.full_like(medium.agent.q, -100.0), step=1)
    assert not set("#1") & set(view.picture(below, 50, 10)[1].text)
    assert view.heading == "World · greedy, V as colour"
    view.show(below)
    view.show(medium)  # the past of the same run
    view.picture(medium, 50, 10)
    assert view.heading == "World · greedy, V as colour"
    another = changed(medium, recipe=replace(medium.recipe, seed=1))
    view.show(another)
    view.picture(another, 50, 10)
    assert view.heading == "World · V and greedy"


def test_arrows_stand_alone_where_a_map_fits_only_without_its_values() -> None:
    snapshot = large_lake(20)
    q = q_of(snapshot, {(0, RIGHT): 0.5, (21, LEFT): 0.2, (22, UP): 0.1})
    q[snapshot.world.space.pairs_of(22).start] = 0.1
    view = GridView(snapshot.world, look())
    rows = [strip.text for strip in view.picture(changed(snapshot, q=q, state=21), 60, 20)]
    assert rows[0].startswith("S →")
    assert rows[1].startswith(" · ◉ ← *  ·")
    assert rows[19].endswith(" ★ ")
    assert view.heading == "World · greedy, V as colour"
    assert view.footing == ""


def test_a_cliff_is_hatched_in_its_own_colour_and_strokes_continue_across_cells() -> None:
    world = lake_world()
    assert isinstance(world.drawing, Grid)
    kinds = tuple(CellKind.CLIFF if kind is CellKind.HOLE else kind for kind in world.drawing.kinds)
    snapshot = changed(lake(step=0), world=World(world.space, replace(world.drawing, kinds=kinds)))
    strips = GridView(snapshot.world, look()).picture(snapshot, 20, 4)
    assert strips[1].text == "  ·  ╱  ╱   ·    ╱  "
    assert style_at(strips[1], 5) == look().palette.cliff
    strokes = [(x, y) for y, strip in enumerate(strips) for x, sign in enumerate(strip.text) if sign == "╱"]
    assert {(x + y) % 3 for x, y in strokes} == {0}


def test_cells_that_pay_something_unusual_say_so() -> None:
    snapshot = paying()
    grid = snapshot.world.drawing
    assert isinstance(grid, Grid)
    assert cell_rewards(snapshot.world.space, grid) == {1: (-1.0, False), 4: (1.0, True)}
    strip = GridView(snapshot.world, look()).picture(snapshot, 50, 6)[0]
    assert strip.text == " ◉      S▕−1       ▕         ▕         ▕+1       ▕"
    assert style_at(strip, 10) == look().palette.bad + Style(bold=True)
    assert picture(snapshot, 25, 2)[0] == "◉ ·  − ·    ·    ·  + ·  "
    assert picture(snapshot, 10, 2)[0] == "◉·−· · ·+·"
    start = lake(step=0)
    assert isinstance(start.world.drawing, Grid)
    assert cell_rewards(start.world.space, start.world.drawing) == {}


@pytest.mark.parametrize(
    ("size", "expected"),
    [((60, 16), "◤     ▗▄▟█"), ((60, 12), "◤   "), ((40, 8), "◤   ←"), ((20, 4), "◤←.54"), ((12, 4), "◤← ")],
)
def test_a_state_whose_greedy_actions_differ_in_the_other_lane_says_so(
    size: tuple[int, int], expected: str
) -> None:
    start = lake(step=0)
    view = GridView(start.world, look())
    snapshot = changed(start, q=q_of(start, {(2, LEFT): 0.54}))
    assert "◤" not in "".join(strip.text for strip in view.picture(snapshot, *size))
    assert "◤" not in {each.sign for each in view.signs()}
    view.differing = frozenset({2})
    rows = [strip.text for strip in view.picture(snapshot, *size)]
    assert "".join(rows).count("◤") == 1
    assert any(expected in row for row in rows)
    assert "◤" in {each.sign for each in view.signs()}


def test_where_there_is_no_room_for_that_the_arrow_is_reversed() -> None:
    start = lake(step=0)
    palette = look().palette
    for size, column in (((20, 4), 1), ((8, 4), 1)):
        view = GridView(start.world, look())
        view.differing = frozenset({0})
        view.snapshot = start
        q = q_of(start, {(0, LEFT): 0.54, (1, LEFT): 0.01})
        strip = view.picture(changed(start, q=q, state=0), *size)[0]
        assert "◤" not in strip.text
        assert strip.text[column] == "←"
        assert style_at(strip, column) == palette.value(1.0) + Style(bold=True, reverse=True)


def test_ascii_has_a_sign_for_what_differs() -> None:
    start = lake(step=0)
    view = GridView(start.world, look(ascii=True))
    view.differing = frozenset({2})
    text = "".join(
        strip.text for strip in view.picture(changed(start, q=q_of(start, {(2, LEFT): 0.54})), 40, 8)
    )
    assert "x" in text
    assert text.isascii()


def test_the_form_of_numbers_does_not_depend_on_what_is_in_view() -> None:
    snapshot = lake(step=0)
    q = np.full(snapshot.world.space.pairs, -12.5)
    q[:4] = 0.25
    snapshot = visited(changed(snapshot, q=q), 0, 1, 2)
    whole, top = picture(snapshot, 24, 4), picture(snapshot, 24, 2)
    assert whole[0] == top[0]


@pytest.mark.parametrize("size", [(100, 20), (50, 6), (30, 2), (10, 2)])
@pytest.mark.parametrize("with_actions", [False, True])
def test_a_cell_with_one_way_out_says_which_unless_the_agent_takes_the_room(
    size: tuple[int, int], with_actions: bool
) -> None:
    start = one_way()
    view = GridView(start.world, look())
    view.shows_actions = with_actions
    assert "".join(strip.text for strip in view.picture(start, *size)).count("»") == 1
    assert any((sign.sign, sign.meaning) == ("»", "one-way") for sign in view.signs())
    with_agent = "".join(strip.text for strip in view.picture(changed(start, state=1), *size))
    assert ("»" in with_agent) == (size[1] > 2 and not with_actions)


def test_an_exit_looks_like_goal_or_hole_with_what_it_pays_and_without_a_value() -> None:
    world = find("discount").build(np.random.default_rng(0))
    space = world.space
    start = changed(lake(step=0), world=world, q=np.zeros(space.pairs), visits=np.ones(space.pairs, np.int64))
    rows = picture(changed(start, state=0), 56, 18)
    text = "".join(rows)
    assert "+10" in text
    assert text.count("−10") == 7
    assert text.count("★") == 2
    assert text.count("▟▀▀▙") == 7
    assert "e" not in text


@pytest.mark.exhaustive("all combinations", but=["1.0-False", "-100.0-False", "12345.6-True"])
@pytest.mark.parametrize("in_ascii", [False, True])
@pytest.mark.parametrize("times", [1.0, -100.0, 12_345.6])
def test_no_number_is_cut_in_any_cell(in_ascii: bool, times: float) -> None:
    snapshot = changed(lake(), q=lake().agent.q * times)
    grid = snapshot.world.drawing
    assert isinstance(grid, Grid)
    cells = GridMap(snapshot.world.space, grid).contents(whole(snapshot), snapshot)
    values, scale, glyphs = all_v(snapshot), SteadyScale().of(snapshot), look(in_ascii).glyphs
    for width, height in product(range(1, 27), (1, 2, 3, 4, 6, 9, 12)):
        form = CellForm(width, height)
        number_form = SteadyForms().form("", values, form.digits, most=2)._replace(leading_zero=False)
        artist = CellArtist(look(in_ascii), form)
        for cell in cells:
            rows = artist.drawn(artist.face(cell, scale, number_form, lead_steps(scale)))
            text = ["".join(segment.text for segment in row) for row in rows]
            assert [len(row) for row in text] == [width] * height
            if cell.value is not None and cell.known and form.has_values:
                number = number_form.text(cell.value, glyphs) if abs(cell.value) > 1e-9 else "0"
                is_whole = any(number in row or glyphs.no_room in row for row in text)
                in_blocks = block_number(number)
                lines = zip(in_blocks, text[-3:], strict=False)
                is_whole |= bool(in_blocks) and all(each.strip() in row for each, row in lines)
                assert is_whole, (width, height, text)


@pytest.mark.parametrize("size", [(60, 12), (40, 8), (20, 4)])
def test_the_cursor_is_seen_on_a_wall(size: tuple[int, int]) -> None:
    world = GridSection.model_validate({"map": "S.G#.\n...#.\n"}).build(np.random.default_rng(0))
    q = np.zeros(world.space.pairs)
    snapshot = changed(lake(step=0), world=world, state=0, q=q, visits=q.astype(np.int64))
    view = GridView(world, look())
    view.put_cursor(3)
    view.has_focus = True
    strips = view.picture(snapshot, *size)
    focus = look().palette.focus.bgcolor
    assert focus in {segment.style.bgcolor for strip in strips for segment in strip if segment.style}
