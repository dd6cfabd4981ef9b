"""Two visible runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import MakeApp
from lane_samples import side_by_side
from samples import lake, look
from seams import on_screen, playground, press, screen_text, snapshot, train
from snapshots import changed
from test_lanes import open_lane
from textual.geometry import Size
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.board.board import Board
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import is_secret
from rl_tui.screen.kit.value_scale import SteadyScale
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.q_table.layers import Figures
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.side_by_side import greedy_differences, lane_results, lane_titles, sides
from rl_tui.screen.panels.world.view import WorldView

FOUR = ("world", "world-beside", "table", "table-beside")


def board_of(pilot: Pilot[UserError]) -> Board:
    return playground(pilot).board


def worlds(pilot: Pilot[UserError]) -> tuple[WorldView, WorldView]:
    left, right = (board_of(pilot).panel(panel) for panel in FOUR[:2])
    assert isinstance(left, WorldView)
    assert isinstance(right, WorldView)
    return left, right


def tables(pilot: Pilot[UserError]) -> tuple[QTable, QTable]:
    left, right = (board_of(pilot).panel(panel) for panel in FOUR[2:])
    assert isinstance(left, QTable)
    assert isinstance(right, QTable)
    return left, right


def text_of(panel: Panel) -> str:
    return "\n".join(panel.render_line(y).text for y in range(panel.size.height))


def with_greedy(snapshot: Snapshot, actions: dict[int, int]) -> Snapshot:
    q = np.zeros(snapshot.world.space.pairs)
    visits = np.zeros(snapshot.world.space.pairs, np.int64)
    for state, action in actions.items():
        pair = snapshot.world.space.pair_of(state, action)
        assert pair is not None
        q[pair], visits[pair] = 1.0, 1
    return changed(snapshot, q=q, visits=visits)


def test_only_states_known_to_both_are_counted() -> None:
    left = with_greedy(lake(0), {0: 1, 1: 2, 2: 0})
    right = with_greedy(lake(0), {0: 1, 1: 3, 4: 0})
    found = greedy_differences(left, right)
    assert (found.states, found.known, found.is_part) == (frozenset({1}), 2, False)
    assert "1 of 2 states" in found.words(left)[0]
    assert greedy_differences(lake(0), lake(0)).words(left) == ()
    assert "1 of 2 states in view" in replace(found, is_part=True).words(left)[0]


def test_a_tie_is_another_set_of_greedy_actions_than_one_of_the_two() -> None:
    left = with_greedy(lake(0), {1: 2})
    q = left.agent.q.copy()
    pair = left.world.space.pair_of(1, 3)
    assert pair is not None
    q[pair] = 1.0
    assert greedy_differences(left, changed(left, q=q)).states == {1}


def test_actions_of_a_policy_that_may_never_end_are_compared() -> None:
    unknown = np.full(lake().world.space.pairs, np.nan)
    left, right = (
        changed(lane, q=unknown, policy=lane.agent.q)
        for lane in (with_greedy(lake(0), {0: 1, 1: 2}), with_greedy(lake(0), {0: 1, 1: 3}))
    )
    assert greedy_differences(left, right).states == {1}


async def test_marks_and_note_follow_the_actions_in_view(make_app: MakeApp) -> None:
    async with on_screen(make_app("cliff"), (120, 40)) as pilot:
        await open_lane(pilot, "algorithm", "sarsa")
        await train(pilot, 1_500)
        left, right = worlds(pilot)
        learned = left.differing
        assert learned
        await press(pilot, "v")
        assert left.wanted_layer is Layer.OPTIMAL
        assert not left.differing | right.differing
        assert left.note == right.note == (), "the same Q* in both"
        await press(pilot, "t", "p")
        assert left.studied is PolicyKind.GREEDY
        assert np.isnan(left.snapshot.agent.values).any()  # type: ignore[union-attr]
        assert left.differing == right.differing == learned


def test_results_stand_beside_a_map_that_leaves_columns_free_and_nowhere_else() -> None:
    lane = side_by_side(2, shown=1)
    view = GridView(lane.world, look())
    view.lane, view.results, view.cell = lane_titles(lane, "2"), lane_results(lane, look()), Size(11, 4)
    beside = [strip.text[44:].strip() for strip in view.picture(lane, 70, 17)]
    assert beside[:5] == ["2 α 0.5", "Q-learning ε 0.1", "", "greedy .6", "agent  .32"]
    assert not view.picture(lane, 70, 17)[-1].text.startswith("2 α 0.5"), "it is named once"
    assert "agent  .32" not in "".join(strip.text for strip in view.picture(lane, 60, 17))


async def test_two_lanes_at_120x40_from_the_first_key_to_the_last(make_app: MakeApp) -> None:
    async with on_screen(make_app("cliff"), (120, 40), notifications=True) as pilot:
        await train(pilot, 3_000)
        await open_lane(pilot, "algorithm", "sarsa")
        board = board_of(pilot)
        (left, right), (left_table, right_table) = worlds(pilot), tables(pilot)
        assert (left.region.x, left.region.bottom) == (right.region.x, right.region.y), "a wide map"
        assert not board.shows("table")
        assert board.curve.region.width == board.controls.region.width == 116
        assert left.heading == "▸1 Q-learning · α 0.5 ε 0.1"
        assert right.heading == "2 SARSA · α 0.5 ε 0.1"
        shown = snapshot(pilot)
        assert np.array_equal(left.snapshot.agent.q, shown.agent.q)  # type: ignore[union-attr]
        assert np.array_equal(right.snapshot.agent.q, shown.beside.agent.q)  # type: ignore[union-attr]
        assert shown.beside.counters.step == shown.counters.step == 3_000

        differing = greedy_differences(shown, shown.beside)
        assert left.differing == right.differing == left_table.differing == differing.states
        assert f"{len(differing.states)} of {differing.known}" in right.footing

        places = left.region, right.region
        await press(pilot, "c", "l")  # the other is controlled, and nothing moves
        assert left.heading == "1 Q-learning · α 0.5 ε 0.1"
        assert right.heading == "▸2 SARSA · α 0.5 ε 0.1"
        assert board.world is right
        assert board.table is right_table
        assert (left.region, right.region) == places

        await press(pilot, "c", "c", "delete", "enter")  # the cursor starts on the controlled run
        assert snapshot(pilot).run_group.lanes == ()
        assert not board.is_paired
        assert board.world is left
        assert "Q-learning" not in left.heading
        assert not board.shows("world-beside")
        assert board.shows("table")


@pytest.mark.exhaustive("plays at another size", but=["size1"])
@pytest.mark.parametrize("size", [(80, 24), (120, 58)])
async def test_cursor_and_focus_go_through_all_panels(make_app: MakeApp, size: tuple[int, int]) -> None:
    async with on_screen(make_app("frozenlake-slippery"), size) as pilot:
        await train(pilot, 2_000)
        await open_lane(pilot, "alpha", "0.5")
        left, right = worlds(pilot)
        panels = FOUR if size == (120, 58) else FOUR[:2]
        for panel in (*panels, "curve"):
            await press(pilot, "tab")
            assert pilot.app.focused is board_of(pilot).panel(panel)
        right.focus()
        await press(pilot, "right", "down")
        assert right.shown_cursor is not None
        assert left.shown_cursor == right.shown_cursor == right.cursor
        await press(pilot, "shift+tab")
        assert pilot.app.focused is left  # and continues from there
        await press(pilot, "left")
        assert left.shown_cursor == right.shown_cursor == left.cursor
        for table in tables(pilot):
            assert left.cursor is not None
            assert table.pointed == left.pairs_at(left.cursor)
        await press(pilot, "escape")
        assert left.cursor is right.cursor is None
        assert not left.is_away
        assert not right.is_away


async def test_tables_scroll_and_turn_together(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-8x8"), (120, 70)) as pilot:
        await train(pilot, 1_000)
        await open_lane(pilot, "alpha", "0.5")
        left, right = tables(pilot)
        assert left.row_range is not None
        assert left.stance == right.stance
        right.focus()
        await press(pilot, "end")
        assert left.stance == right.stance
        assert left.row_range == right.row_range
        assert "62" in text_of(left)
        await press(pilot, "v")
        assert left.shown_layer is right.shown_layer is Layer.OPTIMAL
        await press(pilot, "escape", "s")
        assert left.stance == right.stance
        await press(pilot, "c", "l", "s")
        assert left.stance == right.stance


async def test_a_smaller_terminal_shows_one_lane_and_a_larger_one_both(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 58)) as pilot:
        await train(pilot, 1_000)
        await open_lane(pilot, "alpha", "0.5")
        await press(pilot, "c", "l")
        left, right = worlds(pilot)
        tables(pilot)[1].focus()
        await pilot.resize_terminal(60, 18)
        await settle(pilot)
        board = board_of(pilot)
        assert not board.is_paired
        assert board.world is left
        assert pilot.app.focused is tables(pilot)[0]
        assert left.lane == ()
        assert left.snapshot is snapshot(pilot)  # the controlled run, the second
        await press(pilot, "c", "l")
        assert left.snapshot is snapshot(pilot)
        await pilot.resize_terminal(80, 24)
        await settle(pilot)
        assert board.is_paired
        assert not board.shows("table")
        assert pilot.app.focused is left  # no table is visible
        assert pilot.app.screen.size == Size(80, 24)
        await pilot.resize_terminal(120, 58)
        await settle(pilot)
        assert all(board.shows(panel) for panel in FOUR)
        assert right.heading == "2 α 0.5 · Q-learning ε 0.1"


async def test_one_lane_alone_by_a_key_and_by_the_zoom(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), notifications=True) as pilot:
        await open_lane(pilot, "alpha", "0.5")
        board, (left, _) = board_of(pilot), worlds(pilot)
        await press(pilot, "c", "o")
        assert not board.is_paired
        assert board.shows("table")
        await press(pilot, "c", "l")
        assert left.snapshot is snapshot(pilot)
        await press(pilot, "c", "o")
        assert board.is_paired
        await press(pilot, "f")  # of the controlled run, which is on the right
        assert board.zoomed == "world-beside"
        await press(pilot, "c", "l")
        assert board.zoomed == "world"
        await press(pilot, "d")  # the microscope replaces both worlds: it is about the controlled run
        assert not board.is_paired
        assert board.microscope.snapshot is snapshot(pilot)
        await press(pilot, "escape")
        assert board.is_paired
        await pilot.resize_terminal(60, 18)
        await press(pilot, "c", "o")
        assert "there is no room" in screen_text(pilot.app)


async def test_who_acts_by_hand_acts_in_the_lane_led_and_of_three_the_one_marked_stands_beside(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await open_lane(pilot, "alpha", "0.5")
        left, right = worlds(pilot)
        await press(pilot, "y")
        assert (left.is_manual, right.is_manual) == (True, False)
        await press(pilot, "c", "l")
        assert (left.is_manual, right.is_manual) == (False, True)
        await press(pilot, "y", "c", "l", "w", "d")
        assert (left.is_drawn_on, right.is_drawn_on, left.has_focus) == (True, False, True)
        await press(pilot, "c", "l")
        assert (left.is_drawn_on, right.is_drawn_on, right.has_focus) == (False, True, True)
        await press(pilot, "escape")
        assert (left.is_drawn_on, right.is_drawn_on) == (False, False)
        await press(pilot, "c", "l")
        await open_lane(pilot, "alpha", "0.9")
        assert (left.heading[:2], right.heading[0]) == ("▸1", "2")
        await press(pilot, "c", "c", "down", "down", "space")
        assert snapshot(pilot).run_group.beside == 2
        assert (left.heading[:2], right.heading[0]) == ("▸1", "3")
        await press(pilot, "c", "l")
        assert (left.heading[:2], right.heading[0]) == ("▸2", "3")
        await press(pilot, "c", "l")
        assert (left.heading[0], right.heading[:2]) == ("2", "▸3")


async def test_what_a_bandit_keeps_secret_is_revealed_in_both(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), (120, 40)) as pilot:
        await train(pilot, 200)
        await open_lane(pilot, "epsilon", "0")
        left, right = worlds(pilot)
        assert left.stance == right.stance  # one scale
        budget = board_of(pilot).panel("budget")
        assert isinstance(budget, Panel)
        assert "regret and the best arm" in text_of(budget)
        await press(pilot, "w", "h")
        assert all(view.snapshot is not None and not is_secret(view.snapshot) for view in (left, right))
        assert text_of(budget).count("ε 0") == 2


def test_two_lanes_have_one_form_and_one_scale() -> None:
    space = lake().world.space
    small, large = np.linspace(0.01, 0.9, space.pairs), np.linspace(-60.0, 0.9, space.pairs)
    visits = np.ones(space.pairs, np.int64)
    shown = changed(side_by_side(2), q=small, visits=visits)
    left, right = sides(replace(shown, beside=changed(shown, q=large)))
    last, forms = space.pairs - 1, SteadyForms()
    first, second = (
        Figures(each, Layer.Q, look(), None, forms, SteadyScale().of(each)) for each in (left, right)
    )
    assert (first.low, first.high) == (second.low, second.high)
    assert first.text(last, 4) == second.text(last, 4)
    assert first.style(last) == second.style(last)
    for lane in (left, right):
        text = "".join(row.text for row in GridView(lane.world, look()).picture(lane, 28, 4))
        assert ".9" in text
        assert ".90" not in text
