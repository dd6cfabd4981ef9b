"""A person in place of the agent."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import MakeApp
from seams import notes, on_screen, order, playground, press, switch
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Command, RunEpisode, Step, Take, Train
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.key_sheet import KeySheet
from rl_tui.screen.kit.row import MICROSCOPE, WORLD
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.playground.playground import Playground

LEFT, DOWN, RIGHT, UP = range(4)


def record(pilot: Pilot[UserError], monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    asked: list[Command] = []
    player = playground(pilot).player
    send: Callable[[Command], None] = player.send

    def sorted_out(command: Command) -> None:
        asked.append(command)
        if not isinstance(command, Take):
            send(command)

    monkeypatch.setattr(player, "send", sorted_out)
    return asked


def bottom_line(pilot: Pilot[UserError]) -> str:
    return playground(pilot).query_one(KeyLine).render_line(0).text.strip()


async def test_arrows_and_digits_act(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        screen, board = pilot.app.screen, playground(pilot).board
        asked = record(pilot, monkeypatch)
        for focused in (None, "alpha", "table", "world", "curve"):
            asked.clear()
            screen.set_focus(None if focused is None else screen.query_one(f"#{focused}"))
            await press(pilot, "y", "right", "down", "1", "4")
            took = [Take(RIGHT), Take(DOWN), Take(UP), Take(LEFT)]  # digits count the actions in screen order
            assert asked == took, focused
            assert board.table.cursor_pair is None, focused
            assert board.world.cursor is None, focused
            assert screen.query_one("#alpha", Slider).value == 0.1, focused
            await press(pilot, "y")
        screen.set_focus(None)
        await press(pilot, "2", "right")  # without the mode
        assert pilot.app.focused is screen.query_one("#gamma")
        assert not any(isinstance(command, Take) for command in asked[4:])


async def test_the_mode_is_seen_and_y_or_escape_ends_it(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40), notifications=True) as pilot:
        world = playground(pilot).board.world
        before = (world.head, world.foot, bottom_line(pilot))
        await press(pilot, "y")
        assert world.head == "You are the agent"
        assert bottom_line(pilot) == "1 or 2 act  y hand back  s agent's step  space run  ? keys"
        assert world.has_class("-manual")
        assert "◉ you act" in playground(pilot).query_one(StatusLine).render_line(0).text
        assert notes(pilot.app) == ["You act, with 1 or 2. y: stop."]
        await press(pilot, "y")
        assert (world.head, world.foot, bottom_line(pilot)) == before
        assert not world.has_class("-manual")
        assert "paused" in playground(pilot).query_one(StatusLine).render_line(0).text
        assert notes(pilot.app)[-1] == "The agent acts again."
        await press(pilot, "y", "question_mark")
        assert isinstance(pilot.app.screen, KeySheet)
        await press(pilot, "escape")
        assert playground(pilot).manual.is_on
        await press(pilot, "escape")
        assert not playground(pilot).manual.is_on
        assert isinstance(pilot.app.screen, Playground)


async def test_space_and_e_hand_back(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "3")
        assert notes(pilot.app)[-1] == "3 is not an action here: act with 1 or 2"
        await press(pilot, "2", "s")
        assert asked == [Take(1), Step()]
        assert playground(pilot).manual.is_on
        await press(pilot, "e")
        assert asked[2:] == [RunEpisode()]
        assert not playground(pilot).manual.is_on
        for keys in (["space"], ["r", "r"]):
            await press(pilot, "y")
            assert playground(pilot).manual.is_on
            await press(pilot, *keys)
            assert not playground(pilot).manual.is_on
        await switch(pilot, "value-iteration")
        await press(pilot, "y")
        assert not playground(pilot).manual.is_on
        (said,) = notes(pilot.app)
        assert said == "Value iteration takes no actions: it plans. a a: choose an agent."


async def test_arms_are_pulled_by_their_names_until_the_budget_is_spent(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), notifications=True) as pilot:
        pulled = await press(pilot, "y", "7", "7", "0")
        assert pulled.agent.visits.tolist() == [1, 0, 0, 0, 0, 0, 0, 2, 0, 0]
        await order(pilot, Train(1000))
        assert not playground(pilot).manual.is_on
        assert notes(pilot.app)[-1] == "The budget is spent. r r: start again."


async def test_cards_by_hand(make_app: MakeApp) -> None:
    async with on_screen(make_app("blackjack")) as pilot:
        dealt = await press(pilot, "y", "1")
        stick = dealt.counters.last_step
        assert (stick.by_hand, stick.terminated) == (True, True)
        assert dealt.counters.step_from not in (None, dealt.counters.state)
        world = playground(pilot).board.world
        hand = dealt.world.space.state_names[dealt.counters.step_from or 0]
        assert world.head == f"You are the agent · starts at {hand}"
        played = await press(pilot, "1")
        assert played.counters.episodes == 2
        assert played.counters.last_step.state == dealt.counters.step_from


@pytest.mark.exhaustive("other characters", but=["False"])
@pytest.mark.parametrize("plain", [False, True])
async def test_the_keys_of_the_mode_fit_into_the_narrowest_screen(plain: bool, make_app: MakeApp) -> None:
    async with on_screen(make_app("windy-king", ascii=plain), (60, 18)) as pilot:
        await press(pilot, "y")
        dots = "..." if plain else "…"
        assert bottom_line(pilot) == f"arrows or 1{dots}8 act  y hand back  s agent's step  ? keys"


@pytest.mark.exhaustive("plays at another size", but=["size0-False", "size1-True"])
@pytest.mark.parametrize(("size", "beside"), [((60, 18), False), ((80, 24), True), ((120, 40), True)])
async def test_the_world_is_in_view(size: tuple[int, int], beside: bool, make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), size) as pilot:
        await press(pilot, "s", "d", "f", "y")
        board = playground(pilot).board
        assert board.zoomed is None
        assert board.shows(WORLD)
        assert (board.opened == MICROSCOPE) is beside
        assert (await press(pilot, "down")).counters.step == 2


async def test_the_key_line_is_kept(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        await press(pilot, "y")
        line = playground(pilot).query_one(KeyLine)
        drawn: list[object] = []
        monkeypatch.setattr(line, "refresh", lambda *regions, **options: drawn.append(regions))
        await press(pilot, "down", "down")
        assert not drawn
        await press(pilot, "y")
        assert drawn
