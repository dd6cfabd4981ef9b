"""A screen after a script of keys, as a picture or recording, with the same bytes each time."""

from __future__ import annotations

import json
import re
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from typing import Final

from rich.color import ColorSystem
from textual.keys import Keys
from textual.pilot import Pilot
from textual.timer import Timer
from textual.widgets import Input

from rl_tui.common.errors import UserError
from rl_tui.live.commands import ChooseBranch, ChooseLane, Command, GoTo, LetPass, Play, SetSpeed, Train
from rl_tui.live.player import Player
from rl_tui.live.sessions.replay import ReplayTarget
from rl_tui.live.snapshot import Phase
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.opening import Start
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.catalogue.lessons import LessonsScreen
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.playground.actions.run import LADDER
from rl_tui.screen.playground.playground import Playground
from rl_tui.screen.terminal.encoder import Encoder
from rl_tui.screen.terminal.pens import Pens
from rl_tui.screen.terminal.screen_buffer import Cutter, ScreenBuffer

# The script


Script = Sequence[str | Command | int]
"""Keys by Textual's names, commands to the run, and sixtieths of a second that pass."""
SECOND: Final = 60
"""The parts of a second that scripts count."""
_LONGEST: Final = 600.0  # seconds of one item
_REPLAY: Final = 30.0  # seconds at most
_SHOWN: Final = 48  # sixtieths of a second that a key is shown: longer than any motion
_WAIT: Final = "wait:"
_EXPECTED: Final = "one character, a name such as space, wait:N, or seconds such as 2s"
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


def script_of(keys: Sequence[str]) -> Script:
    """Read ``keys``: characters, Textual's names of keys, ``wait:N`` (steps of training), ``2s`` (seconds).

    Raises:
        UserError: A key is not known.
    """
    return [_item(key.strip() or key) for key in keys]


def _item(key: str) -> str | Command | int:
    if key.startswith(_WAIT):
        steps = key.removeprefix(_WAIT)
        if not (steps.isascii() and steps.isdigit()):
            raise UserError(f"key {key!r} is unknown; expected wait:N, where N is a number of steps")
        return Train(int(steps))
    if re.fullmatch(r"[0-9]{1,6}(\.[0-9]{1,6})?s", key):
        seconds = float(key[:-1])
        if seconds > _LONGEST:
            raise UserError(f"{key} is too long; expected {_LONGEST:g}s at most")
        return round(seconds * SECOND)
    return _key_name(key)


def _key_name(key: str) -> str:
    key = _NAMES.get(key, key)
    if len(key) == 1 or key in _KNOWN or key.startswith(("ctrl+", "shift+", "alt+")):
        return key
    raise UserError(f"key {key!r} is not known; expected {_EXPECTED}")


def script_of_replay(target: ReplayTarget) -> Script:
    """Script the way through a session to ``target``."""
    steps = target.branch.here
    known = (each for each in LADDER if each is not None and steps <= each * _REPLAY)
    speed = next(known, steps / _REPLAY)
    branch = target.lane.branches.index(target.branch)
    begin = (0, ChooseLane(target.number), 0, ChooseBranch(branch), 0, GoTo(step=0), SECOND)
    return (*begin, SetSpeed(speed), 0, Play(), int(steps / speed * SECOND), GoTo(step=steps), 3 * SECOND)


# The app


_SWIFT: Final = 1000.0  # frames per second: nothing waits for the next one
_NEARLY: Final = 1e-6


class ScriptedTimer(Timer):
    """A timer that a script drives, in sixtieths of a second."""

    def __init__(
        self, app: ScriptedApp, seconds: float, call: Callable[[], object], *, repeats: bool
    ) -> None:
        super().__init__(app, seconds)
        self.call = call
        self.due = app.passed + seconds * SECOND
        self.period = seconds * SECOND if repeats else 0.0
        self.is_over = False

    def stop(self) -> None:
        """Stop the timer."""
        self.is_over = True


