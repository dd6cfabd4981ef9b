from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from functools import partial
from typing import Any

import pytest
from textual._context import active_app
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet
from textual.pilot import Pilot

from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.worlds.files.catalogue import find

MakeApp = Callable[..., RlTuiApp]


@pytest.fixture(autouse=True)
def _no_scenarios(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    monkeypatch.setattr(
        "rl_tui.worlds.files.catalogue.user_folder", lambda: tmp_path_factory.getbasetemp() / "no-scenarios"
    )


async def all_done(*_: float) -> None:
    """Wait until all earlier keys and commands are done."""
    for _turn in range(3):  # of the loop, until the app has the driver's messages
        await asyncio.sleep(0)
    app = active_app.get()
    await _reached(app.call_later)
    if isinstance(app, RlTuiApp):
        await app.typed()


async def _reached(call: Callable[[Callable[[], None]], bool]) -> None:
    done = asyncio.Event()
    if call(done.set):
        await done.wait()


async def _arranged(pilot: Pilot[Any]) -> None:
    """Wait until the screen and its panels are arranged, and no new arrangement is pending."""
    arranged = pilot.app.screen.screen_layout_refresh_signal
    layouts = 0

    def note(_: object) -> None:
        nonlocal layouts
        layouts += 1

    arranged.subscribe(pilot.app, note, immediate=True)
    quiet = 0
    while quiet < 4:
        before = layouts
        await pilot.pause()
        quiet = quiet + 1 if layouts == before and not pilot.app._batch_count else 0
    arranged.unsubscribe(pilot.app)


@pytest.fixture(autouse=True, scope="session")
def _keys_are_done_when_they_are() -> Iterator[None]:
    """Let a pilot wait for the effects of its keys, not until the process seems idle.

    The wait for idleness takes 1/25 of a second per key, and is too short on a busy machine.
    """
    resize = Pilot.resize_terminal

    async def resize_and_arrange(pilot: Pilot[Any], width: int, height: int) -> None:
        await resize(pilot, width, height)
        while pilot.app.screen.outer_size != (width, height):
            await pilot.pause()
        await _arranged(pilot)

    with pytest.MonkeyPatch.context() as patch:
        for module in ("app", "pilot"):
            patch.setattr(f"textual.{module}.wait_for_idle", all_done)
        patch.setattr(Pilot, "resize_terminal", resize_and_arrange)
        yield


@pytest.fixture(autouse=True, scope="session")
def _styles_parsed_once() -> Iterator[None]:
    """Share the parsed style rules between apps. Each would parse them two or three times."""
    known: dict[Any, list[RuleSet]] = {}
    parse = Stylesheet._parse_rules

    def parse_once(self: Stylesheet, css: str, read_from: Any, *more: Any, **named: Any) -> list[RuleSet]:
        variables = frozenset(self._variables.items())
        key = variables, css, read_from, more, frozenset(named.items())
        if key not in known:
            known[key] = parse(self, css, read_from, *more, **named)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stylesheet, "_parse_rules", parse_once)
        yield


@pytest.fixture
def make_app() -> MakeApp:
    """Make an app that takes steps only on request: the playground of a scenario, or the start screen."""

    def make(scenario: str | None = None, *, seed: int = 0, **display: object) -> RlTuiApp:
        recipe = recipe_for(find(scenario), {}, seed) if scenario else None
        options = Display(**{"fps": 1000.0, **display})
        app = RlTuiApp(options, recipe, make_player=partial(Player, automatic=False), picture=True)
        app.NOTIFICATION_TIMEOUT = 3600.0  # while a loop is compiled, messages stay
        return app

    return make


@pytest.fixture
def is_typed(monkeypatch: pytest.MonkeyPatch) -> asyncio.Event:
    """Set this event to let a player publish snapshots. Until then no world is on screen."""
    event, snapshots = asyncio.Event(), Player.snapshots

    async def late(player: Player) -> AsyncIterator[Snapshot]:
        await event.wait()
        async for each in snapshots(player):
            yield each

    monkeypatch.setattr(Player, "snapshots", late)
    return event
