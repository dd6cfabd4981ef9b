"""More input than a person can type."""

from __future__ import annotations

import fcntl
import os
import re
import signal
import struct
import sys
import termios
import time
from pathlib import Path

import pytest
from losable_terminal import CONTROLLING, LosableTerminal, kept_step
from pseudo_terminal import RL_TUI, PseudoTerminal, visible

FLOOD = "\0" * 60_000
MOST_GROWTH = 40  # megabytes; keeping every pending key takes more
NOTHING_ELSE_HAPPENS = (
    sys.executable,
    "-c",
    "import sys, time\n"
    "from rl_tui.commands.main import main\n"
    "from rl_tui.screen.terminal import ending\n"
    "from rl_tui.screen.app.app import RlTuiApp\n"
    "ending.LONGEST = 0.5\n"
    "def hang(self):\n"
    "    print('stuck', file=sys.__stdout__, flush=True)\n"
    "    time.sleep(600)\n"
    "RlTuiApp.action_redraw = hang\n"
    "main()",
)


def type_all(terminal: PseudoTerminal, keys: str) -> None:
    for at in range(0, len(keys), 1000):
        terminal.press(keys[at : at + 1000])
        terminal.wait_until(lambda: unread(terminal) < 1000, what="the program reads")
    terminal.wait_until(lambda: unread(terminal) == 0, what="the program reads")


def unread(terminal: PseudoTerminal) -> int:
    answer = fcntl.ioctl(terminal.theirs, termios.FIONREAD, bytes(4))
    return int(struct.unpack("i", answer)[0])


def step_shown(terminal: PseudoTerminal) -> int | None:
    found = re.search(r"step\s+(\d+)", terminal.screen)
    return int(found[1]) if found else None


def megabytes(terminal: PseudoTerminal) -> int:
    pages = int(Path(f"/proc/{terminal.process.pid}/statm").read_text(encoding="utf-8").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") >> 20


@pytest.mark.exhaustive("types 60,000 keys")
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs /proc")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_flood_of_keys_takes_no_memory_and_keeps_no_signal_waiting(number: signal.Signals) -> None:
    with PseudoTerminal([*RL_TUI, "play", "student"]) as terminal:
        terminal.wait_for("paused")
        terminal.press(" " + "+" * 9)
        terminal.wait_for(r"step\s+[\d,.]+ ?[MG]|step\s+\d+,\d{3},\d{3}")  # all libraries are loaded
        before = megabytes(terminal)
        type_all(terminal, FLOOD)
        assert megabytes(terminal) - before < MOST_GROWTH
        terminal.process.send_signal(number)
        assert terminal.wait_for_end() == 128 + number
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before


@pytest.mark.exhaustive("stops it in the middle")
def test_a_program_that_does_nothing_any_more_still_ends_and_leaves_the_terminal_in_order() -> None:
    with PseudoTerminal([*NOTHING_ELSE_HAPPENS, "play", "student"]) as terminal:
        terminal.wait_for("paused")
        terminal.press("\x0c")
        terminal.wait_until(lambda: "stuck" in visible(terminal.written))
        terminal.process.terminate()
        assert terminal.wait_for_end() == 128 + signal.SIGTERM
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before


@pytest.mark.exhaustive("stops it many times")
def test_stop_and_go_on_at_once_leaves_it_going(tmp_path: Path) -> None:
    command = [*CONTROLLING, *RL_TUI, "play", "student"]
    with LosableTerminal(command, {"RL_TUI_SESSIONS_DIR": str(tmp_path)}) as terminal:
        terminal.wait_for("paused")
        for delay in (0.0, 0.002, 0.005, 0.01, 0.03):
            before = step_shown(terminal)
            terminal.process.send_signal(signal.SIGTSTP)
            time.sleep(delay)  # until the signal has arrived, but perhaps not the stop: at any moment
            terminal.process.send_signal(signal.SIGCONT)
            pressed = 0
            while step_shown(terminal) in (before, None):  # a key is lost while the terminal changes its mode
                terminal.press("s")
                next(terminal.reading(0.1), None)
                pressed += 1
                if pressed % 50 == 0:  # the SIGCONT may have arrived between its last look and its stop
                    terminal.process.send_signal(signal.SIGCONT)
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
    assert kept_step(tmp_path) >= 5
