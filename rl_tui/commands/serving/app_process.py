"""One app process for one browser tab, connected by pipes.

Data goes in packets: a letter, the length in four bytes (big-endian), and the content. D is terminal data, M
a JSON message, P a file (never used here). The app first writes a marker line, to separate earlier output
(Textual's web driver, ``textual/drivers/web_driver.py``).
"""

from __future__ import annotations

import asyncio
import json
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import suppress
from typing import Final

from rl_tui.common.kiosk import VARIABLE
from rl_tui.common.limits import LARGEST_SCREEN
from rl_tui.screen.terminal.driver_choice import IN_BROWSER

SMALLEST_SIZE: Final = (1, 1)
_READY: Final = b"__GANGLION__\n"
_LARGEST_PACKET: Final = 1 << 24
_KEPT_OF_STDERR: Final = 4_000
_TO_END_BY_ITSELF: Final = 3.0  # seconds
TO_END_WHEN_TOLD: Final = 8.0  # longer than the app's own emergency exit
_TO_SAY_WHY: Final = 1.0
# These variables describe the server's terminal, not the browser
_OF_THE_TERMINAL: Final = frozenset(
    {
        *("NO_COLOR", "COLUMNS", "LINES", "TMUX", "STY", "TERM_PROGRAM", "TERM_PROGRAM_VERSION"),
        *("VTE_VERSION", "WT_SESSION", "SSH_CONNECTION", "SSH_CLIENT", "SSH_TTY"),
    }
)


def environment_of_app(around: Mapping[str, str], size: tuple[int, int], *, kiosk: bool) -> dict[str, str]:
    """Return the environment variables of an app, from those `around` it."""
    kept = {
        name: value
        for name, value in around.items()
        if name not in _OF_THE_TERMINAL and not name.startswith("TEXTUAL") and name != VARIABLE
    }
    columns, rows = size
    return {
        **kept,
        **({VARIABLE: "1"} if kiosk else {}),
        "TEXTUAL_DRIVER": IN_BROWSER,
        "TERM": "xterm-256color",
        "COLORTERM": "truecolor",
        "PYTHONUTF8": "1",
        "COLUMNS": str(columns),
        "ROWS": str(rows),
    }


def bounded_size(columns: object, rows: object) -> tuple[int, int]:
    """Return a drawable size for the numbers of a browser; 80×24 if invalid."""
    if not (isinstance(columns, int) and isinstance(rows, int)):
        return (80, 24)
    width, height = (
        min(max(value, least), most)
        for value, least, most in zip((columns, rows), SMALLEST_SIZE, LARGEST_SCREEN, strict=True)
    )
    return width, height


class AppProcess:
    """The app of one tab, started without a shell in its own session."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        self._command = command
        self._environment = environment
        self._process: Process | None = None
        self._reading_errors: asyncio.Task[None] | None = None
        self._errors = b""
        self._has_left = False

    @property
    def fault(self) -> str:
        """The last line of stderr, or an empty text."""
        lines = self._errors.decode("utf-8", "replace").strip().splitlines()
        return "".join(letter for letter in lines[-1] if letter.isprintable()) if lines else ""

    async def start(self) -> None:
        """Start the process. Raises OSError if the system cannot."""
        self._process = await asyncio.create_subprocess_exec(
            *self._command,
            stdin=PIPE,
            stdout=PIPE,
            stderr=PIPE,
            env=dict(self._environment),
            start_new_session=True,  # the server handles ctrl+c of its terminal
        )
        self._reading_errors = asyncio.create_task(self._read_errors())

    async def output(self) -> AsyncIterator[bytes]:
        """Yield terminal output until the app ends."""
        process = self._running()
        assert process.stdout is not None
        with suppress(asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            await process.stdout.readuntil(_READY)
            while True:
                kind = await process.stdout.readexactly(1)
                length = int.from_bytes(await process.stdout.readexactly(4), "big")
                if length > _LARGEST_PACKET:
                    return
                payload = await process.stdout.readexactly(length)
                if kind == b"D":
                    yield payload
                elif kind == b"M" and json.loads(payload).get("type") == "exit":
                    self._has_left = True
                    return

    async def type(self, text: str) -> None:
        """Send terminal input: keys, mouse, answers to queries."""
        await self._send(b"D", text.encode("utf-8", "replace"))

    async def tell(self, **message: object) -> None:
        """Send a message: `type` is resize (with width and height), focus or blur."""
        await self._send(b"M", json.dumps(message).encode())

    async def stop(self) -> None:
        """End the app. It may save first, but is gone when this returns."""
        process = self._process
        if process is None:
            return
        reading = asyncio.create_task(self._read_to_the_end())  # an app blocked by a full pipe cannot end
        try:
            if not (self._has_left and await _ends(process, _TO_END_BY_ITSELF)):
                self.terminate()
                await _ends(process, TO_END_WHEN_TOLD)
        finally:
            self.kill()
            await process.wait()
            reading.cancel()
            if self._reading_errors is not None:
                await asyncio.wait([self._reading_errors], timeout=_TO_SAY_WHY)
                self._reading_errors.cancel()

    def terminate(self) -> None:
        """Ask the app to end."""
        with suppress(ProcessLookupError):
            if self._process is not None and self._process.returncode is None:
                self._process.terminate()

    def kill(self) -> None:
        """End the app immediately."""
        with suppress(ProcessLookupError):
            if self._process is not None and self._process.returncode is None:
                self._process.kill()

    def _running(self) -> Process:
        assert self._process is not None, "start comes first"
        return self._process

    async def _send(self, kind: bytes, payload: bytes) -> None:
        stdin = self._running().stdin
        assert stdin is not None
        with suppress(ConnectionError, RuntimeError):  # the app has ended; reading its output shows that
            stdin.write(kind + len(payload).to_bytes(4, "big") + payload)
            await stdin.drain()

    async def _read_errors(self) -> None:
        stderr = self._running().stderr
        assert stderr is not None
        while data := await stderr.read(4096):
            self._errors = (self._errors + data)[-_KEPT_OF_STDERR:]

    async def _read_to_the_end(self) -> None:
        stdout = self._running().stdout
        assert stdout is not None
        while await stdout.read(1 << 16):
            pass


async def _ends(process: Process, seconds: float) -> bool:
    with suppress(TimeoutError):
        await asyncio.wait_for(process.wait(), seconds)
    return process.returncode is not None


def command_line(python: str, arguments: Sequence[str]) -> tuple[str, ...]:
    """Return a command that starts rl-tui.

    ``-P`` keeps Python from importing modules of the current folder.
    """
    return (python, "-P", "-m", "rl_tui", *arguments)
