"""Scripts that tests write and watch."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import ProgramRequest, watched_to_the_end

PATIENCE = 60.0
"""Seconds after which a program that hangs fails a test."""

LOOP = """\
import gymnasium as gym
import numpy as np
env = gym.make("FrozenLake-v1")
Q = np.zeros((16, 4))
for episode in range({episodes}):
    state, info = env.reset()
    done = False
    while not done:
        action = env.action_space.sample()
        next_state, reward, terminated, truncated, info = env.step(action)
        Q[state, action] += 0.5 * (reward - 1 + 0.9 * Q[next_state].max() - Q[state, action])
        state, done = next_state, terminated or truncated
"""


def script_in(folder: Path, text: str, name: str = "script.py") -> Path:
    path = folder / name
    path.write_text(dedent(text), encoding="utf-8")
    return path


def watched(path: Path, *arguments: str, **more: Any) -> ProgramLog:
    return watched_to_the_end(ProgramRequest(path, arguments, **more), seconds=PATIENCE)


def lines_of(log: ProgramLog, stream: str = "out") -> list[str]:
    return [line.text for line in log.output if line.stream == stream]


def check_q_learning(
    log: ProgramLog, table: str | None, form: str, alpha: float, gamma: float, least: float = 1.0
) -> None:
    """At least this share of its updates are those of Q-learning, and nothing is said against it."""
    verdict = verdict_of(log)
    assert (log.error, verdict.findings) == (None, ())
    assert log.table is not None
    assert (log.table.name, log.table.form) == (table, form)
    update = verdict.update
    assert (update.rule, update.fits >= least) == ("q-learning", True)
    assert (update.alpha, update.gamma) == (pytest.approx(alpha), pytest.approx(gamma))


def lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{process}/stat")
    try:
        return state.read_text(encoding="utf-8").rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return not state.parent.parent.exists()


def wait_until(condition: Callable[[], bool]) -> None:
    until = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < until, "it did not come"
        time.sleep(0.01)
