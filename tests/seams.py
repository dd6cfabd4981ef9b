"""Access to an app for tests, with all private names."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from typing import Any, TypeVar

from textual.app import App
from textual.events import MouseScrollDown
from textual.geometry import Size
from textual.pilot import Pilot
from textual.strip import Strip
from textual.widget import Widget
from textual.widgets import OptionList

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Command, Train
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.playground.playground import Playground

AnyWidget = TypeVar("AnyWidget", bound=Widget)


# Reading


def notes(app: App[Any]) -> list[str]:
    assert isinstance(app, RlTuiApp)
    return app.messages.texts


def screen_rows(app: App[Any]) -> list[Strip]:
    return app.screen._compositor.render_strips()


def screen_text(app: App[Any]) -> str:
    return "\n".join(strip.text for strip in screen_rows(app))


def playground(pilot: Pilot[Any]) -> Playground:
    return next(screen for screen in pilot.app.screen_stack if isinstance(screen, Playground))


def snapshot(pilot: Pilot[Any]) -> Snapshot:
    shown = playground(pilot).snapshot
    assert shown is not None
    return shown


def slider(app: App[Any], name: str) -> Slider:
    return app.screen.query_one(f"#{name}", Slider)


# Acting


def app_at(start: object = None, **options: Any) -> RlTuiApp:
    """An app that takes steps only on request."""
    app = RlTuiApp(
        Display(fps=1000.0), start, make_player=partial(Player, automatic=False), picture=True, **options
    )
    app.NOTIFICATION_TIMEOUT = 3600.0  # while a loop is compiled, messages stay
    return app


@asynccontextmanager
async def on_screen(
    app: App[Any], size: tuple[int, int] = (80, 24), **options: Any
) -> AsyncIterator[Pilot[Any]]:
    """The last screen is drawn, whether the test looks or not."""
    async with app.run_test(size=size, **options) as pilot:
        await settle(pilot)
        yield pilot
        if app.screen_stack:
            screen_text(app)


async def press(pilot: Pilot[UserError], *keys: str) -> Snapshot:
    """Press ``keys``, each after the previous one is done and drawn."""
    for key in keys:
        await pilot.press(key)
        await settle(pilot)
    return snapshot(pilot)


async def tap(pilot: Pilot[Any], *keys: str) -> None:
    """Press ``keys`` without a wait between them."""
    await pilot.press(*keys)
    await settle(pilot)


async def click(pilot: Pilot[Any], *where: Any, **offset: Any) -> None:
    await pilot.click(*where, **offset)
    await settle(pilot)


async def order(pilot: Pilot[Any], command: Command) -> None:
    playground(pilot).send(command)
    await settle(pilot)


async def choose(pilot: Pilot[UserError], id: str) -> None:  # noqa: A002
    choices = pilot.app.screen.query_one(OptionList)
    choices.highlighted = choices.get_option_index(id)
    await pilot.press("enter")
    await settle(pilot)


async def switch(pilot: Pilot[UserError], algorithm: str) -> None:
    pilot.app.set_focus(None)
    await press(pilot, "a", "a")
    await choose(pilot, algorithm)


async def train(pilot: Pilot[UserError], steps: int) -> Snapshot:
    playground(pilot).send(Train(steps))
    await settle(pilot)
    return snapshot(pilot)


async def scroll_down(pilot: Pilot[UserError], widget: Widget) -> None:
    x, y = widget.region.offset
    widget.post_message(MouseScrollDown(widget, 0, 0, 0, 0, 0, False, False, False, x, y))
    await settle(pilot)


def show(screen: Playground, snapshot: Snapshot) -> None:
    """Draw ``snapshot`` as if just published. Settling restores the player's own."""
    screen.player._newest = None
    screen._draw(snapshot)


def sized(widget: AnyWidget, width: int, height: int) -> AnyWidget:
    widget._size = Size(width, height)
    return widget
