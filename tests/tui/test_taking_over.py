"""A person in place of the agent, with real keys."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import MakeApp
from seams import notes, playground, press, switch
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import Command, GoTo, RunEpisode, Step, Take, Train
from rl_tui.lab.live.snapshot import Phase
from rl_tui.lab.run.recipe import JournalEntry, TakeAction
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.row import LAST_STEP, MICROSCOPE, WORLD
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
    app = make_app("frozenlake")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        if focused != "nothing":
            app.screen.query_one(f"#{focused}").focus()
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "right", "down", "1", "4")
        assert asked == [Take(RIGHT), Take(DOWN), Take(UP), Take(LEFT)]  # digits count the actions as shown
        board = playground(pilot).board
        assert board.table.cursor_pair is None
        assert board.world is not None
        assert board.world.cursor is None
        assert app.screen.query_one("#alpha", Slider).value == 0.1


async def test_the_mode_is_seen_and_y_ends_it(make_app: MakeApp) -> None:
    app = make_app("student")
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await settle(pilot)
        world = playground(pilot).board.world
        assert world is not None
        before = (str(world.border_title), str(world.border_subtitle), bottom_line(pilot))
        await press(pilot, "y")
        assert str(world.border_title) == "You are the agent"
        assert str(world.border_subtitle) == "1 study  2 check phone · y: hand back"
        assert bottom_line(pilot) == "1 or 2 act  y hand back  s agent's step  space run  ? help"
        assert world.has_class("-manual")
        assert "◉ you act" in playground(pilot).query_one(StatusLine).render_line(0).text
        assert notes(app) == ["you are the agent: act with 1 or 2; y hands back"]
        await press(pilot, "y")
        assert (str(world.border_title), str(world.border_subtitle), bottom_line(pilot)) == before
        assert not world.has_class("-manual")
        assert "paused" in playground(pilot).query_one(StatusLine).render_line(0).text
        assert notes(app)[-1] == "the agent acts again"


async def test_escape_hands_back_and_stays_here(make_app: MakeApp) -> None:
    app = make_app("student")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await press(pilot, "y", "question_mark")
        assert isinstance(app.screen, HelpScreen)
        await press(pilot, "escape")
        assert playground(pilot).manual.is_on
        await press(pilot, "escape")
        assert not playground(pilot).manual.is_on
        assert isinstance(app.screen, Playground)


async def test_without_the_mode_the_keys_do_what_they_did(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("frozenlake")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "y", "2", "right")
        assert app.focused is app.screen.query_one("#gamma")
        assert not any(isinstance(command, Take) for command in asked)


async def test_space_and_e_hand_back_and_s_does_not(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("student")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
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
    app = make_app("student")
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        await settle(pilot)
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "3")
        assert notes(app)[-1] == "3 is no action here: act with 1 or 2"
        await press(pilot, "2")
        assert asked == [Take(1)]


async def test_an_arm_is_pulled_by_its_name(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    app = make_app("bandit")
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        await settle(pilot)
        asked = record(pilot, monkeypatch)
        await press(pilot, "y", "7", "0")
        assert asked == [Take(7), Take(0)]
        playground(pilot).send(Train(1000))
        await settle(pilot)
        assert not playground(pilot).manual.is_on
        assert notes(app)[-1] == "the budget is spent; r starts again"


async def test_a_planner_takes_no_actions(make_app: MakeApp) -> None:
    app = make_app("frozenlake")
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        await settle(pilot)
        screen = playground(pilot)
        await switch(pilot, "value-iteration")
        await press(pilot, "y")
        assert not screen.manual.is_on
        assert notes(app) == ["Value iteration takes no actions: it plans with the model; a chooses an agent"]


async def test_a_walk_to_the_goal_is_learned_from(make_app: MakeApp) -> None:
    app = make_app("frozenlake")
    async with app.run_test(size=(120, 40)) as pilot:
        await settle(pilot)
        at_goal = await press(pilot, "y", "down", "down", "right", "down", "right", "right")
        space = at_goal.world.space
        assert (
            at_goal.counters.state,
            at_goal.counters.step,
            at_goal.counters.episodes,
            at_goal.playback.phase,
        ) == (15, 6, 1, Phase.PAUSED)
        walked = [(0, DOWN), (4, DOWN), (8, RIGHT), (9, DOWN), (13, RIGHT), (14, RIGHT)]
        pairs = [space.pairs_of(state).start + action for state, action in walked]
        assert sorted(at_goal.agent.visits.nonzero()[0].tolist()) == sorted(pairs)
        assert at_goal.agent.q[pairs[-1]] == pytest.approx(0.1)
        assert at_goal.timeline.current.journal == tuple(
            JournalEntry(step, TakeAction(space.action_names[action]))
            for step, (_, action) in enumerate(walked)
        )
        last_step = playground(pilot).board.panel(LAST_STEP)
        text = "\n".join(last_step.render_line(y).text for y in range(last_step.size.height))
        assert "you chose it" in text
        world = playground(pilot).board.world
        assert world is not None
        assert str(world.border_title) == "You are the agent · starts at 0"
        again = await press(pilot, "right")
        assert (again.counters.state, again.counters.episode_step) == (1, 1)
        assert str(world.border_title) == "You are the agent"


async def test_the_agent_and_a_person_take_turns(make_app: MakeApp) -> None:
    async with make_app("student").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        mine = await press(pilot, "y", "2")
        assert mine.counters.last_step is not None
        assert (mine.counters.last_step.pair, mine.counters.last_step.by_hand, mine.counters.state) == (
            1,
            True,
            1,
        )
        theirs = await press(pilot, "s")
        assert theirs.counters.last_step is not None
        assert not theirs.counters.last_step.by_hand
        assert playground(pilot).manual.is_on
        assert theirs.counters.step == 2
        done = await press(pilot, "e")
        assert (done.counters.episodes, playground(pilot).manual.is_on) == (1, False)


async def test_pulls_and_cards_by_hand(make_app: MakeApp) -> None:
    async with make_app("bandit").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        pulled = await press(pilot, "y", "7", "7", "0")
        assert pulled.agent.visits.tolist() == [1, 0, 0, 0, 0, 0, 0, 2, 0, 0]
    async with make_app("blackjack").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        dealt = await press(pilot, "y", "1")
        assert dealt.counters.last_step is not None
        assert (dealt.counters.last_step.by_hand, dealt.counters.last_step.terminated) == (
            True,
            True,
        )  # stick
        assert dealt.counters.step_from not in (None, dealt.counters.state)
        world = playground(pilot).board.world
        assert world is not None
        hand = dealt.world.space.state_names[dealt.counters.step_from or 0]
        assert str(world.border_title) == f"You act · starts at {hand}"
        played = await press(pilot, "1")
        assert played.counters.episodes == 2
        assert played.counters.last_step is not None
        assert played.counters.last_step.state == dealt.counters.step_from


async def test_a_step_by_hand_in_the_past_begins_a_branch(make_app: MakeApp) -> None:
    async with make_app("frozenlake").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        playground(pilot).send(Train(50))
        playground(pilot).send(GoTo(step=20))
        await settle(pilot)
        forked = await press(pilot, "y", "left")
        assert forked.counters.step == 21
        assert len(forked.timeline.branches) == 2
        assert forked.counters.last_step is not None
        assert forked.counters.last_step.by_hand


@pytest.mark.parametrize("plain", [False, True])
async def test_the_keys_of_the_mode_fit_into_the_narrowest_screen(plain: bool, make_app: MakeApp) -> None:
    async with make_app("windy-king", ascii=plain).run_test(size=(60, 18)) as pilot:
        await settle(pilot)
        await press(pilot, "y")
        dots = "..." if plain else "…"
        assert bottom_line(pilot) == f"arrows or 1{dots}8 act  y hand back  s agent's step  ? help"


@pytest.mark.parametrize(("size", "beside"), [((80, 24), False), ((120, 40), True)])
async def test_the_world_is_in_view_beside_the_microscope_or_in_its_place(
    size: tuple[int, int], beside: bool, make_app: MakeApp
) -> None:
    async with make_app("frozenlake").run_test(size=size) as pilot:
        await settle(pilot)
        await press(pilot, "s", "d", "f", "y")
        board = playground(pilot).board
        assert board.zoomed is None
        assert board.shows(WORLD)
        assert (board.opened == MICROSCOPE) is beside
        assert (await press(pilot, "down")).counters.step == 2


async def test_the_key_line_is_drawn_again_only_where_its_keys_change(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with make_app("frozenlake").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await press(pilot, "y")
        line = playground(pilot).query_one(KeyLine)
        drawn: list[object] = []
        monkeypatch.setattr(line, "refresh", lambda *regions, **options: drawn.append(regions))
        await press(pilot, "down", "down")
        assert not drawn
        await press(pilot, "y")
        assert drawn
