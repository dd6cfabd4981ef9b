"""The microscope on the real screen, with real keys."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen, order, playground, press, scroll_down, snapshot, train
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import StepBack
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.tui.panels.microscope.return_text import RETURN_HEADING
from rl_tui.tui.panels.row import CONTROLS, CURVE, MICROSCOPE, TABLE, TIMELINE, WORLD
from rl_tui.tui.screens.playground.board import Board


def board(pilot: Pilot[UserError]) -> Board:
    return playground(pilot).board


def lines(pilot: Pilot[UserError]) -> str:
    """All that the microscope says, in however many rows."""
    widget = board(pilot).microscope
    rows = Microscope(widget.look)
    rows.pair = widget.pair
    return "\n".join(row.text.rstrip() for row in rows.picture(widget.snapshot, widget.size.width, 60))


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_d_opens_and_closes_it(make_app: MakeApp, size: tuple[int, int]) -> None:
    async with on_screen(make_app("frozenlake-slippery"), size) as pilot:
        await press(pilot, "s", "d")
        assert board(pilot).shows(MICROSCOPE)
        assert board(pilot).shows(TABLE)
        assert board(pilot).shows(WORLD) is (size == (120, 40))
        assert board(pilot).microscope.has_focus
        assert "Q(0," in lines(pilot)
        await press(pilot, "d")
        assert not board(pilot).shows(MICROSCOPE)
        assert board(pilot).shows(CURVE)
        assert not board(pilot).microscope.has_focus
        assert playground(pilot).board.microscope.pair is None


async def test_it_is_drawn_from_every_step(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await press(pilot, "d")
        assert lines(pilot).strip() == "no step yet: s takes one"
        await press(pilot, "s")
        assert " The step  1, episode 1" in lines(pilot)
        await train(pilot, 5_000)
        assert "5,001, episode" in lines(pilot)
        shown = await press(pilot, "s")
        assert board(pilot).table.sources == lit_sources(shown)
        await press(pilot, "d")
        assert not board(pilot).table.sources


async def test_it_scrolls_by_keys_and_wheel(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        await press(pilot, "s", "d")
        widget = board(pilot).microscope
        assert "The step" in widget.render_line(0).text
        await press(pilot, "down")
        assert "state" in widget.render_line(0).text
        await press(pilot, "end")
        assert RETURN_HEADING not in widget.render_line(0).text
        last = widget.render_line(0).text
        await press(pilot, "pagedown")
        assert widget.render_line(0).text == last
        await press(pilot, "home")
        assert "The step" in widget.render_line(0).text
        await scroll_down(pilot, widget)
        assert "The step" not in widget.render_line(0).text


async def test_the_tab_key_goes_to_panels_in_view_only(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "s", "d")
        seen = set()
        for _ in range(12):
            await press(pilot, "tab")
            seen.add(board(pilot).panel_of(pilot.app.focused))
        assert seen == {TABLE, TIMELINE, MICROSCOPE, CONTROLS}


async def test_a_slider_that_it_hides_closes_it(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "s", "d", "1")
        assert not board(pilot).opened
        assert isinstance(pilot.app.focused, Slider)


async def test_the_cursor_of_the_table_chooses_the_cell(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await train(pilot, 50)
        await press(pilot, "d")
        shown = snapshot(pilot)
        assert board(pilot).microscope.pair == shown.counters.last_step.updated_pair
        board(pilot).table.focus()
        await press(pilot, "home", "end")
        assert board(pilot).microscope.pair == 4
        assert "History of Q(Pass,sleep)" in lines(pilot)
        await press(pilot, "full_stop")
        assert board(pilot).microscope.pair == shown.counters.last_step.updated_pair


async def test_the_history_is_that_of_the_run(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "s", "d")
        for _ in range(5):
            shown = await press(pilot, "s")
            assert shown.cell.pair == shown.counters.last_step.updated_pair == board(pilot).microscope.pair
            assert shown.cell.step.tolist() == list(range(shown.counters.step + 1))
            assert shown.cell.value[-2:].tolist() == [
                shown.counters.last_step.before,
                shown.counters.last_step.after,
            ]
        await press(pilot, "r")
        await settle(pilot)  # once it is drawn that there is no step, no cell is asked for
        assert snapshot(pilot).cell is None
        assert board(pilot).microscope.pair is None
        await press(pilot, "d")
        assert snapshot(pilot).cell is None


async def test_an_earlier_step_is_told_as_it_was_told_then(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await press(pilot, "d")
        told = []
        for _ in range(4):
            await press(pilot, "s")
            told.append(lines(pilot))
        for before in reversed(told[:-1]):
            await order(pilot, StepBack())
            assert lines(pilot) == before


@pytest.mark.parametrize("scenario", ["frozenlake-random"])
async def test_another_world_forgets_the_cell(make_app: MakeApp, scenario: str) -> None:
    async with on_screen(make_app(scenario), (120, 40)) as pilot:
        await train(pilot, 200)
        await press(pilot, "d")
        board(pilot).table.focus()
        await press(pilot, "end", "n", "7", "enter")
        assert snapshot(pilot).recipe.seed == 7
        assert board(pilot).microscope.pair is None
        await press(pilot, "s")
        assert snapshot(pilot).cell is not None
