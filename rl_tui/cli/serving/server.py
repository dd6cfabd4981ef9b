"""Running the site until a signal ends it."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import Callable
from typing import Final

from aiohttp import web
from aiohttp.http_exceptions import HttpProcessingError

from rl_tui.cli.serving.site import Site
from rl_tui.terminal.ending import on_signals

_TO_END: Final = 12.0  # seconds: the apps are gone before that
_SIGNALS: Final = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows knows the first two


def _faults_of_ours() -> logging.Logger:
    """Return a log without the requests that are none: who sends one is answered, and that is all."""
    log = logging.getLogger(__name__)
    log.addFilter(_is_no_bad_request)
    return log


def _is_no_bad_request(record: logging.LogRecord) -> bool:
    return not (record.exc_info and isinstance(record.exc_info[1], HttpProcessingError))


async def serve(site: Site, listening: socket.socket, started: Callable[[], None]) -> None:
    """Serve ``site`` on a listening socket until SIGINT, SIGTERM or SIGHUP.

    ``started`` is called when a browser may come. No app process is left when this returns.
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
