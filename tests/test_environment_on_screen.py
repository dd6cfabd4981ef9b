"""An environment that prints, hangs and fails."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from pseudo_terminal import PseudoTerminal, visible

from rl_tui.live.sessions.session import sessions_in

TAKEN = b"\x1b[?1049h"  # the alternate screen

SCRIPT = """
import os, sys, threading, warnings
import gymnasium

HANGS_AT, FAILS_AT = map(int, sys.argv[1:3])

class Odd(gymnasium.Env):
    observation_space = action_space = gymnasium.spaces.Discrete(2)
    taken = 0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        print("NOISE")
        return 0, {}

    def step(self, action):
        self.taken += 1
        print("NOISE")
        print("NOISE", file=sys.stderr)
        warnings.warn("NOISE")
        os.write(1, b"NOISE")
        os.write(2, b"NOISE")
        if self.taken == HANGS_AT:
            threading.Event().wait()
        if self.taken == FAILS_AT:
            raise RuntimeError("out of breath")
        return 1, 1.0, self.taken % 3 == 0, False, {}

gymnasium.register("Odd-v0", Odd)
sys.argv = ["rl-tui", "play", "gym:Odd-v0"]
from rl_tui.commands.main import main
main()
"""


# It prints all the time: in its steps, in its own thread, and at the interpreter's end
LOUD = """
import atexit, os, sys, threading, time
import gymnasium

SAID = "\\x1b[2JPWNED"

def shout():
    for stream in (sys.stdout, sys.stderr, sys.__stdout__, sys.__stderr__):
        print(SAID, file=stream, flush=True)
        if hasattr(stream, "buffer"):
            stream.buffer.write(SAID.encode())
            stream.buffer.flush()
    os.write(1, SAID.encode())
    os.write(2, SAID.encode())

def go_on():
    while True:
        shout()
        time.sleep(0.01)

class Loud(gymnasium.Env):
    observation_space = action_space = gymnasium.spaces.Discrete(2)
    taken = 0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        self.taken += 1
        if self.taken == 1:
            threading.Thread(target=go_on, daemon=True).start()
            atexit.register(shout)
        print(SAID)
        return 1, 1.0, self.taken % 3 == 0, False, {}

    def close(self):
        print(SAID)

gymnasium.register("Loud-v0", Loud)
sys.argv = ["rl-tui", "play", "gym:Loud-v0"]
from rl_tui.commands.main import main
main()
"""


def check_left_as_it_was(terminal: PseudoTerminal) -> None:
    assert terminal.wait_for_end() == 0
    assert terminal.modes_left_changed == set()
    assert terminal.attributes == terminal.attributes_before
    written = visible(terminal.written)
    assert "Traceback" not in written
    # output before the screen starts goes to the terminal, like any message
    assert "NOISE" not in written[written.index("Odd-v0") :]


@pytest.mark.exhaustive("starts another terminal")
@pytest.mark.parametrize("leave", ["q", "\x1b"])
def test_an_environment_that_never_answers_can_be_left(tmp_path: Path, leave: str) -> None:
    command = [sys.executable, "-c", SCRIPT, "3", "0"]
    with PseudoTerminal(command, {"RL_TUI_SESSIONS_DIR": str(tmp_path)}) as terminal:
        terminal.wait_for("paused")
        for step in (1, 2):
            terminal.press("s")
            terminal.wait_for(rf"step\s+{step}\b")
        terminal.press("s")
        terminal.wait_for(r"the environment has not answered for \d+ s; esc leaves it")
        if leave == "\x1b":
            terminal.press(leave)
            terminal.wait_for("esc again: back to the start screen")
            terminal.press(leave)
            terminal.wait_for("Begin here")
        terminal.press("qq")
        check_left_as_it_was(terminal)
    (session,), _ = sessions_in(tmp_path)
    assert session.step == 2


@pytest.mark.exhaustive("starts another terminal")
def test_an_environment_that_fails_is_told_and_gone_back_from(tmp_path: Path) -> None:
    command = [sys.executable, "-c", SCRIPT, "0", "5"]
    with PseudoTerminal(command, {"RL_TUI_SESSIONS_DIR": str(tmp_path)}) as terminal:
        terminal.wait_for("paused")
        terminal.press(" ")
        terminal.wait_for("stopped: at step 5 Odd-v0 failed in a step: RuntimeError: out of breath")
        terminal.press("b")
        terminal.wait_for(r"step\s+3\b")
        terminal.press("qq")
        check_left_as_it_was(terminal)


def test_nothing_that_an_environment_prints_reaches_the_terminal_not_even_at_the_end(tmp_path: Path) -> None:
    environment = {"RL_TUI_SESSIONS_DIR": str(tmp_path)}
    with PseudoTerminal([sys.executable, "-c", LOUD], environment) as terminal:
        terminal.wait_for("paused")
        terminal.press(" " + "+" * 9)
        terminal.wait_for(r"step\s+[\d,]{3,}")
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
        assert terminal.modes_left_changed == set()
        assert b"PWNED" not in terminal.written.partition(TAKEN)[2]
