"""Run until and breakpoints with real keys."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import MakeApp
from seams import click, notes, on_screen, order, playground, press, screen_text, snapshot, switch
from textual.pilot import Pilot
from textual.widgets import Input, OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.live.commands import ClearBreakpoints, Command, RunUntil, ToggleBreakpoint, Train
from rl_tui.live.pace.until import Event, Until
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.dialogs.until_options import UntilChoice
from rl_tui.screen.playground.actions.until import NO_BREAKPOINTS, ON_ARMS
from rl_tui.screen.playground.playground import Playground

ASKED = (RunUntil, ToggleBreakpoint, ClearBreakpoints)


def record(pilot: Pilot[UserError], monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    asked: list[Command] = []
    player = playground(pilot).player
    send: Callable[[Command], None] = player.send

    def sorted_out(command: Command) -> None:
        if isinstance(command, ASKED):
            asked.append(command)
        else:
            send(command)

    monkeypatch.setattr(player, "send", sorted_out)
    return asked


async def test_u_runs_until_what_is_chosen_and_remembers_it(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("frozenlake")
    async with on_screen(app) as pilot:
        asked = record(pilot, monkeypatch)
        await press(pilot, "u", "enter")
        assert asked == [RunUntil(Until(Event.REWARD))]
        await press(pilot, "u", "down", "down", "enter")
        assert asked[1:] == [RunUntil(Until(Event.POLICY_CHANGE))]
        await press(pilot, "u")
        assert app.screen.query_one(OptionList).highlighted_option.id == "policy"
        await press(pilot, "escape")
        assert isinstance(app.screen, Playground)
        assert len(asked) == 2
        await press(pilot, "u", "down", "down", "down", "enter")
        assert isinstance(app.screen, Prompt)
        await press(pilot, *"500", "enter")
        assert asked[2:] == [RunUntil(Until(Event.STEP, number=500))]
        await press(pilot, "u", "down", "enter")
        app.screen.query_one(Input).value = "1"
        await press(pilot, "enter")
        assert "Type a whole number, 2 or more" in str(app.screen.query_one(".error").render())
        await press(pilot, "escape")
        assert len(asked) == 3
        playground(pilot).board.table.focus()
        await press(pilot, "down", "right", "u", "home", *["down"] * 7, "enter", *"0.5", "enter")
        assert asked[3:] == [RunUntil(Until(Event.VALUE, pair=6, threshold=0.5))]


def rows(pilot: Pilot[UserError]) -> list[str]:
    return [str(option.prompt) for option in pilot.app.screen.query_one(OptionList).options]


async def test_k_stops_where_the_cursor_is(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("frozenlake"), notifications=True) as pilot:
        asked = record(pilot, monkeypatch)
        board = playground(pilot).board
        await press(pilot, "t", "b")  # nothing in focus: the agent's place
        board.table.focus()
        await press(pilot, "t", "b", "down", "right", "t", "b")
        assert notes(pilot.app) == ["breakpoint on 1,→: pauses each time it is taken"]
        board.world.focus()
        await press(pilot, "t", "b", "down", "right", "t", "b")
        assert asked == [
            ToggleBreakpoint(state=0),
            ToggleBreakpoint(pair=3),
            ToggleBreakpoint(pair=6),
            ToggleBreakpoint(state=0),
            ToggleBreakpoint(state=5),
        ]
        assert notes(pilot.app)[-1] == "breakpoint on state 5: pauses each time it is reached"


async def test_a_wall_is_no_place_to_stop_at(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("taxi"), (120, 40), notifications=True) as pilot:
        asked = record(pilot, monkeypatch)
        world = playground(pilot).board.world
        world.focus()
        world.put_cursor(5)  # the line of wall between the first two towns
        await press(pilot, "t", "b")
        assert not asked
        assert "there is no state here to stop at" in screen_text(pilot.app)


async def test_the_cursor_of_one_panel_shows_in_the_other(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        board = playground(pilot).board
        world, table = board.world, board.table
        world.focus()
        await settle(pilot)
        assert world.foot == "arrows: cursor · t b: breakpoint · ?: words"
        await press(pilot, "down", "right", "down", "right")
        assert world.cursor == 10
        assert world.foot == "state 10 · t b: breakpoint · esc: back"
        assert table.pointed == playground(pilot).snapshot.world.space.pairs_of(10)  # type: ignore[union-attr]
        await press(pilot, "tab")
        assert not table.pointed
        assert world.shown_cursor is None
        await press(pilot, "down")
        assert world.shown_cursor == 1
        await press(pilot, "escape")
        assert world.shown_cursor is None
        assert table.cursor_pair is None
        await press(pilot, "shift+tab", "escape")  # a second escape would leave the screen
        assert world.cursor is None
        assert isinstance(pilot.app.screen, Playground)
        await click(pilot, world, offset=(1, 1))
        assert world.cursor == 0


async def test_a_breakpoint_set_in_the_world_stops_the_run_and_is_taken_away(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        marked = await press(pilot, "tab", "down", "down", "right", "t", "b")
        assert marked.playback.breakpoints.states == {9}
        stopped = await press(pilot, "u", *["down"] * 5, "enter", *"99999", "enter")
        assert stopped.counters.state == 9
        assert stopped.counters.step < 99_999
        assert stopped.playback.paused_by == "breakpoint: state 9"
        assert stopped.playback.breakpoints.states == {9}
        assert not (await press(pilot, "t", "b")).playback.breakpoints
        assert (await press(pilot, "u", "enter", *"5000", "enter")).counters.step == 5000


async def test_breakpoints_of_the_table_are_set_and_cleared(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        assert (await press(pilot, "tab", "right", "t", "b")).playback.breakpoints.states == {2}
        assert notes(pilot.app) == ["breakpoint on state Pass: pauses each time it is reached"]
        marked = await press(pilot, "t", "n", "tab", "down", "down", "t", "b", "up", "t", "b")
        assert marked.playback.breakpoints.pairs == {1, 2}
        assert not (await press(pilot, "t", "n")).playback.breakpoints
        assert notes(pilot.app)[-1] == "All breakpoints are cleared."


async def test_a_bandit_runs_until_an_arm_is_pulled_or_the_best_is_greedy(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), notifications=True) as pilot:
        await press(pilot, "t", "b")
        assert ON_ARMS in screen_text(pilot.app)
        await press(pilot, "escape", "t", "n")
        assert NO_BREAKPOINTS in screen_text(pilot.app)
        await press(pilot, "escape", "tab", *["down"] * 7)
        world = playground(pilot).board.world
        assert world.foot == "arm 7 · t b: breakpoint · esc: back"
        marked = await press(pilot, "t", "b")
        assert notes(pilot.app) == ["breakpoint on arm 7: pauses each time it is pulled"]
        assert marked.playback.breakpoints.pairs == {7}
        stopped = await press(pilot, "u", *["down"] * 4, "enter", "enter")
        assert stopped.counters.last_step.pair == 7
        assert stopped.agent.visits[7] == 1
        assert stopped.playback.paused_by == "breakpoint: arm 7"
        cleared = await press(pilot, "t", "n", "u", "up", "up", "enter")
        best = int(cleared.world.mdp.reward.argmax())
        assert int(cleared.agent.q.argmax()) == best
        assert cleared.playback.paused_by == "the greedy arm is the best"
        assert cleared.counters.step < 1000
        await order(pilot, Train(1000))
        await press(pilot, "u")
        assert isinstance(pilot.app.screen, Playground)


async def test_a_stepped_world_stops_at_states_and_values_and_what_it_cannot_wait_for_says_why(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("blackjack")) as pilot:
        await press(pilot, "s")
        table = playground(pilot).board.table
        table.focus()
        pair = table.shown_cursor
        assert pair is not None
        await press(pilot, "t", "b", "u", "down", "down", "down")
        about = str(pilot.app.screen.query_one("#about", Static).render())
        assert about.startswith("Not here: no exact values")
        await press(pilot, "enter")
        assert isinstance(pilot.app.screen, UntilChoice)
        assert snapshot(pilot).counters.step == 1
        marked = await press(pilot, "down", "down", "enter", *"9999", "enter")
        assert marked.counters.last_step.pair == pair
        assert marked.counters.step < 9_999


async def test_breakpoints_are_listed_in_the_dialog_and_a_planner_stops_at_them(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        await press(pilot, "t", "b", "u")
        assert rows(pilot)[-2:] == ["Breakpoints", "9   state 0"]
        assert "5   breakpoint at state 0: on" in rows(pilot)
        await press(pilot, "up", "delete")
        await settle(pilot)  # the dialog stays open, and the key's effect happens beneath it
        cleared = await press(pilot)
        assert not cleared.playback.breakpoints
        assert rows(pilot)[-1] == "No breakpoints. t b sets one at the cursor."
        assert "breakpoint at state 0: off" in " ".join(rows(pilot))
        marked = await press(pilot, "5")  # a switch
        assert (await press(pilot)).playback.breakpoints.states == {0} == marked.playback.breakpoints.states
        await press(pilot, "5", "u")
        assert isinstance(pilot.app.screen, Playground)
        await switch(pilot, "value-iteration")
        swept = await press(pilot, "u", "down", "enter")
        assert swept.counters.episodes == 1
        world = playground(pilot).board.world
        world.focus()
        world.put_cursor(9)
        stopped = await press(pilot, "t", "b", "e")
        assert stopped.counters.last_step.state == 9
        assert stopped.counters.episodes == 1
