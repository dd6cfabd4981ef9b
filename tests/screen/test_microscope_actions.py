"""The keys of the microscope."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen, order, playground, press, scroll_down, snapshot, train
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.commands import GoTo, StepBack
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.board.board import Board
from rl_tui.screen.kit.row import MICROSCOPE, TABLE, WORLD
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.screen.panels.microscope.update import RETURN_HEADING


def board(pilot: Pilot[UserError]) -> Board:
    return playground(pilot).board


def lines(pilot: Pilot[UserError]) -> str:
    widget = board(pilot).microscope
    rows = Microscope(widget.look)
    rows.pair = widget.pair
    return "\n".join(row.text.rstrip() for row in rows.picture(widget.snapshot, widget.size.width, 60))


def top(pilot: Pilot[UserError]) -> str:
    return board(pilot).microscope.render_line(0).text


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_d_opens_and_closes_it_and_keys_and_wheel_scroll_it(
    make_app: MakeApp, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), size) as pilot:
        await press(pilot, "s", "d")
        widget = board(pilot).microscope
        assert board(pilot).shows(MICROSCOPE)
        assert board(pilot).shows(WORLD)
        assert not board(pilot).shows(TABLE)
        assert widget.has_focus
        assert "Q(0," in lines(pilot)
        if size == (80, 24):  # longer than its panel
            assert "The step" in top(pilot)
            await press(pilot, "down")
            assert "state" in top(pilot)
            await press(pilot, "end")
            assert RETURN_HEADING not in top(pilot)
            last = top(pilot)
            await press(pilot, "pagedown")
            assert top(pilot) == last
            await press(pilot, "home")
            assert "The step" in top(pilot)
            await scroll_down(pilot, widget)
            assert "The step" not in top(pilot)
        await press(pilot, "d")
        assert not board(pilot).shows(MICROSCOPE)
        assert board(pilot).shows(TABLE)
        assert not widget.has_focus
        assert widget.pair is None


async def test_it_is_drawn_from_every_step_and_an_earlier_one_is_told_as_it_was_then(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await press(pilot, "d")
        assert lines(pilot).strip() == "no step yet: s takes one"
        told = []
        for step in range(1, 5):
            await press(pilot, "s")
            told.append(lines(pilot))
            assert f" The step  {step}, step {step} of episode 1" in told[-1]
        for before in reversed(told[:-1]):
            await order(pilot, StepBack())
            assert lines(pilot) == before
        await order(pilot, GoTo(4))
        await train(pilot, 5_000)
        assert "5,004, step" in lines(pilot)
        shown = await press(pilot, "s")
        assert board(pilot).table.sources == lit_sources(shown)
        await press(pilot, "d")
        assert not board(pilot).table.sources


async def test_the_cursor_of_the_world_chooses_the_state(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (160, 50)) as pilot:
        await train(pilot, 2_000)
        await press(pilot, "d")
        shown = snapshot(pilot)
        last = shown.counters.last_step
        assert last is not None
        assert board(pilot).microscope.pair == last.updated_pair
        world = board(pilot).world
        assert world is not None
        world.focus()
        space, q = shown.world.space, shown.agent.q
        for state in (0, 14):
            world.put_cursor(state)
            await settle(pilot)
            pairs = space.pairs_of(state)
            greedy = pairs.start + int(q[pairs.start : pairs.stop].argmax())
            expected = last.updated_pair if last.updated_pair in pairs else greedy
            assert board(pilot).microscope.pair == expected
        world.put_cursor(last.state)
        await settle(pilot)
        assert board(pilot).microscope.pair == last.updated_pair
        widget = board(pilot).microscope
        assert any("History of Q(" in widget.render_line(y).text for y in range(widget.size.height))
        await press(pilot, "up", "full_stop")
        assert board(pilot).microscope.pair == last.updated_pair


async def test_a_pair_chosen_in_the_table_stays_chosen(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await train(pilot, 50)
        board(pilot).table.focus()
        await press(pilot, "home", "end", "d")
        assert board(pilot).microscope.pair == 4
        assert "Q(Pass,sleep)" in lines(pilot)
        world = board(pilot).world
        assert world is not None
        world.focus()
        await settle(pilot)
        assert board(pilot).microscope.pair == 4
        world.put_cursor(0)
        await settle(pilot)
        assert board(pilot).microscope.pair in snapshot(pilot).world.space.pairs_of(0)
        await press(pilot, "full_stop")
        assert board(pilot).microscope.pair == 4
        await press(pilot, "1")
        assert isinstance(pilot.app.focused, Slider)


async def test_the_history_is_that_of_the_run_and_it_says_how_to_choose_a_cell(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "s", "d")
        assert "tab: another cell" in board(pilot).microscope.footing
        for _ in range(5):
            shown = await press(pilot, "s")
            assert shown.cell.pair == shown.counters.last_step.updated_pair == board(pilot).microscope.pair
            assert shown.cell.step.tolist() == list(range(shown.counters.step + 1))
            assert shown.cell.value[-2:].tolist() == [
                shown.counters.last_step.before,
                shown.counters.last_step.after,
            ]
        await press(pilot, "r", "r")
        await settle(pilot)  # without a step it requests no cell
        assert snapshot(pilot).cell is None
        assert board(pilot).microscope.pair is None
        await press(pilot, "d")
        assert snapshot(pilot).cell is None


async def test_another_world_forgets_the_cell(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-random"), (120, 40)) as pilot:
        await train(pilot, 200)
        await press(pilot, "d")
        board(pilot).table.focus()
        await press(pilot, "end", "r", "s", "7", "enter")
        assert snapshot(pilot).recipe.seed == 7
        assert board(pilot).microscope.pair is None
        await press(pilot, "s")
        assert snapshot(pilot).cell is not None