class ScriptedApp(RlTuiApp):
    """An app whose script lets time pass. ``ticks``: frames per second of a moving picture, or 0."""

    def __init__(self, display: Display, start: Start, *, ticks: float = 0.0) -> None:
        options = replace(display, fps=_SWIFT)
        super().__init__(options, start, make_player=partial(Player, automatic=False), picture=True)
        self.ticks = ticks
        self.passed = 0
        """Sixtieths of a second since the start."""
        self.frame_ticks = max(1, round(SECOND / display.fps))
        """Sixtieths of a second between two frames."""
        self._scripted = list[ScriptedTimer]()

    def start_timer(self, seconds: float, callback: Callable[[], object], *, repeats: bool) -> Timer:
        """Call back after, or every, ``seconds`` of the script."""
        timer = ScriptedTimer(self, seconds, callback, repeats=repeats)
        self._scripted.append(timer)
        return timer

    def let_pass(self, ticks: int) -> bool:
        """Let ``ticks`` pass, returning whether timers were due."""
        self.passed += ticks
        due = [each for each in self._scripted if not each.is_over and each.due <= self.passed + _NEARLY]
        for timer in due:
            timer.due += timer.period
            timer.is_over = not timer.period
            self.call_later(timer.call)
        self._scripted = [each for each in self._scripted if not each.is_over]
        return bool(due)


# Pictures


_MOST_LAYOUTS: Final = 10


async def screenshot(
    start: Start, size: tuple[int, int], keys: Sequence[str] = (), display: Display | None = None
) -> str:
    """Return the SVG of the screen after ``keys``, without the speed.

    Steps pass only by keys, waits and seconds.

    Args:
        start: Start of the app.
        size: Columns and rows.
        keys: As :func:`script_of` reads them.
        display: Options of the display.

    Raises:
        UserError: A key is unknown, or the scenario cannot be played.
    """
    script = script_of(keys)
    app = ScriptedApp(display or Display(), start)
    async with performed(app, size, script):
        return app.export_screenshot(title="rl-tui", simplify=True)


# Recordings


_BEGIN: Final = "\x1b[?7l\x1b[?25l\x1b[2J"  # no line wrapping, no cursor, an empty screen
_FIRST_BYTES: Final = 25_000
_MOVING_BYTES: Final = 70_000  # or, above 30 seconds, as many for every 30
_HURRY: Final = 1.6  # from one frame to the next, times the bytes of a second on average


class Cast:
    """An asciicast (version 2) of ``app`` for ``seconds``: the changed cells of each frame.

    30 seconds take 100 kB: while a screen moves, frames are left out after large or many changes. Shorter
    recordings have more frames a second.
    """

    def __init__(self, app: ScriptedApp, size: tuple[int, int], seconds: float) -> None:
        self._app = app
        self._rate = _MOVING_BYTES / min(max(seconds, 1.0), 30.0)
        pens, cutter = Pens(ColorSystem.TRUECOLOR), Cutter()
        self._buffer, self._encoder = ScreenBuffer(pens, cutter), Encoder(pens, cutter)
        self._buffer.resize(*size)
        self._bytes = 0
        self._next = 0.0  # the time of the next frame of a moving screen
        self._lines: list[str] = []
        self._write_line({"version": 2, "width": size[0], "height": size[1], "title": "rl-tui"})
        self._write(_BEGIN)

    def show(self, *, moves: bool) -> None:
        """Write the changes, which may be left out if the screen ``moves``."""
        time, before = self._app.passed / SECOND, self._bytes
        if moves and (time < self._next or before > _FIRST_BYTES + self._rate * time):
            return
        self._app.put_on(self._buffer)
        if text := self._encoder.frame(self._buffer.changed()):
            self._write(text)
            self._next = time + (self._bytes - before) / (_HURRY * self._rate)

    def text(self) -> str:
        """Return the recording, with the last screen."""
        self.show(moves=False)
        self._write("")  # so that this screen is shown as long as the script says
        return "".join(self._lines)

    def _write(self, text: str) -> None:
        self._write_line([round(self._app.passed / SECOND, 3), "o", text])

    def _write_line(self, line: object) -> None:
        text = f"{json.dumps(line, ensure_ascii=False, separators=(',', ':'))}\n"
        self._bytes += len(text.encode())
        self._lines.append(text)


