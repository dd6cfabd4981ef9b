"""Running the site until a signal ends it."""

from __future__ import annotations

import asyncio
import signal
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from aiohttp import web

from rl_tui.cli.serving.site import Site

_TO_END: Final = 12.0  # seconds: the apps are gone before that
_SIGNALS: Final = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows knows the first two


async def serve(site: Site, listening: socket.socket, started: Callable[[], None]) -> None:
    """Serve ``site`` on a listening socket until SIGINT, SIGTERM or SIGHUP.

    ``started`` is called when a browser may come. No app process is left when this returns.
    """
    signalled = asyncio.Event()
    loop = asyncio.get_running_loop()
    for name in _SIGNALS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(NotImplementedError):
                loop.add_signal_handler(number, signalled.set)
    runner = web.AppRunner(site.application(), access_log=None, shutdown_timeout=_TO_END)
    await runner.setup()
    try:
        await web.SockSite(runner, listening).start()
        started()
        await signalled.wait()
    finally:
        await runner.cleanup()
