from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from functools import partial
from typing import Any
from weakref import WeakKeyDictionary

import pytest
from textual._context import active_app, visible_screen_stack
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet
from textual.pilot import Pilot
from textual.screen import Compositor

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
    """Let a pilot wait for the effects of its keys, not until the process seems idle (1/25 s per key)."""
    resize = Pilot.resize_terminal

    async def resize_and_arrange(pilot: Pilot[Any], width: int, height: int) -> None:
        await resize(pilot, width, height)
        while pilot.app.screen.outer_size != (width, height):
            await pilot.pause()
        await _arranged(pilot)

    with pytest.MonkeyPatch.context() as patch:
        for module in ("app", "pilot"):
            patch.setattr(f"textual.{module}.wait_for_idle", all_done)
        patch.setattr(Pilot, resize.__name__, resize_and_arrange)
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
        patch.setattr(Stylesheet, parse.__name__, parse_once)
        yield


@pytest.fixture(autouse=True)
def _frames_wait_for_a_look(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw only when a test looks, and at the end of each app: no terminal takes the other frames.

    ``--all`` draws all of them, as ``real_frames`` does, so that an error in any frame is seen.
    """
    draw, look = Compositor.render_update, Compositor.render_strips
    beneath = WeakKeyDictionary[Compositor, Any]()  # the screens that show through

    def later(self: Compositor, full: bool = False, screen_stack: Any = None, simplify: bool = False) -> Any:
        if full:
            return draw(self, full, screen_stack, simplify)
        beneath[self] = screen_stack
        self._dirty_regions.clear()
        return None

    def now(self: Compositor, size: Any = None) -> Any:
        visible_screen_stack.set(beneath.get(self) or [])
        return look(self, size)

    if not request.config.option.all and "real_frames" not in request.fixturenames:
        monkeypatch.setattr(Compositor, draw.__name__, later)
        monkeypatch.setattr(Compositor, look.__name__, now)


@pytest.fixture
def real_frames() -> None:
    """Draw every frame, as for people."""


@pytest.fixture
def make_app() -> MakeApp:
    """Make an app that takes steps only on request: of a scenario, or the start screen."""

    def make(scenario: str | None = None, *, seed: int = 0, **display: object) -> RlTuiApp:
        recipe = recipe_for(find(scenario), {}, seed) if scenario else None
        options = Display(**{"fps": 1000.0, **display})
        app = RlTuiApp(options, recipe, make_player=partial(Player, automatic=False), picture=True)
        app.NOTIFICATION_TIMEOUT = 3600.0  # while a loop is compiled, messages stay
        return app

    return make


@pytest.fixture
def is_typed(monkeypatch: pytest.MonkeyPatch) -> asyncio.Event:
    event, snapshots = asyncio.Event(), Player.snapshots

    async def late(player: Player) -> AsyncIterator[Snapshot]:
        await event.wait()
        async for each in snapshots(player):
            yield each

    monkeypatch.setattr(Player, "snapshots", late)
    return event
