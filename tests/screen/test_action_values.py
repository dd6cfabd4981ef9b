"""Cells of a map that show Q of every action."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import MakeApp
from drawn_grids import large_lake, paying, q_of, style_at, visited
from rich.style import Style
from sample_worlds import DOWN, LEFT, RIGHT, UP
from samples import big_lake, lake, look
from seams import notes, on_screen, playground, press, screen_text, train
from snapshots import changed

from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.timeline.trail import TrailStep
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.action_form import ActionForm, ActionKinds, Places, part_form, whole_map_form
from rl_tui.screen.panels.grid.action_values import ActionArtist
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.map import ActionValue, CellContent
from rl_tui.screen.panels.grid.marks import lead_steps
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.grid.section import GridSection

FOUR = ActionKinds(have_sides=True, are_diagonal=False, most=4)
EIGHT = ActionKinds(have_sides=True, are_diagonal=True, most=8)
SIX = ActionKinds(have_sides=False, are_diagonal=False, most=6)


def drawn(view: GridView, snapshot: Snapshot, width: int, height: int) -> list[str]:
    return [strip.text for strip in view.picture(snapshot, width, height)]


def with_actions(snapshot: Snapshot, **options: Any) -> GridView:
    view = GridView(snapshot.world, look(**options))
    view.shows_actions = True
    return view


def of_map(text: str, moves: str = "four", **legend: dict[str, Any]) -> Snapshot:
    table = {"map": text, "moves": moves, "rewards": "leaving", "legend": legend, "time_limit": 99}
    world = GridSection.model_validate(table).build(np.random.default_rng(0))
    pairs = world.space.pairs
    start = int(world.space.start_state[0])
    return changed(
        lake(step=0), world=world, state=start, q=np.zeros(pairs), visits=np.zeros(pairs, np.int64)
    )


def learned() -> Snapshot:
    """The agent in state 1 of the lake: the start is learned, and one action of state 1 is untried."""
    start = lake(step=0)
    values = {
        (0, LEFT): 0.94,
        (0, DOWN): 0.95,
        (0, RIGHT): 0.93,
        (0, UP): 0.94,
        (1, LEFT): 0.94,
        (1, UP): 0.09,
    }
    visits = start.agent.visits.copy()
    visits[[*start.world.space.pairs_of(0), *start.world.space.pairs_of(1)]] = 1
    visits[start.world.space.pairs_of(1).start + RIGHT] = 0
    return changed(start, q=q_of(start, values), visits=visits, state=1)


@pytest.mark.parametrize(
    ("kinds", "cells", "size", "form"),
    [
        (FOUR, (4, 4), (60, 12), (Places.CROSS, 15, 3)),  # at 120×40
        (FOUR, (4, 4), (40, 8), (Places.TINTS, 10, 2)),  # at 80×24
        (FOUR, (4, 4), (118, 36), (Places.CROSS, 23, 5)),  # full screen
        (FOUR, (8, 8), (60, 16), (Places.TINTS, 7, 2)),
        (FOUR, (8, 8), (118, 36), (Places.CROSS, 14, 4)),
        (FOUR, (8, 8), (40, 8), None),
        (FOUR, (4, 12), (118, 36), (Places.LIST, 9, 5)),  # the cliff in full screen
        (FOUR, (4, 12), (78, 20), (Places.LIST, 6, 5)),
        (FOUR, (1, 1), (10, 3), (Places.TINTS, 10, 3)),
        (FOUR, (1, 1), (11, 3), (Places.CROSS, 11, 3)),
        (FOUR, (1, 1), (11, 2), (Places.TWO_LISTS, 11, 2)),
        (FOUR, (1, 1), (4, 3), None),
        (EIGHT, (7, 10), (118, 36), (Places.SPREAD_KEYPAD, 11, 5)),
        (EIGHT, (1, 1), (15, 3), (Places.KEYPAD, 15, 3)),
        (EIGHT, (1, 1), (14, 3), (Places.TINTS, 14, 3)),
        (EIGHT, (1, 1), (9, 2), None),
        (SIX, (1, 1), (11, 3), (Places.TWO_LISTS, 11, 3)),
        (SIX, (1, 1), (10, 3), None),
    ],
)
def test_cells_take_the_first_form_that_fits(
    kinds: ActionKinds, cells: tuple[int, int], size: tuple[int, int], form: tuple[Places, int, int] | None
) -> None:
    found = whole_map_form(kinds, *cells, *size, digits=3, sign_width=1, tints=True)
    assert (found and found[:3]) == form


def test_tints_alone_are_no_form_without_colours() -> None:
    assert whole_map_form(FOUR, 4, 4, 40, 8, digits=3, sign_width=1, tints=False) is None


def test_of_a_map_that_does_not_fit_a_part_has_numbers_if_it_is_large_enough() -> None:
    assert part_form(SIX, 29, 23, 59, 20, digits=3, sign_width=1) is None
    alone = part_form(SIX, 29, 23, 118, 36, digits=3, sign_width=1)
    assert alone.places is Places.TWO_LISTS
    snapshot = large_lake()
    view = with_actions(snapshot)
    assert "◉" in "".join(drawn(view, snapshot, 118, 36))
    assert "follows the agent" in view.footing
    assert view.cells is not None


def test_each_number_stands_at_its_side_and_the_greedy_one_in_a_frame() -> None:
    snapshot = learned()
    rows = drawn(with_actions(snapshot), snapshot, 60, 12)
    assert [row[:30] for row in rows[:3]] == [
        "     .94            .09       ",
        " .94  S   .93  ▌.94▐ ◉    ·   ",
        "    ▌.95▐           .00       ",
    ]
    ascii_only = drawn(with_actions(snapshot, ascii=True), snapshot, 60, 12)
    assert ascii_only[1][:30] == " .94  S   .93  [.94] @    .   "


def test_an_action_never_taken_is_told_from_a_zero_that_was_learned_and_from_a_tie() -> None:
    snapshot = learned()
    palette = look().palette
    view = with_actions(snapshot)
    strips = view.picture(snapshot, 60, 12)
    text = strips[1].text
    assert style_at(strips[1], text.index("·")) == palette.unvisited
    assert style_at(strips[2], strips[2].text.index(".00")) == palette.value(0.0)
    tie = drawn(view, visited(lake(step=0), 0), 60, 12)
    assert "".join(tie[row][:15] for row in range(3)).count("▌") == 4
    assert not set("▌▐") & set("".join(drawn(view, lake(step=0), 60, 12)))


def test_an_estimate_that_was_set_and_never_updated_is_a_number_without_a_tint() -> None:
    start = lake(step=0)
    view = with_actions(start)
    strip = view.picture(changed(start, q=np.ones(start.world.space.pairs)), 60, 12)[0]
    assert style_at(strip, strip.text.index("1.00")) == look().palette.unvisited


def test_tints_are_those_of_v_and_what_lies_beyond_has_that_of_the_end() -> None:
    start = visited(lake(step=0), 0, 1)
    visits = np.ones_like(start.agent.visits)
    view = with_actions(start)
    snapshot = changed(start, visits=visits, q=q_of(start, {(0, UP): -1.0, (1, UP): 3.0}))
    strip = view.picture(snapshot, 60, 12)[0]
    palette = look().palette
    assert style_at(strip, strip.text.index("−1")) == palette.value(0.0)
    assert style_at(strip, strip.text.index("3.0")) == palette.value(1.0)
    assert style_at(view.picture(snapshot, 60, 12)[2], 7) == palette.value(0.0)


def test_marks_stand_in_the_middle() -> None:
    start = lake(step=0)
    palette = look().palette
    breakpoints = Breakpoints(frozenset({0, 2}))
    snapshot = changed(visited(start, 0, 1, 2), breakpoints=breakpoints)
    view = with_actions(start)
    view.differing = frozenset({1, 2})
    row = drawn(view, snapshot, 88, 20)[2]
    middle = [row[11 + 22 * cell - 4 : 11 + 22 * cell + 4].strip(" ▌▐") for cell in range(3)]
    assert [set(text) & set("!◉S◤") for text in middle] == [{"!", "◉"}, {"◤"}, {"!", "◤"}]
    view.point_at(start.world.space.pairs_of(1))
    strips = view.picture(snapshot, 60, 12)
    assert palette.focus in {segment.style for segment in strips[1]}


def test_what_a_cell_pays_stands_in_a_corner() -> None:
    snapshot = paying()
    view = with_actions(snapshot)
    row = drawn(view, snapshot, 75, 6)[0]
    assert "−1" in row
    assert "+1" in row
    assert next(iter(view.signs())).sign == "+1"


def test_kings_moves_stand_as_on_a_keypad() -> None:
    snapshot = of_map("S.\n.G\n", "king", G={"kind": "goal", "reward": 1.0, "terminal": True})
    space = snapshot.world.space
    names = {space.action_names[action]: place for place, action in enumerate(space.pair_action[:8].tolist())}
    q = np.zeros(space.pairs)
    order = ("up-left", "up", "up-right", "left", "right", "down-left", "down", "down-right")
    for number, name in enumerate(order, start=1):
        q[names[name]] = number / 10
    snapshot = changed(snapshot, q=q, visits=np.ones(space.pairs, np.int64))
    rows = drawn(with_actions(snapshot), snapshot, 34, 6)
    numbers = [[part for part in row[:15].split() if "." in part] for row in rows[:3]]
    assert numbers == [[".10", ".20", ".30"], [".40", ".50"], [".60", ".70", "▌.80▐"]]
    rows = drawn(with_actions(snapshot), snapshot, 26, 10)
    numbers = [[part for part in row[:13].split() if "." in part] for row in rows[:5]]
    assert numbers == [[".10", ".30"], [".20"], [".40", ".50"], [".70"], [".60", "▌.80▐"]]


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        (
            (28, 20),
            ["   S      ◉   ", "↑ .94  ↑ .09  ", "→ .93  →  ·   ", "↓▌.95▐ ↓ .00  ", "← .94  ←▌.94▐ "],
        ),
        ((28, 16), ["S↑.94  ◉↑.09  ", " →.93   → ·   ", " ↓.95▌  ↓.00  ", " ←.94   ←.94▌ "]),
        ((44, 8), ["↑.94 S↓.95▌↑.09 ◉↓.00 ", "→.93  ←.94 → ·   ←.94▌"]),
    ],
)
def test_a_list_has_the_sign_of_each_action_before_it(size: tuple[int, int], expected: list[str]) -> None:
    snapshot = learned()
    rows = drawn(with_actions(snapshot), snapshot, *size)
    assert [row[: len(expected[0])] for row in rows[: len(expected)]] == expected


def test_without_room_for_numbers_each_side_has_its_tint_and_the_greedy_ones_an_arrow() -> None:
    snapshot = learned()
    palette = look().palette
    view = with_actions(snapshot)
    strips = view.picture(snapshot, 40, 8)
    assert [strip.text[:20] for strip in strips[:2]] == ["   S         ◉      ", "    ↓     ←      ·  "]
    assert style_at(strips[1], 0) == palette.value(0.0)
    assert style_at(strips[1], 14) == palette.value(0.0)
    assert style_at(strips[1], 17) == palette.unvisited
    assert style_at(strips[1], 4) == palette.value(1.0) + Style(bold=True)
    assert view.heading == "World · Q of every action, as tint"
    plain = GridView(snapshot.world, look(depth="none"))
    expected = drawn(plain, snapshot, 40, 8)
    plain.shows_actions = True
    assert drawn(plain, snapshot, 40, 8) == expected
    assert plain.lacks_room


def test_a_state_whose_only_action_is_no_direction_has_it_in_the_middle() -> None:
    snapshot = of_map("S.g\n", g={"kind": "goal", "reward": 1.0, "exit": True})
    space = snapshot.world.space
    q = np.zeros(space.pairs)
    q[-1] = 1.0
    snapshot = changed(snapshot, q=q, visits=np.ones(space.pairs, np.int64))
    view = with_actions(snapshot)
    assert "e▌1.00▐" in drawn(view, snapshot, 45, 3)[1]
    assert "e" in "".join(drawn(view, snapshot, 21, 2))


def test_holes_and_the_goal_look_as_they_do_beside_values() -> None:
    snapshot = lake(step=0)
    rows = "".join(drawn(with_actions(snapshot), snapshot, 40, 8))
    assert (rows.count("●"), rows.count("★")) == (4, 1)
    rows = "".join(drawn(with_actions(snapshot), snapshot, 60, 12))
    assert (rows.count("▗▄▄▖"), rows.count("▀████▀")) == (4, 1)


def test_numbers_of_states_stand_in_a_corner_if_all_have_room() -> None:
    snapshot = learned()
    for size, expected in (((60, 12), "15 "), ((60, 16), "15 "), ((28, 8), "")):
        view = with_actions(snapshot)
        view.is_numbered = True
        text = "".join(drawn(view, snapshot, *size))
        assert ("10" in text) is bool(expected)
        assert (" 1 " in text) is bool(expected)
        assert ("no room" in {sign.meaning for sign in view.signs()}) is not bool(expected)


def test_the_trail_is_seen_beside_the_numbers() -> None:
    snapshot = learned()
    trail = (TrailStep(1, 0, DOWN, RIGHT, 1),)
    for size in ((60, 12), (40, 8), (28, 16)):
        rows = drawn(with_actions(snapshot), changed(snapshot, trail=trail), *size)
        assert look().glyphs.trail in "".join(rows)


def test_only_signs_that_are_drawn_are_explained() -> None:
    snapshot = learned()
    for size, signs in (((60, 12), "▌▐"), ((40, 8), "↑"), ((28, 16), "▌")):
        view = with_actions(snapshot)
        view.picture(snapshot, *size)
        legend = {sign.meaning: sign.sign.strip() for sign in view.signs()}
        assert legend["greedy"] == signs
        assert (legend["not tried"], legend["Q"]) == ("·", "tint")
        assert "V" not in legend


def test_numbers_stay_as_wide_until_another_run() -> None:
    start = lake(step=0)
    view = with_actions(start)
    wide = changed(start, q=np.full(start.world.space.pairs, -1.5), step=1)
    before = drawn(view, start, 60, 12)
    view.show(wide)
    drawn(view, wide, 60, 12)
    view.show(start)  # the past of the same run
    assert drawn(view, start, 60, 12) != before
    view.show(changed(start, recipe=replace(start.recipe, seed=1)))
    assert drawn(view, start, 60, 12) == before


@pytest.mark.parametrize("size", [(1, 1), (7, 4), (25, 9), (41, 13), (60, 12), (80, 24), (200, 60)])
@pytest.mark.parametrize("plain", [False, True])
def test_every_size_is_filled_exactly(size: tuple[int, int], plain: bool) -> None:
    width, height = size
    king = of_map("S..\n.G.\n...\n", "king", G={"kind": "goal", "reward": 1.0, "exit": True})
    for snapshot in (lake(), big_lake(), king, paying(), changed(lake(), q=np.full(44, np.inf))):
        view = with_actions(snapshot, ascii=plain, depth="none" if plain else "truecolor")
        strips = view.picture(snapshot, width, height)
        assert [strip.cell_length for strip in strips] == [width] * height
        assert all(segment.style is not None for strip in strips for segment in strip)
        assert not plain or "".join(strip.text for strip in strips).isascii()


@pytest.mark.screen
@pytest.mark.parametrize("size", [pytest.param((80, 24), marks=pytest.mark.exhaustive("a size")), (120, 40)])
async def test_a_key_turns_cells_to_q_and_back_and_the_next_scenario_shows_them_too(
    size: tuple[int, int], make_app: MakeApp
) -> None:
    async with on_screen(make_app("frozenlake"), size, notifications=True) as pilot:
        await train(pilot, 300)
        world = playground(pilot).board.world
        before = world.head
        await press(pilot, "w", "a")
        assert world.head.startswith("World · Q of every action")
        assert not notes(pilot.app)
        await press(pilot, "w", "a")
        assert world.head == before
        await press(pilot, "w", "a", "w", "]")
        assert playground(pilot).board.world is not world
        assert playground(pilot).board.world.shows_actions


@pytest.mark.screen
async def test_where_cells_are_too_small_it_says_so_and_the_zoom_helps(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-8x8"), (80, 24), notifications=True) as pilot:
        world = playground(pilot).board.world
        await press(pilot, "d")
        before = world.head
        await press(pilot, "w", "a")
        assert notes(pilot.app) == ["Cells are too small for Q of every action. f: full screen."]
        assert world.head == before
        world.focus()
        await press(pilot, "f")
        assert not world.lacks_room
        assert world.head.startswith("World · Q of every action")


@pytest.mark.screen
@pytest.mark.parametrize(
    ("scenario", "where"),
    [("student", "the table"), pytest.param("bandit", "each bar", marks=pytest.mark.exhaustive("a world"))],
)
async def test_other_worlds_say_where_q_stands(scenario: str, where: str, make_app: MakeApp) -> None:
    async with on_screen(make_app(scenario)) as pilot:
        await press(pilot, "w", "a")
        assert f"Not here: {where} " in screen_text(pilot.app)
        assert not playground(pilot).board.legends.shows_actions


def test_in_lists_numbers_stand_above_one_another_at_the_right() -> None:
    artist = ActionArtist(look(), ActionForm(Places.TWO_LISTS, 13, 2, 3))
    values = zip(((-1, 0), (0, 1), (1, 0), (0, -1)), (-8.0, 6.0, -7.0, 0.0), strict=True)
    actions = tuple(ActionValue(sign, q, not q, False) for sign, q in values)
    cell = CellContent(CellKind.FLOOR, False, 6.0, True, actions=actions)
    scale = ValueScale(-8.0, 6.0)
    rows = artist.strips((artist.face(cell, scale, NumberForm(3, 0), lead_steps(scale)),), 13)
    assert ["".join(segment.text for segment in row).rstrip() for row in rows] == ["↑ −8  ↓ −7", "→  6  ← ·"]
