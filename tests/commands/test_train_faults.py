"""``train`` with an environment that fails."""

from __future__ import annotations

import io
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.commands import main
from rl_tui.commands.line.output import finish_compiling
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL

SCRIPT = """
import os, sys, time
import gymnasium

FAILS_AT, HANGS_AT = map(int, sys.argv[1:3])

class Odd(gymnasium.Env):
    observation_space = action_space = gymnasium.spaces.Discrete(2)
    taken = 0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        self.taken += 1
        print("a word from the environment", flush=True)
        os.write(1, b"a word past Python\\n")
        if self.taken == FAILS_AT:
            raise KeyboardInterrupt("out of breath")
        if self.taken == HANGS_AT:
            print("it hangs now", file=sys.stderr, flush=True)
            while True:
                time.sleep(0.05)
        return 1, 1.0, self.taken % 5 == 0, False, {}

gymnasium.register("Odd-v0", Odd)
sys.argv = ["rl-tui", *sys.argv[3:]]
from rl_tui.commands.main import main
main()
"""


def started(*args: str, fails_at: int = 0, hangs_at: int = 0) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", SCRIPT, str(fails_at), str(hangs_at), "train", *args]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def said_by_rl_tui(stderr: str) -> list[str]:
    return [line for line in stderr.splitlines() if not line.startswith("a word ")]


@pytest.mark.process
@pytest.mark.parametrize("runs", [(), ("--runs", "1")])
def test_a_failure_is_one_line_and_the_rows_until_then_are_kept(
    tmp_path: Path, runs: tuple[str, ...]
) -> None:
    rows = tmp_path / "rows.csv"
    child = started("gym:Odd-v0", "--steps", "100", "--json", "--csv", str(rows), *runs, fails_at=13)
    out, err = child.communicate(timeout=120)
    assert (child.returncode, out) == (1, "")
    (line,) = said_by_rl_tui(err)
    assert line.endswith("gym:Odd-v0: at step 13 Odd-v0 failed in a step: KeyboardInterrupt: out of breath")
    assert rows.read_text() == "run,episode,return,length\n1,1,5.0,5\n1,2,5.0,5\n"


@pytest.mark.process
@pytest.mark.parametrize("runs", [(), ("--runs", "3")])
def test_ctrl_c_ends_what_never_answers(tmp_path: Path, runs: tuple[str, ...]) -> None:
    rows = tmp_path / "rows.csv"
    child = started("gym:Odd-v0", "--steps", "100", "--csv", str(rows), *runs, hangs_at=7)
    assert child.stderr is not None
    for line in child.stderr:
        if "it hangs now" in line:
            break
    while not rows.exists():  # threads may hang before it is opened
        time.sleep(0.01)
    child.send_signal(signal.SIGINT)
    out, err = child.communicate(timeout=120)
    assert (child.returncode, out) == (130, "")
    assert "Traceback" not in err
    finished = "" if runs else "1,1,5.0,5\n"  # a thread that hangs cannot report its rows
    assert rows.read_text() == f"run,episode,return,length\n{finished}"


@pytest.mark.process
def test_what_an_environment_writes_to_descriptor_1_is_no_result() -> None:
    child = started("gym:Odd-v0", "--steps", "3", "--json")
    without_stderr = ["sh", "-c", 'exec "$@" 2>&-', "sh", *child.args]  # type: ignore[misc]
    out, err = child.communicate(timeout=120)
    assert json.loads(out)["steps"] == 3
    assert err.splitlines() == ["a word from the environment", "a word past Python"] * 3
    out = subprocess.run(without_stderr, stdout=subprocess.PIPE, timeout=120, check=True).stdout
    assert json.loads(out)["steps"] == 3


def test_results_reach_stdout_though_an_environment_never_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    written = io.BytesIO()
    stdout = io.TextIOWrapper(written, encoding="utf-8")
    monkeypatch.setattr("sys.stdout", stdout)
    monkeypatch.setattr("sys.__stdout__", stdout)
    left: list[int] = []
    monkeypatch.setattr("os._exit", left.append)
    stdout.write("a result")
    with ENVIRONMENT_CALL:
        main.leave_at_once(130)
    assert (written.getvalue(), left) == (b"a result", [130])


def test_where_there_is_no_machine_code_it_is_said_at_the_end(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(BACKGROUND, "failed", {})
    finish_compiling()
    assert capsys.readouterr().err == ""
    loop = Loop("sarsa", "softmax", stepped=False)
    monkeypatch.setitem(BACKGROUND.failed, loop, ModuleNotFoundError(name="numba"))
    finish_compiling()
    assert capsys.readouterr().err.count("pip install numba") == 1