async def record(start: Start, size: tuple[int, int], script: Script, display: Display | None = None) -> str:
    """Return a recording of the app in the time of ``script``.

    Args:
        start: Start of the app.
        size: Columns and rows.
        script: What is done.
        display: Options of the display, with the frames per second.

    Raises:
        UserError: The scenario cannot be played.
    """
    display = display or Display()
    app = ScriptedApp(display, start, ticks=display.ticks)
    cast = Cast(app, size, length_of(script) / SECOND)
    async with performed(app, size, script, cast.show):
        return cast.text()


# The performance


Show = Callable[..., None]
"""Shows the screen, which ``moves`` or has changed by a key."""


@asynccontextmanager
async def performed(
    app: ScriptedApp, size: tuple[int, int], script: Script, show: Show = lambda moves: None
) -> AsyncIterator[None]:
    """Run ``app`` through ``script``, to be at its end in the context. Call ``show`` for possible changes.

    A key, and the first screen, are shown for a moment, or as long as the next item says. The run takes steps
    only while seconds of the script pass.

    Raises:
        UserError: An error ended the app.
    """
    async with app.run_test(size=size, notifications=True) as pilot:
        for item, following in zip_longest((None, *script), script):
            if isinstance(item, int):
                await _let_pass(item, app, pilot, show)
                continue
            await _do(item, pilot)
            await settle(pilot)
            if app.return_value is not None:
                raise app.return_value
            _stop_blinking(app)
            await pilot.pause()
            if following != 0:
                show(moves=False)
            if not isinstance(following, int):
                await _let_pass(_SHOWN, app, pilot, show, is_still=True)
        yield


def length_of(script: Script) -> int:
    """Return the length in sixtieths of a second."""
    pairs = zip_longest((None, *script), script)
    return sum(
        item if isinstance(item, int) else 0 if isinstance(following, int) else _SHOWN
        for item, following in pairs
    )


async def _do(item: str | Command | None, pilot: Pilot[UserError]) -> None:
    if isinstance(item, str):
        await pilot.press(item)
    elif item is not None:
        for screen in _playgrounds(pilot):
            screen.send(item)


async def _let_pass(
    ticks: int,
    app: ScriptedApp,
    pilot: Pilot[UserError],
    show: Show,
    *,
    is_still: bool = False,
) -> None:
    for before in range(0, ticks, app.frame_ticks):
        frame = min(app.frame_ticks, ticks - before)
        running = [] if is_still else [each for each in _playgrounds(pilot) if _is_running(each)]
        for screen in running:
            screen.send(LetPass(frame))
        if app.let_pass(frame) or running:
            await settle(pilot, 0.0)
            show(moves=True)


async def settle(pilot: Pilot[UserError], pause: float | None = None) -> None:
    """Wait until everything is done and drawn, and for ``pause`` or until nothing happens."""
    for _ in range(_MOST_LAYOUTS):
        await pilot.pause(pause)
        sent = _commands_sent(pilot)
        for screen in list(pilot.app.screen_stack):  # another playground may replace one meanwhile
            if isinstance(screen, Playground | CatalogueScreen | LessonsScreen):
                await screen.settled()
        await pilot.pause(pause)
        # a late layout brings new cells into view, and some pictures ask for missing data
        if _commands_sent(pilot) == sent and all(each.board.is_complete for each in sent):
            return


def _playgrounds(pilot: Pilot[UserError]) -> list[Playground]:
    return [each for each in pilot.app.screen_stack if isinstance(each, Playground)]


def _is_running(screen: Playground) -> bool:
    return screen.snapshot is not None and screen.snapshot.playback.phase is Phase.RUNNING


def _commands_sent(pilot: Pilot[UserError]) -> dict[Playground, int]:
    return {each: each.wanted.sent for each in _playgrounds(pilot)}


def _stop_blinking(app: ScriptedApp) -> None:
    for entry in app.screen.query(Input):
        entry.cursor_blink = False
