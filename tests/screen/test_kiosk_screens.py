"""The screens of a kiosk."""

from __future__ import annotations

import asyncio
from functools import partial

import pytest
from seams import app_at, notes, on_screen, tap
from textual.widgets import Static

from rl_tui.live.snapshot import Phase
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.app import PATIENCE, Idleness, RlTuiApp
from rl_tui.screen.app.find import entries_on
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.key_line import fitting
from rl_tui.screen.frame.menu_strip import MenuStrip
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.registry import ACTIONS, actions_of
from rl_tui.screen.playground.playground import Playground
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.worlds.files.catalogue import find

FOR_THE_OWNER = {"door_4", "new_world", "session.save", "export.choose", "delete_session", "suspend"}


def kiosk(scenario: str | None = None, place: Place | None = None) -> RlTuiApp:
    start = recipe_for(find(scenario)) if scenario else place
    return app_at(start, kiosk=True)


@pytest.mark.parametrize("place", [Place.CATALOGUE, Place.LESSONS, Place.PLAYGROUND])
def test_all_but_what_is_for_the_owner_is_offered(place: Place) -> None:
    usual, here = actions_of(place), actions_of(place | Place.KIOSK)
    assert [each for each in usual if each.id not in FOR_THE_OWNER] == list(here)
    assert {each.id for each in ACTIONS if each.for_the_owner} == FOR_THE_OWNER


@pytest.mark.parametrize("width", range(60, 240, 20))
def test_the_key_line_has_none_of_it(width: int) -> None:
    shown, _ = fitting(actions_of(Place.PLAYGROUND | Place.KIOSK), width, UNICODE)
    assert not {each.id for each in shown} & FOR_THE_OWNER


async def test_search_and_menu_offer_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    async with on_screen(kiosk("student")) as pilot:
        keys = {entry.keys for entry in entries_on(pilot.app.screen) if entry.kind == "action"}
        offered = actions_of(Place.PLAYGROUND | Place.KIOSK)
        assert keys < {each.shown for each in offered if not each.of_lesson}
        of_owner = (each for each in ACTIONS if each.for_the_owner and Place.PLAYGROUND in each.place)
        assert not keys & {each.shown for each in of_owner}
        await tap(pilot, "s", "m")
        assert isinstance(pilot.app.screen, MenuStrip)
        assert not {row.id for row in pilot.app.screen.menu.rows} & FOR_THE_OWNER
        await tap(pilot, "s", "x")
        assert isinstance(pilot.app.screen, MenuStrip), "no row has these letters"
        await tap(pilot, "escape", "escape")
        assert notes(pilot.app) == ["esc again: back to the start screen; this run is then gone."]
        stopped = []
        monkeypatch.setattr("os.kill", lambda *args: stopped.append(args))
        await pilot.app.run_action("suspend_process")
        assert stopped == []


@pytest.mark.parametrize("place", [None, Place.LESSONS])
async def test_the_lists_say_that_it_is_one(place: Place | None) -> None:
    async with on_screen(kiosk(place=place)) as pilot:
        assert str(pilot.app.screen.query_one("#title", Static).render()).endswith("kiosk")


async def test_the_catalogue_keeps_no_sessions() -> None:
    async with on_screen(kiosk()) as pilot:
        await tap(pilot, "delete")
        assert notes(pilot.app) == ["Not here: a kiosk keeps no sessions."]


def test_nobody_there_is_told_once() -> None:
    now = [0.0]
    idleness = Idleness(600.0, clock=lambda: now[0])
    now[0] = 599.0
    assert not idleness.begins()
    now[0] = 600.0
    assert [idleness.begins(), idleness.begins()] == [True, False]
    idleness.stir()
    assert not idleness.begins()
    now[0] = 1200.0
    assert idleness.begins()


async def test_a_run_that_was_forgotten_is_paused(monkeypatch: pytest.MonkeyPatch) -> None:
    now, looks = 0.0, 0

    def clock() -> float:
        nonlocal looks
        looks += 1
        return now

    async def look_again() -> None:
        before = looks
        async with asyncio.timeout(60):
            while looks < before + 2:
                await pilot.pause(0.01)
        await settle(pilot)

    monkeypatch.setattr("rl_tui.screen.app.app.LOOKS", 0.001)
    monkeypatch.setattr("rl_tui.screen.app.app.Idleness", partial(Idleness, clock=clock))
    app = kiosk("student")
    async with on_screen(app) as pilot:
        await tap(pilot, "space")
        playground = app.screen
        assert isinstance(playground, Playground)
        assert playground.snapshot.playback.phase is Phase.RUNNING
        await look_again()
        assert playground.snapshot.playback.phase is Phase.RUNNING, "somebody was there just now"
        now = PATIENCE
        async with asyncio.timeout(60):
            while playground.snapshot.playback.phase is not Phase.PAUSED:
                await pilot.pause(0.01)
        assert notes(pilot.app) == ["Paused: no key was pressed for several minutes."]
