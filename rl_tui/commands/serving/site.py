"""The web server: the page, and one app process per browser tab."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import socket
import sys
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from aiohttp import WSCloseCode, WSMsgType, web
from aiohttp.http_exceptions import HttpProcessingError

from rl_tui.commands.serving.addresses import Doorkeeper
from rl_tui.commands.serving.app_process import AppProcess, bounded_size, environment_of_app
from rl_tui.screen.terminal.ending import on_signals

# Responses and WebSocket


PAGE: Final = Path(str(files("rl_tui.commands.serving"))) / "page"
# 125 mouse moves, 30 key repeats and 60 frame answers per second stay below this
PER_SECOND: Final = 6_000.0  # characters
AT_ONCE: Final = 20_000.0
OF_A_MESSAGE: Final = 16  # cost of a message in addition to its characters
_LARGEST_MESSAGE: Final = 1 << 14  # bytes
_HEARTBEAT: Final = 15.0  # seconds; detects a browser that vanished
_CLOSING: Final = 2.0  # seconds for a browser to close the connection
_LONGEST_REASON: Final = 120  # size limit of the WebSocket close message, in bytes
_HEADERS: Final = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; font-src 'self';"
        " img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none';"
        " frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-cache",
    "Server": "rl-tui",
}
Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Allowance:
    """A rate limit for browser input, which delays floods but no normal typing.

    The budget grows by `per_second` up to `at_once`.
    """

    def __init__(self, per_second: float = PER_SECOND, at_once: float = AT_ONCE) -> None:
        self._per_second = per_second
        self._at_once = at_once
        self._left = at_once
        self._filled = asyncio.get_running_loop().time()

    async def spend(self, characters: int) -> None:
        """Wait until a message of this length may pass."""
        now = asyncio.get_running_loop().time()
        self._left = min(self._left + (now - self._filled) * self._per_second, self._at_once)
        self._filled = now
        self._left -= characters + OF_A_MESSAGE
        if self._left < 0:
            await asyncio.sleep(-self._left / self._per_second)


class Site:
    """The web application.

    Args:
        command: Command line that starts an app.
        doorkeeper: Check of request headers.
        terminal: Folder with the scripts of the browser terminal.
        kiosk: True if strangers may use the apps.
        most: Largest number of apps at the same time.
    """

    def __init__(
        self, command: Sequence[str], doorkeeper: Doorkeeper, terminal: Path, *, kiosk: bool, most: int
    ) -> None:
        self._command = command
        self._doorkeeper = doorkeeper
        self._terminal = terminal
        self._kiosk = kiosk
        self._most = most
        self._apps: set[AppProcess] = set()
        self._is_ending = False

    def application(self) -> web.Application:
        """Return the aiohttp application with all routes."""
        application = web.Application(middlewares=[self._only_for_us], client_max_size=_LARGEST_MESSAGE)
        application.add_routes(
            [
                web.get("/", self._page),
                web.get("/ws", self._terminal_of_a_tab),
                web.get("/ws/{ascii:ascii}", self._terminal_of_a_tab),  # fonts offer only this choice
                web.static("/page", PAGE),
                web.static("/static", self._terminal),
            ]
        )
        application.on_response_prepare.append(_add_headers)
        application.on_shutdown.append(self._end)
        return application

    @web.middleware
    async def _only_for_us(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        if not self._doorkeeper.knows(request.host):
            raise web.HTTPForbidden(
                text="This address is not the server's own. Behind a proxy,"
                " start it with rl-tui serve --url and the address that people type.\n"
            )
        return await handler(request)

    async def _page(self, request: web.Request) -> web.StreamResponse:
        if len(self._apps) < self._most:
            return web.FileResponse(PAGE / "index.html")
        text = (PAGE / "full.html").read_text(encoding="utf-8").replace("{most}", str(self._most))
        return web.Response(text=text, content_type="text/html", status=503, headers={"Retry-After": "10"})

    async def _terminal_of_a_tab(self, request: web.Request) -> web.StreamResponse:
        if not self._doorkeeper.lets_in(request.headers.get("Origin", ""), request.host):
            raise web.HTTPForbidden(text="Only the page of this server may use it.\n")
        websocket = web.WebSocketResponse(
            heartbeat=_HEARTBEAT, max_msg_size=_LARGEST_MESSAGE, timeout=_CLOSING
        )
        await websocket.prepare(request)
        if len(self._apps) >= self._most or self._is_ending:
            reason = "Every place is taken: try again in a moment."
            await websocket.close(code=WSCloseCode.TRY_AGAIN_LATER, message=_reason(reason))
            return websocket
        size = bounded_size(_number(request, "width"), _number(request, "height"))
        command = [*self._command, *(["--ascii"] if "ascii" in request.match_info else [])]
        app = AppProcess(command, environment_of_app(os.environ, size, kiosk=self._kiosk))
        self._apps.add(app)
        try:
            await self._connect(app, websocket)
        finally:
            await app.stop()
            self._apps.discard(app)
        return websocket

    async def _connect(self, app: AppProcess, websocket: web.WebSocketResponse) -> None:
        # Until one of both leaves; the browser gets the reason
        try:
            await app.start()
        except OSError as fault:
            await websocket.close(message=_reason(f"rl-tui could not be started: {fault.strerror}"))
            return
        both = [asyncio.create_task(_show(app, websocket)), asyncio.create_task(_listen(app, websocket))]
        try:
            await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in both:
                task.cancel()
            await asyncio.wait(both)
        await app.stop()  # the reason is complete only after the app has ended
        if app.fault:
            print(app.fault, file=sys.stderr, flush=True)
        reason = "The server was stopped." if self._is_ending else app.fault or "You left rl-tui."
        with suppress(ConnectionError):
            await websocket.close(message=_reason(reason))

    async def _end(self, application: web.Application) -> None:
        self._is_ending = True
        for app in self._apps:
            app.terminate()


async def _add_headers(request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(_HEADERS)


async def _show(app: AppProcess, websocket: web.WebSocketResponse) -> None:
    with suppress(ConnectionError):  # the browser left; _listen notices that
        async for data in app.output():
            await websocket.send_bytes(data)


async def _listen(app: AppProcess, websocket: web.WebSocketResponse) -> None:
    allowance = Allowance()
    async for message in websocket:
        if message.type is not WSMsgType.TEXT:
            return
        await allowance.spend(len(message.data))
        match _parsed(message.data):
            case ["stdin", str(text)]:
                await app.type(text)
            case ["resize", {"width": columns, "height": rows}]:
                width, height = bounded_size(columns, rows)
                await app.tell(type="resize", width=width, height=height)
            case ["focus" | "blur" as type_]:
                await app.tell(type=type_)
            case ["ping", str(when)]:
                await websocket.send_json(["pong", when[:20]])
            case _:
                return  # only our page sends known messages


def _parsed(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _number(request: web.Request, name: str) -> int | None:
    text = request.query.get(name, "")
    return int(text) if text.isascii() and text.isdigit() and len(text) < 10 else None


def _reason(text: str) -> bytes:
    return text.encode()[:_LONGEST_REASON].decode(errors="ignore").encode()


# Running until a signal


_TO_END: Final = 12.0  # seconds; the apps end earlier
_SIGNALS: Final = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows knows the first two


def _faults_of_ours() -> logging.Logger:
    # Malformed requests are answered, and that is enough
    log = logging.getLogger(__name__)
    log.addFilter(_is_no_bad_request)
    return log


def _is_no_bad_request(record: logging.LogRecord) -> bool:
    return not (record.exc_info and isinstance(record.exc_info[1], HttpProcessingError))


async def serve(site: Site, listening: socket.socket, started: Callable[[], None]) -> None:
    """Serve until SIGINT, SIGTERM or SIGHUP. All app processes are gone afterwards.

    `started` is called when browsers may connect.
    """
    signalled = asyncio.Event()
    on_signals(_SIGNALS, lambda _: signalled.set())
    runner = web.AppRunner(
        site.application(), access_log=None, logger=_faults_of_ours(), shutdown_timeout=_TO_END
    )
    await runner.setup()
    try:
        await web.SockSite(runner, listening).start()
        started()
        await signalled.wait()
    finally:
        await runner.cleanup()
