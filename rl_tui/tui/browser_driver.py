"""The driver of an app that is shown in a browser: pipes to the server that started it, not a terminal."""

from __future__ import annotations

import os
import signal
from typing import Any

from textual.app import App
from textual.drivers.web_driver import WebDriver


class BrowserDriver(WebDriver):
    """Textual's web driver that ends the program when the server at the other end of the pipes is gone.

    The server says when the browser has left; one that was killed cannot, and its apps must not stay.
    """

    def __init__(
        self,
        app: App[Any],
        *,
        debug: bool = False,
        mouse: bool = True,
        size: tuple[int, int] | None = None,
    ) -> None:
        super().__init__(app, debug=debug, mouse=mouse, size=size)
        self._write = self._write_whole  # type: ignore[assignment]

    def run_input_thread(self) -> None:
        """Read what the browser sends until the app ends or nothing more can come."""
        super().run_input_thread()
        if not self.exit_event.is_set():
            self._end()

    def _enable_mouse_support(self) -> None:
        if self._mouse:
            super()._enable_mouse_support()

    def _write_whole(self, packet: bytes) -> int:
        """Write all of ``packet``: a signal may cut a write short, and half of one spoils all that follow."""
        rest = memoryview(packet)
        try:
            while rest:
                rest = rest[os.write(self.fileno, rest) :]
        except BrokenPipeError:
            self._end()
        return len(packet)

    def _end(self) -> None:
        os.kill(os.getpid(), signal.SIGTERM)  # handled as any order to end is: what was done is kept first
