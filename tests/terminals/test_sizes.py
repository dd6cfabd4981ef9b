"""Terminals of any size."""

from __future__ import annotations

import fcntl
import signal
import struct
import termios
from pathlib import Path

import pytest
from pseudo_terminal import RL_TUI, PseudoTerminal
from test_floods import MOST_GROWTH, megabytes

from rl_tui.common.limits import LARGEST_SCREEN

ENDLESS = (65_535, 65_535)
TAKEN = b"\x1b[?1049h"
DRAWING = 1.0  # seconds
WORDS = "no more than"


class Told(PseudoTerminal):
    def say_size(self, columns: int, rows: int) -> None:
        fcntl.ioctl(self.theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.process.send_signal(signal.SIGWINCH)


@pytest.mark.exhaustive("draws a screen without end")
@pytest.mark.parametrize("kiosk", [(), ("--kiosk",)], ids=["", "kiosk"])
def test_a_terminal_that_says_it_is_endless_takes_no_memory(kiosk: tuple[str, ...]) -> None:
    columns, rows = LARGEST_SCREEN
    with Told([*RL_TUI, *kiosk, "play", "student"]) as terminal:
        terminal.wait_for("paused")
        terminal.press(" " + "+" * 9)
        terminal.wait_for("▶ max")
        before = megabytes(terminal)
        terminal.emulator.resize(rows + 1, columns + 1)
        terminal.say_size(*ENDLESS)
        terminal.wait_for(WORDS)
        terminal.wait_for("▶ max")
        assert terminal.screen.splitlines()[rows].startswith(WORDS)
        if Path("/proc/self/statm").exists():
            assert megabytes(terminal) - before < 2 * MOST_GROWTH
        terminal.resize(80, 24)
        terminal.wait_for("▶ max")
        terminal.wait_until(lambda: WORDS not in terminal.screen)
        terminal.press("qq")
        assert terminal.wait_for_end() == 0


@pytest.mark.exhaustive("starts it at every size", but=["size1"])
@pytest.mark.parametrize("size", [ENDLESS, (0, 0), (1, 1), (1, 65_535), (65_535, 1)])
def test_it_starts_in_a_terminal_of_any_size(size: tuple[int, int]) -> None:
    with Told([*RL_TUI, "play", "student"]) as terminal:
        terminal.say_size(*size)
        terminal.wait_until(lambda: TAKEN in terminal.written)
        for _ in terminal.reading(DRAWING):
            pass
        terminal.resize(80, 24)
        terminal.wait_for("paused")
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
