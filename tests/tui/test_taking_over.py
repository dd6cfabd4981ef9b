"""A person in place of the agent, with real keys."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import MakeApp
from seams import notes, on_screen, order, playground, press, switch
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import Command, RunEpisode, Step, Take, Train
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.row import MICROSCOPE, WORLD
from rl_tui.tui.panels.status_line import StatusLine
from rl_tui.tui.screens.help import HelpScreen
from rl_tui.tui.screens.key_line import KeyLine
from rl_tui.tui.screens.playground.playground import Playground

LEFT, DOWN, RIGHT, UP = range(4)


def record(pilot: Pilot[UserError], monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    """Keep all that is asked for in a list; what a person takes does not reach the player."""
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


@pytest.mark.parametrize("focused", ["nothing", "alpha", "table", "world", "curve"])
async def test_arrows_and_digits_act_whatever_is_in_focus(
    focused: str, make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        if focused != "nothing":
            pilot.app.screen.query_one(f"#{focused}").focus()
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "right", "down", "1", "4")
        assert asked == [Take(RIGHT), Take(DOWN), Take(UP), Take(LEFT)]  # digits count the actions as shown
        board = playground(pilot).board
        assert board.table.cursor_pair is None
        assert board.world.cursor is None
        assert pilot.app.screen.query_one("#alpha", Slider).value == 0.1


async def test_the_mode_is_seen_and_y_ends_it(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40), notifications=True) as pilot:
        world = playground(pilot).board.world
        before = (str(world.border_title), str(world.border_subtitle), bottom_line(pilot))
        await press(pilot, "y")
        assert str(world.border_title) == "You are the agent"
        assert str(world.border_subtitle) == "1 study  2 check phone · y: hand back"
        assert bottom_line(pilot) == "1 or 2 act  y hand back  s agent's step  space run  ? help"
        assert world.has_class("-manual")
        assert "◉ you act" in playground(pilot).query_one(StatusLine).render_line(0).text
        assert notes(pilot.app) == ["you are the agent: act with 1 or 2; y hands back"]
        await press(pilot, "y")
        assert (str(world.border_title), str(world.border_subtitle), bottom_line(pilot)) == before
        assert not world.has_class("-manual")
        assert "paused" in playground(pilot).query_one(StatusLine).render_line(0).text
        assert notes(pilot.app)[-1] == "the agent acts again"


async def test_escape_hands_back_and_stays_here(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "y", "question_mark")
        assert isinstance(pilot.app.screen, HelpScreen)
        await press(pilot, "escape")
        assert playground(pilot).manual.is_on
        await press(pilot, "escape")
        assert not playground(pilot).manual.is_on
        assert isinstance(pilot.app.screen, Playground)


async def test_without_the_mode_the_keys_do_what_they_did(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "y", "2", "right")
        assert pilot.app.focused is pilot.app.screen.query_one("#gamma")
        assert not any(isinstance(command, Take) for command in asked)


async def test_space_and_e_hand_back_and_s_does_not(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student")) as pilot:
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "s")
        assert asked == [Step()]
        assert playground(pilot).manual.is_on
        await press(pilot, "e")
        assert asked[1:] == [RunEpisode()]
        assert not playground(pilot).manual.is_on
        for key in ("space", "r"):
            await press(pilot, "y")
            assert playground(pilot).manual.is_on
            await press(pilot, key)
            assert not playground(pilot).manual.is_on


async def test_keys_without_an_action_say_so(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "3")
        assert notes(pilot.app)[-1] == "3 is no action here: act with 1 or 2"
        await press(pilot, "2")
        assert asked == [Take(1)]


async def test_an_arm_is_pulled_by_its_name(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(make_app("bandit"), notifications=True) as pilot:
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "7", "0")
        assert asked == [Take(7), Take(0)]
        await order(pilot, Train(1000))
        assert not playground(pilot).manual.is_on
        assert notes(pilot.app)[-1] == "the budget is spent; r starts again"


async def test_a_planner_takes_no_actions(make_app: MakeApp) -> None:
    app = make_app("frozenlake")
    async with on_screen(app, notifications=True) as pilot:
        screen = playground(pilot)
        await switch(pilot, "value-iteration")
        await press(pilot, "y")
        assert not screen.manual.is_on
        assert notes(app) == ["Value iteration takes no actions: it plans with the model; a chooses an agent"]


async def test_pulls_and_cards_by_hand(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit")) as pilot:
        pulled = await press(pilot, "y", "7", "7", "0")
        assert pulled.agent.visits.tolist() == [1, 0, 0, 0, 0, 0, 0, 2, 0, 0]
    async with on_screen(make_app("blackjack")) as pilot:
        dealt = await press(pilot, "y", "1")
        assert (dealt.counters.last_step.by_hand, dealt.counters.last_step.terminated) == (
            True,
            True,
        )  # stick
        assert dealt.counters.step_from not in (None, dealt.counters.state)
        world = playground(pilot).board.world
        hand = dealt.world.space.state_names[dealt.counters.step_from or 0]
        assert str(world.border_title) == f"You act · starts at {hand}"
        played = await press(pilot, "1")
        assert played.counters.episodes == 2
        assert played.counters.last_step.state == dealt.counters.step_from


@pytest.mark.parametrize("plain", [False, True])
async def test_the_keys_of_the_mode_fit_into_the_narrowest_screen(plain: bool, make_app: MakeApp) -> None:
    async with on_screen(make_app("windy-king", ascii=plain), (60, 18)) as pilot:
        await press(pilot, "y")
        dots = "..." if plain else "…"
        assert bottom_line(pilot) == f"arrows or 1{dots}8 act  y hand back  s agent's step  ? help"


@pytest.mark.parametrize(("size", "beside"), [((80, 24), False), ((120, 40), True)])
async def test_the_world_is_in_view_beside_the_microscope_or_in_its_place(
    size: tuple[int, int], beside: bool, make_app: MakeApp
) -> None:
    async with on_screen(make_app("frozenlake"), size) as pilot:
        await press(pilot, "s", "d", "f", "y")
        board = playground(pilot).board
        assert board.zoomed is None
        assert board.shows(WORLD)
        assert (board.opened == MICROSCOPE) is beside
        assert (await press(pilot, "down")).counters.step == 2


async def test_the_key_line_is_drawn_again_only_where_its_keys_change(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        await press(pilot, "y")
        line = playground(pilot).query_one(KeyLine)
        drawn: list[object] = []
        monkeypatch.setattr(line, "refresh", lambda *regions, **options: drawn.append(regions))
        await press(pilot, "down", "down")
        assert not drawn
        await press(pilot, "y")
        assert drawn
