"""The real program on a slow link."""

from __future__ import annotations

import fcntl
import os
import struct
import termios
import tty

import pytest
from pseudo_terminal import RL_TUI, PseudoTerminal
from throttled import ThrottledTerminal

FULL_SPEED = " " + "+" * 9
A_MILLION_STEPS = r"step\s+(\d{1,3}(,\d{3}){2,}|[\d.]+ ?[MG])"


def left_in_input(terminal: PseudoTerminal) -> bytes:
    theirs = terminal.theirs
    tty.setraw(theirs, termios.TCSANOW)  # without discarding it
    (count,) = struct.unpack("i", fcntl.ioctl(theirs, termios.FIONREAD, b"\0" * 4))
    return os.read(theirs, count) if count else b""


@pytest.mark.exhaustive("waits for a slow link")
def test_keys_show_and_nothing_is_left_to_the_shell_on_a_slow_link() -> None:
    with ThrottledTerminal([*RL_TUI, "play", "frozenlake-slippery"], rate=10_000, room=65536) as terminal:
        terminal.wait_for("paused")
        terminal.press(FULL_SPEED)
        terminal.wait_for(A_MILLION_STEPS)
        before = len(terminal.written)
        terminal.press("v")
        terminal.wait_for(r"Q\*, exact")
        assert len(terminal.written) - before < 10_000, "no more frames than one lay before it"
        before = len(terminal.written)
        terminal.press("?")
        terminal.wait_until(lambda: len(terminal.written) > before + 1_500)
        terminal.press("\x11")  # ctrl+q, while a long frame is on its way
        assert terminal.wait_for_end() == 0
        assert left_in_input(terminal) == b""


@pytest.mark.exhaustive("waits for a slow link")
def test_all_is_drawn_again_when_the_terminal_has_another_size() -> None:
    with PseudoTerminal([*RL_TUI, "play", "frozenlake-slippery"], size=(120, 40)) as terminal:
        terminal.wait_for("paused")
        for size in ((80, 24), (130, 45), (90, 30)):
            terminal.emulator.feed(b"\x1b[H" + b"#" * 500)  # lines wrap again
            terminal.resize(*size)
            terminal.wait_until(
                lambda: (
                    "#" not in terminal.screen and "paused" in terminal.screen and "? keys" in terminal.screen
                )
            )
            rows = terminal.screen.split("\n")
            assert len(rows[0].rstrip()) in (size[0] - 1, size[0] - 2), "the step ends at the right margin"
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
