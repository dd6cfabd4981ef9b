"""Trail, slips, wind and numbers on a map."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from conftest import MakeApp
from drawn_grids import picture, q_of, style_at, visited
from samples import lake, learned_from, look
from seams import on_screen, press, screen_text, snapshot, train
from snapshots import changed

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.timeline.trail import TrailStep
from rl_tui.screen.catalogue.preview import beginning_of
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.signs import STATE_NUMBERS
from rl_tui.screen.panels.last_step.last_step import LastStepPanel
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.world import World

LEFT, DOWN, RIGHT = 0, 1, 2


def steps(*taken: tuple[int, int, int, int], first: int = 1) -> tuple[TrailStep, ...]:
    """(state, action, what happened, next state) of each step."""
    return tuple(TrailStep(number, *each) for number, each in enumerate(taken, start=first))


def with_trail(*taken: tuple[int, int, int, int], at: int = 6) -> Snapshot:
    return replace(changed(lake(step=0), state=at), trail=steps(*taken))


def straight(count: int) -> list[tuple[int, int, int, int]]:
    way = [0, *([1, 2] * count)][: count + 1]
    return [(one, RIGHT, RIGHT, other) for one, other in pairwise(way)]


def test_cells_that_were_left_have_a_mark_and_the_cell_of_the_agent_has_none() -> None:
    snapshot = with_trail((0, RIGHT, RIGHT, 1), (1, RIGHT, RIGHT, 2), (2, DOWN, DOWN, 6))
    rows = picture(snapshot, 40, 8)
    assert rows[0] == "    ·  S•▕    ·   •▕    ·   •▕    ·    ▕"
    assert sum(row.count("•") for row in rows) == 3
    assert picture(snapshot, 20, 4)[0] == "S•·  • ·  • ·    ·  "


def test_an_older_mark_is_fainter() -> None:
    snapshot = replace(changed(lake(step=0), state=2), trail=steps(*straight(20)))
    rows = picture(snapshot, 40, 8)
    assert rows[0][8] == "◦"
    assert rows[0][18] == "•"


def last_step(snapshot: Snapshot, *, rose: bool) -> Snapshot:
    step, last = snapshot.trail[-1], snapshot.counters.last_step or lake(step=1).counters.last_step
    assert last is not None
    pair = snapshot.world.space.pairs_of(step.state).start + step.action
    state, following = step.state, step.next_state
    after = 0.5 if rose else 0.1
    done = replace(last, step=step.step, state=state, pair=pair, next_state=following, updated_pair=pair)
    return replace(
        changed(snapshot, last_step=replace(done, before=0.3, after=after), state=following),
        trail=snapshot.trail,
    )


@pytest.mark.parametrize(
    ("way", "sign"),
    [
        ((5, RIGHT, RIGHT, 6), "━▶"),
        ((6, LEFT, LEFT, 5), "◀━"),
        ((5, DOWN, DOWN, 9), "▼"),
        ((5, 3, 3, 1), "▲"),
    ],
)
def test_the_way_of_the_last_step_stands_on_the_edge_of_its_cell(
    way: tuple[int, int, int, int], sign: str
) -> None:
    snapshot = last_step(with_trail(way, at=way[3]), rose=True)
    view = GridView(snapshot.world, look())
    rows = view.picture(snapshot, 56, 12)
    ((row, column),) = [(y, row.text.index(sign)) for y, row in enumerate(rows) if sign in row.text]
    assert (row // 3) * 4 + column // 14 == way[0]
    style = style_at(rows[row], column)
    assert style is not None
    assert style.color == look().palette.agent.color


@pytest.mark.parametrize("row", ["▌  3031726 ▼ ▐", "▌ 3031726 ▼▐", "▌3031726▼▐", "3031726▐"])
def test_the_way_of_the_last_step_covers_no_digit(row: str) -> None:
    snapshot = last_step(with_trail((4, DOWN, DOWN, 8), at=8), rose=True)
    visits = np.zeros(64, np.int64)
    visits[16] = 3_031_726
    view = GridView(snapshot.world, look())
    view.wanted_layer = Layer.VISITS
    rows = view.picture(replace(snapshot, agent=replace(snapshot.agent, visits=visits)), 4 * len(row), 13)
    assert rows[5].text[: len(row)] == row


def test_a_slip_is_a_way_in_another_colour() -> None:
    snapshot = last_step(with_trail((4, DOWN, RIGHT, 5), at=5), rose=True)
    view = GridView(snapshot.world, look())
    rows = view.picture(snapshot, 56, 12)
    row, column = next((row, row.text.index("━▶")) for row in rows if "━▶" in row.text)
    style = style_at(row, column)
    assert style is not None
    assert style.color == look().palette.bad.color
    view.snapshot = snapshot
    assert signs(view)["slipped"] == "━▶"


@pytest.mark.parametrize("rose", [True, False])
def test_the_cell_of_the_updated_pair_has_a_frame_in_the_colour_of_its_error(rose: bool) -> None:
    snapshot = last_step(with_trail((4, DOWN, DOWN, 8), at=8), rose=rose)
    view, palette = GridView(snapshot.world, look()), look().palette
    rows = view.picture(snapshot, 56, 12)
    apart, framed = [" ▕"] * 3, ["▌▐"] * 3
    assert [row.text[0] + row.text[13] for row in rows] == [*apart, *framed, *apart, *apart]
    style = style_at(rows[4], 0)
    assert style is not None
    assert style.color == (palette.good if rose else palette.bad).color
    fast = changed(snapshot, phase=Phase.RUNNING, speed=None)
    assert "▌" not in "".join(row.text[0] for row in view.picture(fast, 56, 12))
    known = changed(snapshot, q=q_of(snapshot, {(4, DOWN): 0.5}))
    plain = GridView(snapshot.world, look(ascii=True)).picture(known, 56, 12)
    reversed_number = style_at(plain[5], 6)
    assert reversed_number is not None
    assert reversed_number.reverse


def test_marks_are_seen_without_colours_and_in_ascii() -> None:
    snapshot = with_trail((0, RIGHT, RIGHT, 1), (1, RIGHT, RIGHT, 2), (2, DOWN, DOWN, 6))
    assert picture(snapshot, 40, 8, ascii=True)[0][8] == "="
    view = GridView(snapshot.world, look(depth="none"))
    assert view.picture(snapshot, 40, 8)[0].text[8] == "•"


def test_a_mark_hides_neither_arrows_nor_value_nor_tint() -> None:
    snapshot = visited(with_trail((1, RIGHT, RIGHT, 2)), 1)
    view = GridView(snapshot.world, look())
    rows = view.picture(snapshot, 40, 8)
    assert rows[0].text[10:20] == "    ·   •▕"
    assert "0" in rows[1].text[10:20]
    style = style_at(rows[0], 18)
    assert style.bgcolor == look().palette.value(0.0).bgcolor


def test_where_a_cell_has_no_room_its_lower_row_is_underlined() -> None:
    snapshot = visited(with_trail((0, RIGHT, RIGHT, 1)), 0)
    view = GridView(snapshot.world, look(depth="none"))
    style = style_at(view.picture(snapshot, 8, 4)[0], 1)
    assert style.underline


def test_a_step_that_is_not_known_leaves_no_mark_on_the_map() -> None:
    snapshot = lake(step=0)
    assert snapshot.trail == ()
    assert not any(sign in row for sign in "•◦~" for row in picture(snapshot, 40, 8))


def signs(panel: Panel) -> dict[str, str]:
    assert panel.snapshot is not None
    return {each.meaning: each.sign for each in panel.legend(panel.snapshot)}


def test_the_legend_has_the_trail_only_while_it_is_on_screen() -> None:
    view = GridView(lake().world, look())
    for moment, expected in ((lake(step=0), set()), (with_trail((0, RIGHT, RIGHT, 1)), {"trail"})):
        view.snapshot = moment
        view.picture(moment, 40, 8)
        assert signs(view).keys() & {"trail", "slipped"} == expected


def windy(**rules: Any) -> World:
    table = {"map": ".....\n.....\nS...G\n", "wind": [0, 1, 2, 0, 0], **rules}
    return GridSection.model_validate(table).build(np.random.default_rng(0))


def in_wind(world: World, state: int, action: int, place: int = 0) -> Snapshot:
    mdp = world.mdp
    pair = mdp.pair_of(state, action)
    assert pair is not None
    outcome = mdp.outcomes_of(pair)[place]
    q, visits = np.zeros(mdp.pairs), np.zeros(mdp.pairs, dtype=np.int64)
    begun = lake(step=1)
    last = begun.counters.last_step
    assert last is not None
    after = int(mdp.next_state[outcome])
    last = learned_from(last, state=state, pair=pair, outcome=outcome, next_state=after, updated_pair=pair)
    return changed(begun, world=world, q=q, visits=visits, state=after, last_step=last)


def test_the_wind_stands_below_its_columns() -> None:
    world = windy()
    rows = picture(in_wind(world, 10, RIGHT), 30, 4)
    assert rows[-1].split() == ["0", "↑1", "↑2", "0", "0"]
    assert rows[2].strip()[0] == "S"


@pytest.mark.parametrize(
    ("state", "action", "lit"),
    [(10, RIGHT, None), (11, RIGHT, 1), (12, LEFT, 2), (6, DOWN, 1), (11, DOWN, None), (1, RIGHT, None)],
)
def test_the_wind_is_lit_where_it_moved_the_agent(state: int, action: int, lit: int | None) -> None:
    snapshot = in_wind(windy(), state, action)
    view = GridView(snapshot.world, look())
    row = view.picture(snapshot, 30, 4)[-1]
    lit_columns = [
        x // 6
        for x, character in enumerate(row.text)
        if character.isdigit() and style_at(row, x) == look().palette.updated
    ]
    assert lit_columns == ([] if lit is None else [lit])


@pytest.mark.parametrize(
    ("state", "action", "size", "told"),
    [(11, LEFT, (80, 10), "wind ↑ 1 to 5"), (12, LEFT, (80, 2), "wind ↑ 2"), (10, RIGHT, (80, 10), "")],
)
def test_the_last_step_tells_of_the_wind(state: int, action: int, size: tuple[int, int], told: str) -> None:
    text = "\n".join(
        row.text for row in LastStepPanel(look()).picture(in_wind(windy(), state, action), *size)
    )
    assert told in text
    assert ("wind" in text) == bool(told)


def test_a_gust_that_is_stronger_than_usual_says_so() -> None:
    world = windy(gusts=True)
    mdp = world.mdp
    pair = mdp.pair_of(11, RIGHT)
    assert pair is not None
    landings = [int(mdp.next_state[each]) for each in mdp.outcomes_of(pair)]
    shown = {
        landing: picture(in_wind(world, 11, RIGHT, place), 30, 4)[-1].split()[1]
        for place, landing in enumerate(landings)
    }
    assert shown == {12: "↑1", 7: "↑1", 2: "↑1+"}


def test_without_a_free_row_the_wind_is_told_in_a_line() -> None:
    snapshot = in_wind(windy(), 10, RIGHT)
    view = GridView(snapshot.world, look())
    rows = view.picture(snapshot, 30, 3)
    assert len(rows) == 3
    assert view.footing == "wind 0 ↑1 ↑2 0 0"


def test_which_part_is_in_view_is_told_rather_than_the_wind() -> None:
    snapshot = in_wind(windy(), 10, RIGHT)
    view = GridView(snapshot.world, look())
    view.picture(snapshot, 24, 2)
    assert view.footing == "rows 1–2 · columns 0–3"
    view.picture(snapshot, 34, 2)
    assert view.footing == "rows 1–2 of 3 · follows the agent"
    view.picture(snapshot, 42, 2)
    assert view.footing == "wind 0 ↑1 ↑2 0 0 · rows 1–2 of 3"
    view.picture(snapshot, 90, 2)
    assert view.footing.startswith("wind 0 ↑1 ↑2 0 0 · rows 1–2 of 3")


def test_a_world_without_wind_has_no_row_for_it() -> None:
    world = windy(wind=[0, 0, 0, 0, 0])
    assert picture(in_wind(world, 10, RIGHT), 30, 4)[-1].strip() in ("", ".00")


def walled_in() -> Snapshot:
    world = GridSection.model_validate({"map": "S.G#.\n...#.\n"}).build(np.random.default_rng(0))
    pairs = world.space.pairs
    return changed(
        lake(step=0), world=world, state=0, q=np.zeros(pairs), visits=np.zeros(pairs, dtype=np.int64)
    )


def test_a_cell_that_is_never_reached_has_a_pattern_unlike_a_wall() -> None:
    snapshot = walled_in()
    rows = picture(snapshot, 25, 2)
    assert [row[20:] for row in rows] == ["░" * 5] * 2
    assert picture(snapshot, 25, 2, ascii=True)[0][15:] == "#####:::::"
    wall, floor = (style_at(GridView(snapshot.world, look()).picture(snapshot, 25, 2)[0], x) for x in (15, 0))
    assert wall == look().palette.wall != floor


def test_legend_and_cursor_tell_of_cells_that_are_never_reached() -> None:
    snapshot = walled_in()
    view = GridView(snapshot.world, look())
    view.snapshot = snapshot
    view.picture(snapshot, 25, 2)
    assert signs(view)["unreached"] == "░"
    assert view.name_at(4) == "state 4, never reached"
    assert view.name_at(1) == "state 1"
    view = GridView(lake().world, look())
    view.snapshot = lake()
    assert "unreached" not in signs(view)


@pytest.mark.parametrize(
    ("size", "row", "expected"),
    [
        ((60, 12), 0, "0      start ▕ ◉ 1         ▕2            ▕3            ▕"),
        ((40, 8), 0, "0   ·   S▕ ◉ 1·    ▕2   ·    ▕3   ·    ▕"),
        ((32, 8), 1, "    0  ▕    1  ▕    2  ▕    3  ▕"),
        ((32, 4), 0, " S    0▕ ◉    1▕      2▕      3▕"),
        ((26, 5), 0, "S   0▕◉   1▕    2▕    3▕"),
    ],
)
def test_cells_have_the_numbers_of_their_states(size: tuple[int, int], row: int, expected: str) -> None:
    snapshot = changed(lake(step=0), state=1)
    view = GridView(snapshot.world, look())
    view.is_numbered = True
    assert view.picture(snapshot, *size)[row].text.rstrip() == expected
    assert STATE_NUMBERS in view.heading


def test_a_hatched_cell_has_no_number() -> None:
    cliff = beginning_of(find("cliff"), find("cliff").section.build(np.random.default_rng(0)))
    view = GridView(cliff.world, look())
    view.is_numbered = True
    for height in (4, 20):
        text = "".join(strip.text for strip in view.picture(cliff, 12 * 12, height))
        assert [number for number in range(37, 47) if str(number) in text] == []
        assert all(str(number) in text for number in (35, 36, 47))


@pytest.mark.parametrize(
    ("width", "expected", "differs", "tie"),
    [
        (12, "S 0◤ 1◤ 2◤ 3", "15", None),
        (16, "S  0◤  1◤  2◤  3", "↑", None),
        (20, "S   0◤   1◤   2◤   3", "◤", None),
    ],
)
def test_what_differs_hides_no_number(width: int, expected: str, differs: str, tie: str | None) -> None:
    snapshot = changed(visited(lake(step=0), 0, 1, 2, 3), state=15)
    view = GridView(snapshot.world, look())
    view.snapshot = snapshot
    view.is_numbered, view.differing = True, frozenset({1, 2, 3})
    row = view.picture(snapshot, width, 4)[0]
    assert row.text == expected
    assert (signs(view)["differs"], signs(view).get("tie")) == (differs, tie)
    if differs == "none":
        column = width // 4 + (width // 4 - 1 if tie is None else 1)
        style = style_at(row, column)
        assert style.reverse


@pytest.mark.parametrize("size", [(85, 9), (60, 4), (60, 2), (37, 2), (24, 2)])
@pytest.mark.parametrize("shows_actions", [False, True])
def test_all_states_have_their_numbers_or_none(size: tuple[int, int], shows_actions: bool) -> None:
    world = GridSection.model_validate({"map": "S..G......#.\n..........#.\n"}).build(
        np.random.default_rng(0)
    )
    pairs = world.space.pairs
    snapshot = changed(
        lake(step=0), world=world, state=0, q=np.zeros(pairs), visits=np.zeros(pairs, np.int64)
    )
    view = GridView(world, look())
    view.snapshot = snapshot
    view.is_numbered, view.shows_actions = True, shows_actions
    text = "".join(strip.text for strip in view.picture(snapshot, *size))
    has_room = "no room" not in signs(view)
    assert [world.space.state_names[state] in text for state in (15, -1)] == [has_room] * 2


async def test_a_key_shows_state_numbers_on_every_map_until_it_is_pressed_again(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        assert STATE_NUMBERS not in screen_text(pilot.app)
        await press(pilot, "w", "n")
        assert STATE_NUMBERS in screen_text(pilot.app)
        await press(pilot, *"w]wnw[")
        assert STATE_NUMBERS in screen_text(pilot.app)
        await press(pilot, "w", "n")
        assert STATE_NUMBERS not in screen_text(pilot.app)


async def test_steps_leave_a_trail_and_going_back_takes_it_away(make_app: MakeApp) -> None:
    async with on_screen(make_app("cliff"), (120, 40)) as pilot:
        marks = []
        for key in ("s", "s", "s", "b", "b", "b"):
            await press(pilot, key)
            marks.append(len(snapshot(pilot).trail))
        assert marks == [1, 2, 3, 2, 1, 0]
        assert len((await train(pilot, 40)).trail) > 3
