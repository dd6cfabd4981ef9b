"""Several runs, from the keys to the panels."""

from __future__ import annotations

import numpy as np
from conftest import MakeApp
from seams import choose, on_screen, order, playground, press, snapshot, train
from textual.pilot import Pilot
from textual.widgets import Input

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddLane
from rl_tui.runs.recipe import SetParameter
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.row import WORLD, beside
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.playground.actions.export import script_of


async def open_lane(pilot: Pilot[UserError], name: str, value: str) -> None:
    if name == "algorithm":
        await press(pilot, "c", "a")
    else:
        await press(pilot, "c", "s")
        await choose(pilot, name)
    if pilot.app.screen.query(Input):
        pilot.app.screen.query_one(Input).value = value
        await press(pilot, "enter")
    else:
        await choose(pilot, value)


def curve_text(pilot: Pilot[UserError]) -> str:
    curve = playground(pilot).board.curve
    return "\n".join(curve.render_line(y).text for y in range(curve.size.height))


async def test_a_branch_becomes_a_lane_from_the_journal_and_from_compare(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), notifications=True) as pilot:
        await train(pilot, 500)
        await press(pilot, "B", "3", "right")
        pilot.app.set_focus(None)
        await train(pilot, 100)
        for keys in (["m", "b", "up", "c"], ["c", "b", "enter"]):
            here = snapshot(pilot).counters.step
            shown = await press(pilot, *keys)
            assert [lane.step for lane in shown.run_group.lanes] == [here, here]
            first, second = shown.run_group.lanes
            assert first.name.startswith("branch 2: ε 0.11 from step ")
            assert second.name == "branch 1"
            assert "branch 1" in curve_text(pilot)
            await press(pilot, "c", "c", "down", "delete", "enter")
            assert snapshot(pilot).run_group.lanes == ()


async def test_two_lanes_from_the_first_key_to_the_last(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), notifications=True) as pilot:
        await train(pilot, 500)
        await open_lane(pilot, "alpha", "0.5")
        first, second = snapshot(pilot).run_group.lanes
        assert (first.name, second.name) == ("α 0.1", "α 0.5")
        assert (first.step, second.step) == (500, 500)  # it has caught up
        assert snapshot(pilot).run_group.shown == 0

        shown = await press(pilot, "s")
        assert [lane.step for lane in shown.run_group.lanes] == [501, 501]
        shown = await train(pilot, 4_000)
        assert [lane.step for lane in shown.run_group.lanes] == [4_501, 4_501]
        assert "α 0.1: " in curve_text(pilot)
        assert "α 0.5: " in curve_text(pilot)
        board = playground(pilot).board
        assert "2 runs, ▸1 α 0.1" in board.curve.heading

        await press(pilot, "v")  # no table is visible here: the worlds take turns
        assert [board.panel(each).drawn_layer for each in (WORLD, beside(WORLD))] == [Layer.OPTIMAL] * 2
        await press(pilot, "c", "o", "v", "v")
        assert board.table.heading == "▸1 · Q of α 0.1 − Q of α 0.5"

        shown = await press(pilot, "c", "l")
        assert shown.run_group.shown == 1
        assert shown.agent.hyperparameters.alpha == 0.5
        assert np.array_equal(shown.agent.q, shown.run_group.lanes[1].q)
        assert board.table.heading == "▸2 · Q of α 0.5 − Q of α 0.1"
        await press(pilot, "escape")
        assert "2 runs, ▸2 α 0.5" in board.curve.heading
        assert pilot.app.screen.query_one("#alpha", Slider).value == 0.5

        await press(pilot, "1", "left")
        shown = snapshot(pilot)
        assert shown.run_group.lanes[0].hyperparameters.alpha == 0.1
        assert shown.run_group.lanes[1].hyperparameters.alpha == shown.agent.hyperparameters.alpha != 0.5
        pilot.app.set_focus(None)

        await press(pilot, "c", "c", "delete", "enter")  # the cursor starts on the visible run
        shown = snapshot(pilot)
        assert shown.run_group.lanes == ()
        assert shown.agent.hyperparameters.alpha == 0.1
        assert playground(pilot).recipe.hyperparameters.alpha == 0.1
        assert "lane" not in board.curve.heading
        assert board.table.lane == ""


async def test_another_seed_is_the_next_one_that_no_run_has_and_what_is_exported_names_it(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        await train(pilot, 200)
        await press(pilot, "c", "n")
        shown = await press(pilot, "c", "n")
        assert [lane.name for lane in shown.run_group.lanes] == ["seed 0", "seed 1", "seed 2"]
        shown = await press(pilot, "c", "l")
        assert shown.recipe.seed == playground(pilot).recipe.seed == 1
        assert "SEED = 1" in script_of(shown)
        await press(pilot, "r", "r")
        assert [lane.name for lane in snapshot(pilot).run_group.lanes] == ["seed 0", "seed 1", "seed 2"]


async def test_what_is_told_goes_to_the_lane_shown_only(make_app: MakeApp) -> None:
    """The first run's own value is a change in the second."""
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        for change in (SetParameter("alpha", 0.5), SetParameter("ties", "first")):
            await order(pilot, AddLane((change,)))
        assert [lane.name for lane in snapshot(pilot).run_group.lanes] == [
            "α 0.1, ties random",
            "α 0.5",
            "ties first",
        ]
        await press(pilot, "c", "l")
        playground(pilot).agent.set_parameter("alpha", 0.1)
        await settle(pilot)
        assert [lane.hyperparameters.alpha for lane in snapshot(pilot).run_group.lanes] == [0.1, 0.1, 0.1]
        await press(pilot, "c", "l", "a", "t")
        assert [lane.hyperparameters.ties for lane in snapshot(pilot).run_group.lanes] == ["random"] * 3
        await press(pilot, "c", "c", "up", "delete", "enter")  # the one before the visible run
        shown = snapshot(pilot)
        assert (len(shown.run_group.lanes), shown.run_group.shown) == (2, 1)
        await press(pilot, "c", "l")
        assert snapshot(pilot).run_group.shown == 0


async def test_four_lanes_fit_every_screen(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (60, 18)) as pilot:
        for value in ("0.2", "0.5", "0.9"):
            await order(pilot, AddLane((SetParameter("alpha", float(value)),)))
        await train(pilot, 3_000)
        for size in ((60, 18), (80, 24), (120, 40)):
            await pilot.resize_terminal(*size)
            await settle(pilot)
            text = curve_text(pilot)
            named = sum(f"α {value}" in text for value in ("0.1", "0.2", "0.5", "0.9"))
            if size == (60, 18):
                assert all(f"{number} " in text for number in range(1, 5)), "one row has room for numbers"
                assert "no room for two" in playground(pilot).lanes.why_not("one_lane")
            else:
                assert named == 4  # one name per row
            await press(pilot, "c", "c")
            assert pilot.app.screen.query_one("#box").size.height <= size[1]
            await press(pilot, "escape")
