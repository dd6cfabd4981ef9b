"""A screen as SVG after given keys, with the same bytes each time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from textual.keys import Keys
from textual.pilot import Pilot
from textual.widgets import Input

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Train
from rl_tui.live.player import Player
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.opening import Start
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.catalogue.lessons import LessonsScreen
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.playground.playground import Playground

_WAIT: Final = "wait:"
_SWIFT: Final = 1000.0
_MOST_LAYOUTS: Final = 10
_KNOWN: Final = {key.value for key in Keys} | {key for action in ACTIONS for key in action.keys}
_NAMES: Final = {
    " ": "space",
    "+": "plus",
    "-": "minus",
    "?": "question_mark",
    "[": "left_square_bracket",
    "]": "right_square_bracket",
    "esc": "escape",
}


async def screenshot(
    start: Start, size: tuple[int, int], keys: Sequence[str] = (), display: Display | None = None
) -> str:
    """Return the SVG of the first screen of the app after ``keys``.

    Steps pass only by keys and waits, and the speed is left blank.

    Args:
        start: Start of the app.
        size: Columns and rows.
        keys: Characters, Textual names of keys, or ``wait:N`` for N steps of training.
        display: Options of the display.

    Raises:
        UserError: A key is unknown, or the scenario cannot be played.
    """
    presses = [_press(key) for key in keys]
    options = replace(display or Display(), fps=_SWIFT)
    app = RlTuiApp(options, start, make_player=partial(Player, automatic=False), picture=True)
    async with app.run_test(size=size, notifications=True) as pilot:
        await settle(pilot)
        for press in presses:
            await _do(press, pilot)
            await settle(pilot)
        if app.return_value is not None:
            raise app.return_value
        _stop_blinking(app)
        await pilot.pause()
        return app.export_screenshot(title="rl-tui", simplify=True)


async def settle(pilot: Pilot[UserError]) -> None:
    """Wait until everything asked for is done and drawn."""
    for _ in range(_MOST_LAYOUTS):
        await pilot.pause()
        sent = _commands_sent(pilot)
        for screen in list(pilot.app.screen_stack):  # another playground may replace one meanwhile
            if isinstance(screen, Playground | CatalogueScreen | LessonsScreen):
                await screen.settled()
        await pilot.pause()
        # a late layout brings new cells into view, and some pictures ask for missing data
        if _commands_sent(pilot) == sent and all(each.board.is_complete for each in sent):
            return


def _commands_sent(pilot: Pilot[UserError]) -> dict[Playground, int]:
    return {each: each.link.sent for each in pilot.app.screen_stack if isinstance(each, Playground)}


def _stop_blinking(app: RlTuiApp) -> None:
    for entry in app.screen.query(Input):
        entry.cursor_blink = False


def _press(key: str) -> str | int:
    key = key.strip() or key
    if not key.startswith(_WAIT):
        return _key_name(key)
    steps = key.removeprefix(_WAIT)
    if not (steps.isascii() and steps.isdigit()):
        raise UserError(f"key {key!r} is unknown; expected wait:N, where N is a number of steps")
    return int(steps)


def _key_name(key: str) -> str:
    key = _NAMES.get(key, key)
    if len(key) == 1 or key in _KNOWN or key.startswith(("ctrl+", "shift+", "alt+")):
        return key
    raise UserError(f"key {key!r} is not known; expected one character, a name such as space, or wait:N")


async def _do(press: str | int, pilot: Pilot[UserError]) -> None:
    if isinstance(press, str):
        await pilot.press(press)
        return
    for screen in pilot.app.screen_stack:
        if isinstance(screen, Playground):
            screen.send(Train(press))
