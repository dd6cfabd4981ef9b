"""The real app with pipes in place of a terminal."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event

import pytest

from rl_tui.commands.serving.app_process import command_line, environment_of_app
from rl_tui.screen.terminal.browser_driver import MOST_WAITING, BrowserDriver

DEADLINE = 120.0
TOLD_TO_END = 143


@contextmanager
def app(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        command_line(sys.executable, arguments),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment_of_app(os.environ, (100, 30), kiosk=True),
    )
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    with process.stdin, process.stdout, process.stderr:
        try:
            assert process.stdout.readline() == b"__GANGLION__\n", process.stderr.read()
            for colour in (b"\x1b]11;#", b"\x1b[38;2;"):  # the page colour, then a true colour of some text
                while colour not in packet(process):
                    pass
            yield process
        finally:
            process.kill()
            process.wait()


def packet(process: subprocess.Popen[bytes]) -> bytes:
    kind, length = process.stdout.read(1), process.stdout.read(4)
    assert kind in (b"D", b"M")
    return process.stdout.read(int.from_bytes(length, "big"))


@pytest.mark.process
@pytest.mark.exhaustive("a second way to end", but=["stdin"])
@pytest.mark.parametrize("way", ["stdin", "stdout"])
def test_it_ends_when_the_server_is_gone(way: str) -> None:
    with app() as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        if way == "stdin":
            process.stdin.close()
            process.stdout.read()
        else:
            process.stdout.close()
            send(process, b"?")  # help, to draw something
        said = process.stderr.read()
        assert (process.wait(DEADLINE), said) == (TOLD_TO_END, b"")


def send(process: subprocess.Popen[bytes], keys: bytes) -> None:
    process.stdin.write(b"D" + len(keys).to_bytes(4, "big") + keys)
    process.stdin.flush()


@pytest.mark.process
@pytest.mark.exhaustive("the browser is told the same every day")
def test_it_says_that_it_was_left() -> None:
    with app("--no-mouse") as process:
        send(process, b"?\x1bq")  # help, closed before it quits
        drawn = b""
        while b"exit" not in (last := packet(process)):
            drawn += last
        assert last == b'{"type": "exit"}'
        assert b"\x1b[?1006h" not in drawn
        assert process.wait(DEADLINE) == 0


def test_what_comes_faster_than_the_app_can_take_it_in_is_not_read() -> None:
    waiting = [MOST_WAITING + 1, MOST_WAITING, MOST_WAITING - 1]

    class Busy:
        @property
        def message_queue_size(self) -> int:
            return waiting.pop(0)

    class Driver(BrowserDriver):
        def __init__(self) -> None:  # without the pipes of a server
            self._app = Busy()  # type: ignore[assignment]
            self.exit_event = Event()

    driver = Driver()
    driver.on_meta("nothing", {})
    assert waiting == []
    waiting[:] = [MOST_WAITING] * 2
    driver.exit_event.set()
    driver.on_meta("nothing", {})  # at the end there is no reader any more
    assert len(waiting) == 1
