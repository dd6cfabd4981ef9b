"""``rl-tui warm``."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner

import rl_tui
from rl_tui.agents.compiling import warming
from rl_tui.agents.compiling.background import GONE
from rl_tui.agents.compiling.cache_folder import cache_folder
from rl_tui.agents.compiling.loops import CodeOrigin
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.commands.main import program

LOOPS = [Loop(name, "epsilon-greedy", stepped=False) for name in ("one", "one", "other")]


class Lock:
    def __init__(self, held: int = 0) -> None:
        self.held = held

    def acquire(self) -> bool:
        self.held -= 1
        return self.held < 0

    def __enter__(self) -> Lock:
        return self

    def __exit__(self, *_: object) -> None: ...


class Worker:
    started: list[Worker]
    says: Callable[[Loop], str]

    def __init__(self, *, alone: bool) -> None:
        assert alone
        self.asked: list[Loop] = []
        self.has_ended = False
        type(self).started.append(self)

    def ask(self, loop: Loop) -> None:
        self.asked.append(loop)

    def answer(self, seconds: float) -> str:
        return type(self).says(self.asked[0])

    def end(self) -> None:
        self.has_ended = True


@pytest.fixture
def noted(monkeypatch: pytest.MonkeyPatch) -> set[Loop]:
    noted: set[Loop] = set()
    monkeypatch.setattr(Worker, "started", [], raising=False)
    monkeypatch.setattr(Worker, "says", staticmethod(lambda loop: CodeOrigin.COMPILED), raising=False)
    monkeypatch.setattr(warming, "WorkerProcess", Worker)
    monkeypatch.setattr(warming, "CompilerLock", Lock)
    monkeypatch.setattr(warming, "LOOKED_FOR_EVERY", 0.001)
    monkeypatch.setattr("rl_tui.agents.compiling.loops.all_loops", lambda: LOOPS)
    monkeypatch.setattr("rl_tui.agents.compiling.loops.all_batches", list)
    monkeypatch.setattr(warming, "takes_code", lambda: True)
    monkeypatch.setattr(warming, "was_compiled", lambda loop: loop in noted)
    return noted


def test_each_algorithm_has_a_worker_of_its_own(noted: set[Loop]) -> None:
    seen: list[tuple[int, int]] = []
    assert warming.warm(LOOPS, 2, lambda done, wanted: seen.append((done, wanted))) == (3, 0)
    assert [each.asked for each in Worker.started] == [LOOPS[:2], LOOPS[2:]]
    assert all(each.has_ended for each in Worker.started)
    assert seen == [(0, 3), (1, 3), (2, 3), (3, 3)]


def test_what_is_noted_is_read_to_see_that_it_is_there(
    noted: set[Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    noted.update(LOOPS)
    monkeypatch.setattr(Worker, "says", staticmethod(lambda loop: CodeOrigin.FOUND))
    assert warming.warm(LOOPS, 1, lambda *_: None) == (0, 3)
    assert len(Worker.started) == 2


def test_what_another_program_compiles_meanwhile_is_not_compiled_again(
    noted: set[Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(warming, "CompilerLock", lambda: Lock(held=2))
    seen: list[int] = []

    def on_progress(done: int, wanted: int) -> None:
        seen.append(done)
        noted.update(LOOPS)

    assert warming.warm(LOOPS, 1, on_progress) == (0, 3)
    assert Worker.started == []
    assert seen == [0, 3, 3]


@pytest.mark.parametrize("refuses", [True, False])
def test_without_workers_this_process_compiles(
    noted: set[Loop], monkeypatch: pytest.MonkeyPatch, refuses: bool
) -> None:
    def refused(**_: object) -> Worker:
        raise BlockingIOError

    if refuses:
        monkeypatch.setattr(warming, "WorkerProcess", refused)
    monkeypatch.setattr(Worker, "says", staticmethod(lambda loop: GONE))
    here: list[Loop] = []

    def compile_alone(loop: Loop) -> CodeOrigin:
        here.append(loop)
        return CodeOrigin.COMPILED

    monkeypatch.setattr(warming, "compile_alone", compile_alone)
    assert warming.warm(LOOPS, 2, lambda *_: None) == (3, 0)
    assert sorted(here) == sorted(LOOPS)
    assert all(each.has_ended for each in Worker.started)


def test_it_says_how_many_and_where(noted: set[Loop]) -> None:
    done = CliRunner().invoke(program, ["warm"])
    assert done.exit_code == 0
    assert done.stdout == f"compiled: 3; already compiled: 0\n{cache_folder()}\n"
    assert done.stderr == ""


def test_a_full_disk_is_one_line(noted: set[Loop], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Worker, "says", staticmethod(lambda loop: CodeOrigin.NOT_KEPT))
    done = CliRunner().invoke(program, ["warm"])
    assert done.exit_code == 1
    assert len(done.stderr.splitlines()) == 1
    assert str(cache_folder()) in done.stderr
    assert all(each.has_ended for each in Worker.started)


def run(*command: str, **also: str) -> subprocess.CompletedProcess[str]:
    home = str(Path(rl_tui.__file__).parents[1])
    environment = os.environ | {"PYTHONPATH": home, **also}
    return subprocess.run(
        [sys.executable, *command], env=environment, capture_output=True, text=True, timeout=300
    )


@pytest.mark.exhaustive("starts compilers for three scenarios")
@pytest.mark.slow
@pytest.mark.process
def test_what_scenarios_begin_with_is_there_afterwards() -> None:
    command = ("-m", "rl_tui", "warm", "frozenlake", "frozenlake-8x8", "blackjack")
    run(*command)
    again = run(*command)
    assert (again.returncode, again.stderr) == (0, "")
    assert again.stdout.splitlines()[0] == "compiled: 0; already compiled: 2"


@pytest.mark.process
@pytest.mark.parametrize("why", ["a file", "no compiler", "kiosk"])
def test_what_cannot_be_kept_is_refused_in_one_line(tmp_path: Path, why: str) -> None:
    (tmp_path / "file").touch()
    environment = {
        "a file": {"RL_TUI_CACHE_DIR": str(tmp_path / "file")},
        "no compiler": {"NUMBA_DISABLE_JIT": "1"},
        "kiosk": {"RL_TUI_KIOSK": "1"},
    }[why]
    done = run("-m", "rl_tui", "warm", **environment)
    assert (done.returncode, done.stdout) == (1, "")
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("rl-tui: ")
