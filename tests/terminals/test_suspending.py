"""Going to the shell and back."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import termios
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from losable_terminal import CONTROLLING, LosableTerminal, kept_step
from pseudo_terminal import RL_TUI

STEPS = 3
CTRL_Z = "\x1a"
TAKEN = b"\x1b[?1049h"  # the alternate screen, empty at first
PROMPT = "now_yours:"
# Older prompts are on the screen too, and show as soon as the program has left it. A line typed before the
# program restores the line mode never ends for the shell
ASKS = rf"{PROMPT}\s*\Z"
STOPPED = rf"(?s)Stopped.*{ASKS}"
SHELL = ("bash", "--norc", "--noprofile", "--noediting", "-i")
PLAY = shlex.join([*RL_TUI, "play", "student"])

needs_bash = pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash: apt-get install bash")


@contextmanager
def shell(folder: Path, command: str = PLAY) -> Iterator[LosableTerminal]:
    environment = {"RL_TUI_SESSIONS_DIR": str(folder), "PS1": PROMPT}
    with LosableTerminal([*CONTROLLING, *SHELL], environment, (100, 30)) as terminal:
        terminal.wait_for(ASKS)
        terminal.press(f"{command}\r")
        take_steps(terminal)
        yield terminal
        terminal.wait_for(ASKS)
        terminal.press("exit\r")
        assert terminal.wait_for_end() == 0
        assert terminal.modes_left_changed == set()


def take_steps(terminal: LosableTerminal) -> None:
    terminal.wait_for("paused")
    terminal.press("s" * STEPS)
    terminal.wait_for(rf"step\s+{STEPS}\b")


def takes_lines(terminal: LosableTerminal) -> bool:
    """The terminal is in the mode of a shell."""
    return bool(terminal.attributes[3] & termios.ICANON and terminal.attributes[3] & termios.ECHO)


@needs_bash
def test_ctrl_z_goes_to_the_shell_and_fg_comes_back(tmp_path: Path) -> None:
    # started by another program, which must stop with it
    with shell(tmp_path, f"sh -c {shlex.quote(PLAY + '; true')}") as terminal:
        changed = terminal.modes_left_changed
        terminal.press(CTRL_Z)
        terminal.wait_for(STOPPED)
        assert takes_lines(terminal)
        assert terminal.modes_left_changed == set()
        terminal.press("fg\r")
        terminal.wait_for(rf"step\s+{STEPS}\b")
        assert not takes_lines(terminal)
        assert terminal.modes_left_changed == changed
        terminal.press(CTRL_Z)
        terminal.wait_for(STOPPED)
        terminal.press("bg; wait\r")
        terminal.wait_for(rf"(?s)job 1.* stopped.*{ASKS}")  # again: it needs the terminal
        assert takes_lines(terminal)
        terminal.press("fg\r")
        terminal.wait_for(rf"step\s+{STEPS}\b")
        terminal.press("s")
        terminal.wait_for(rf"step\s+{STEPS + 1}\b")
        terminal.press("qq")


@pytest.mark.exhaustive("suspends in many ways")
def test_it_can_be_stopped_from_outside_but_by_ctrl_z_only_where_there_is_a_shell(tmp_path: Path) -> None:
    command = [*CONTROLLING, *RL_TUI, "play", "student"]
    with LosableTerminal(command, {"RL_TUI_SESSIONS_DIR": str(tmp_path)}) as terminal:
        take_steps(terminal)
        terminal.press(CTRL_Z)
        terminal.wait_for("no shell")
        for number in (signal.SIGTSTP, signal.SIGSTOP):  # no program can prepare for the last one
            stop(terminal, number)
            if number is signal.SIGTSTP:
                assert terminal.attributes == terminal.attributes_before
            before = terminal.written.count(TAKEN)
            terminal.process.send_signal(signal.SIGCONT)
            terminal.wait_until(lambda before=before: terminal.written.count(TAKEN) > before)
            terminal.wait_for(rf"step\s+{STEPS}\b")
        stop(terminal, signal.SIGTSTP)
        terminal.process.send_signal(signal.SIGTERM)
        terminal.process.send_signal(signal.SIGCONT)
        assert terminal.wait_for_end() == 128 + signal.SIGTERM
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before
    assert kept_step(tmp_path) == STEPS


@pytest.mark.exhaustive("suspends in many ways")
def test_what_only_started_it_is_no_shell_to_go_to(tmp_path: Path) -> None:
    command = [*CONTROLLING, "sh", "-c", f"{PLAY}; exit $?"]  # like sshd if the shell stays
    with LosableTerminal(command, {"RL_TUI_SESSIONS_DIR": str(tmp_path)}) as terminal:
        take_steps(terminal)
        terminal.press(CTRL_Z)
        terminal.wait_for("no shell")
        terminal.press("qq")
        assert terminal.wait_for_end() == 0


def stop(terminal: LosableTerminal, number: int) -> None:
    terminal.process.send_signal(number)
    terminal.wait_reading(
        lambda: os.waitid(os.P_PID, terminal.process.pid, os.WSTOPPED | os.WNOHANG) is not None, "it stops"
    )
