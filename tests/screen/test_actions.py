"""The table of actions as a source."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import notes, on_screen, playground, press, snapshot, train
from textual.actions import parse

from rl_tui.screen.frame.key_line import fitting
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.playground.playground import Playground
from rl_tui.screen.theme.glyphs import ASCII, UNICODE, Glyphs

PLACES = [Place.CATALOGUE, Place.LESSONS, Place.PLAYGROUND]


def usual(place: Place) -> list[Action]:
    return [each for each in actions_of(place) if not each.of_lesson and not each.of_program]


def hints(width: int) -> list[str]:
    all_in_view = [each for each in usual(Place.PLAYGROUND) if each.id != "panels.turn"]
    shown, _ = fitting(all_in_view, width, UNICODE)
    return [" ".join(action.key_hint) for action in shown]


def line_width(width: int, glyphs: Glyphs) -> int:
    shown, gap = fitting(usual(Place.PLAYGROUND), width, glyphs)
    texts = [glyphs.spelled(" ".join(action.key_hint)) for action in shown]
    return 1 + sum(map(len, texts)) + gap * (len(shown) - 1)


@pytest.mark.parametrize("place", PLACES)
async def test_every_action_can_be_done_on_its_screen(make_app: MakeApp, place: Place) -> None:
    app = make_app("student" if place is Place.PLAYGROUND else None)
    async with on_screen(app) as pilot:
        if place is Place.LESSONS:
            await pilot.press("1")
        for action in actions_of(place):
            target, method, _ = parse(action.command or action.id)
            if target == "app":
                assert hasattr(app, f"action_{method}"), action.id
            elif target:
                assert callable(getattr(getattr(app.screen, target), method)), action.id
            else:
                assert hasattr(app.screen, f"action_{method}"), action.id


STEPPING = {"run.run_or_pause", "run.step", "run.episode", "run.watch", "until.choose"}
ALONE = {"lanes.show_runs", "lanes.next_lane", "lanes.one_lane", "lanes.end", "lanes.another_branch"}
AT_STEP_0 = {"time.step_back", "time.episode_back", "time.back"}
OF_MAPS = {"view.numbers", "view.turn_actions"}


@pytest.mark.parametrize(
    ("scenario", "steps", "refused", "possible"),
    [
        (
            "frozenlake",
            0,
            ALONE | AT_STEP_0 | {"run.evaluate", "until.clear_breakpoints"},
            STEPPING | OF_MAPS,
        ),
        ("bandit", 0, OF_MAPS | {"board.discount", "until.toggle_breakpoint"}, STEPPING),
        ("bandit", 1_000, STEPPING | {"manual.toggle"}, AT_STEP_0 | {"board.many_seeds"}),
        ("blackjack", 0, {"board.policies", "board.world_check", "scenario.map_settings"}, {"board.model"}),
    ],
)
async def test_what_cannot_be_done_says_why_in_a_clause_and_does_nothing(
    make_app: MakeApp, scenario: str, steps: int, refused: set[str], possible: set[str]
) -> None:
    async with on_screen(make_app(scenario), notifications=True) as pilot:
        await train(pilot, steps)
        screen = playground(pilot)
        reasons = {each.id: each.refused for each in screen.actions if each.refused}
        assert refused <= reasons.keys()
        assert not possible & reasons.keys()
        assert all(why == why.strip(" .") for why in reasons.values())
        for each in screen.actions:
            if each.id in refused and not each.unfocused:
                sent = screen.wanted.sent
                await pilot.app.run_action(each.textual_action, screen)
                await pilot.pause()
                assert notes(pilot.app)[-1].rstrip(".").lower() == each.refused.lower()
                assert (screen.wanted.sent, pilot.app.screen) == (sent, screen), each.id


def test_bindings_carry_id_description_and_tooltip() -> None:
    for binding in bindings_of(actions_of(Place.PLAYGROUND)):
        assert binding.id
        assert binding.description
        assert binding.tooltip


def test_the_key_line_drops_whole_entries_and_keeps_the_key_of_all_keys() -> None:
    least = ["space run", "s step", "e episode", "b back"]
    assert hints(60) == [*least, "v view", "? keys"]
    assert hints(80) == [*least, "v view", "a agent", "w world", "? keys"]
    more = ["+ − speed", "v view", "d microscope", "a agent", "w world", "t tools", "c compare"]
    assert hints(120) == [*least, *more, "? keys"]
    assert hints(136) == [*least, *more, "m more", "r again", "? keys"]
    assert hints(22) == ["space run", "? keys"]
    assert hints(1) == ["? keys"]


@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
def test_the_key_line_fits(glyphs: Glyphs) -> None:
    assert [width for width in range(7, 260) if line_width(width, glyphs) > width] == []


async def test_without_a_focus_arrows_go_through_time_and_into_the_world(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        for key, step in (("right", 1), ("right", 2), ("left", 1), ("end", 2), ("home", 0)):
            await press(pilot, key)
            assert snapshot(pilot).counters.step == step, key
        await press(pilot, "j")
        assert pilot.app.focused is playground(pilot).board.world
        before = playground(pilot).board.table.cursor_pair
        await press(pilot, "tab", "j")
        assert playground(pilot).board.table.cursor_pair != before
        here = snapshot(pilot).counters.step
        for panel in ("tp", "d", "tm"):
            await press(pilot, *panel, "right", "left", "right", "home", "end", "escape")
            assert snapshot(pilot).counters.step == here, "a panel has the focus"


async def test_one_stray_key_neither_quits_nor_leaves(make_app: MakeApp) -> None:
    app = make_app("student")
    async with on_screen(app) as pilot:
        await press(pilot, "s", "q", "escape", "v", "q")
        assert app.is_running
        assert isinstance(app.screen, Playground)
        await pilot.press("q")
        await pilot.pause()
        assert not app.is_running
