"""The driver for a browser."""

from __future__ import annotations

import json
import os
import signal
from codecs import getincrementaldecoder
from typing import Any, Final

from textual.app import App
from textual.color import Color
from textual.drivers._byte_stream import ByteStream
from textual.drivers.web_driver import WebDriver
from textual.message import Message
from textual.theme import Theme

from rl_tui.screen.terminal.ending import end_at_last, end_with
from rl_tui.screen.terminal.input_parser import InputParser

MOST_WAITING: Final = 100  # messages in the queue of the app
_LOOK_AGAIN: Final = 0.01  # seconds
_ENDED_BY_SIGTERM: Final = 128 + signal.SIGTERM


class BrowserDriver(WebDriver):
    """Textual's web driver, which also ends the program when the server is gone.

    Input that the app cannot handle yet is not read, so that the sender waits.
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
        # copies of Textual's private attributes
        self._app, self._debug, self._mouse = app, debug, mouse
        self._write = self._write_whole  # type: ignore[assignment]

    def start_application_mode(self) -> None:
        """Start, and colour the browser's terminal."""
        super().start_application_mode()
        self._app.theme_changed_signal.subscribe(self._app, self._tint)
        self._tint(self._app.current_theme)

    def _tint(self, _: Theme) -> None:
        background = Color.parse(self._app.theme_variables["background"])
        self.write(f"\x1b]11;{background.hex6.lower()}\x07" if background.ansi is None else "\x1b]111\x07")

    def run_input_thread(self) -> None:
        """Read until the app ends or the pipe closes."""
        if not hasattr(self, "_input_reader"):
            return super().run_input_thread()
        parser, stream = InputParser(debug=self._debug), ByteStream()
        decode = getincrementaldecoder("utf-8")("replace").decode
        try:
            for data in self._input_reader:
                for kind, payload in stream.feed(data) if data else ():
                    if kind == "D":
                        self._process(parser.feed(decode(payload)))
                    elif (said := json.loads(payload)).get("type") == "exit":
                        return None
                    else:
                        self.on_meta(str(said.get("type")), said)
                self._process(parser.tick())
        except Exception as fault:  # no key would be read any more: better to end and say why
            end_with(self._app, fault)
        finally:
            self._input_reader.close()
            if not self.exit_event.is_set():
                self._end()
        return None

    def _process(self, messages: list[Message]) -> None:
        for message in messages:
            self.process_message(message)

    def process_message(self, message: Message) -> None:
        """Hand on the terminal's input."""
        self._wait_for_app()
        super().process_message(message)

    def on_meta(self, packet_type: str, payload: dict[str, object]) -> None:
        """Hand on the server's messages."""
        self._wait_for_app()
        super().on_meta(packet_type, payload)

    def _wait_for_app(self) -> None:
        while self._app.message_queue_size >= MOST_WAITING and not self.exit_event.wait(_LOOK_AGAIN):
            pass

    def _enable_mouse_support(self) -> None:
        if self._mouse:
            super()._enable_mouse_support()

    def _write_whole(self, packet: bytes) -> int:
        """Write all of ``packet``, even if a signal cuts a write short."""
        rest = memoryview(packet)
        try:
            while rest:
                rest = rest[os.write(self.fileno, rest) :]
        except BrokenPipeError:
            self._end()
        return len(packet)

    def _end(self) -> None:
        end_at_last(_ENDED_BY_SIGTERM)  # even if the app never handles the signal
        os.kill(os.getpid(), signal.SIGTERM)  # handled like any order to end: the session is saved first
