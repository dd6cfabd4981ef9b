"""Machine code in real processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import rl_tui
from rl_tui.agents.compiling.background import GONE, WorkerProcess
from rl_tui.agents.compiling.loops import CodeOrigin
from rl_tui.agents.compiling.worker import NICENESS
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.common.files import FileLock

pytestmark = pytest.mark.process

HOME = str(Path(rl_tui.__file__).parents[1])
LOOP = Loop("q-learning", "epsilon-greedy", stepped=False)
LONGEST = 120.0

# A function that compiles quickly, in place of a loop
QUICK = """
import sys
from rl_tui.agents.compiling import loops
from rl_tui.agents.kernels.compiled import CALLED_FROM_PYTHON
from rl_tui.agents.kernels.episode_bins import fold
from rl_tui.agents.kernels.machine_code import Loop, machine_code

def make(loop):
    machine_code(fold, *CALLED_FROM_PYTHON[fold]())

loops._make = make
LOOP = Loop("q-learning", "epsilon-greedy", stepped=False)
"""

ONE_OF_MANY = f"""{QUICK}
sys.stdin.readline()
print(loops.compile_here(LOOP))
"""

LIMITED = f"""{QUICK}
import resource
from rl_tui.agents.compiling.cache_folder import takes_code
takes_code()
resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))
print(loops.compile_here(LOOP))
"""

PARENT = """
import sys, time
from rl_tui.agents.compiling.background import WorkerProcess
from rl_tui.agents.kernels.machine_code import Loop

worker = WorkerProcess()
worker.ask(Loop("q-learning", "epsilon-greedy", stepped=False))
print(worker._process.pid, flush=True)
time.sleep(3600)
"""


def started(script: str, cache: Path, **also: str) -> subprocess.Popen[str]:
    environment = os.environ | {"PYTHONPATH": HOME, "RL_TUI_CACHE_DIR": str(cache), **also}
    return subprocess.Popen(
        [sys.executable, "-c", script],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def said(child: subprocess.Popen[str]) -> str:
    out, err = child.communicate("\n", timeout=LONGEST)
    assert (child.returncode, err) == (0, "")
    return out.strip()


def until(holds: Callable[[], bool]) -> None:
    end = time.monotonic() + LONGEST
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.02)


def files(cache: Path) -> list[str]:
    return sorted(path.name for path in cache.rglob("*") if path.is_file())


@pytest.mark.slow
def test_of_many_processes_one_compiles_and_the_others_read(tmp_path: Path) -> None:
    children = [started(ONE_OF_MANY, tmp_path) for _ in range(3)]
    for child in children:
        child.stdin.write("\n")
        child.stdin.flush()
    assert sorted(map(said, children)) == ["compiled", "found", "found"]
    assert not [name for name in files(tmp_path) if name.endswith(".lock") or ".tmp." in name]


def test_a_full_disk_leaves_nothing_behind(tmp_path: Path) -> None:
    assert said(started(LIMITED, tmp_path)) == "not kept"
    assert [name for name in files(tmp_path) if not name.endswith(".nbi")] == []


def test_the_worker_ends_with_its_parent_in_the_middle_of_compiling(tmp_path: Path) -> None:
    parent = started(PARENT, tmp_path)
    worker = int(parent.stdout.readline())
    assert os.getsid(worker) == worker
    until(lambda: any(tmp_path.rglob(".compiling.lock")))
    assert os.getpriority(os.PRIO_PROCESS, worker) >= min(19, os.getpriority(os.PRIO_PROCESS, 0) + NICENESS)
    parent.send_signal(signal.SIGKILL)
    parent.communicate(timeout=LONGEST)
    # The system releases the locks of a dead process
    (folder,) = (tmp_path / "kernels").iterdir()
    lock = FileLock(folder / "compiling")
    until(lock.acquire)
    lock.release()


def answer_of(worker: WorkerProcess, loop: Loop) -> str | None:
    try:
        worker.ask(loop)
        return worker.answer(LONGEST)
    finally:
        worker.end()


@pytest.mark.usefixtures("real_start")
def test_the_worker_imports_nothing_from_where_it_is_started(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("numpy", "json", rl_tui.__name__):
        (tmp_path / name).with_suffix(".py").write_text("raise SystemExit")
    monkeypatch.chdir(tmp_path)
    assert answer_of(WorkerProcess(), LOOP) in (CodeOrigin.FOUND, CodeOrigin.COMPILED)


def test_the_folder_it_is_started_in_may_be_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    assert answer_of(WorkerProcess(), LOOP) in (CodeOrigin.FOUND, CodeOrigin.COMPILED)


def test_the_worker_ends_where_it_knows_no_such_algorithm() -> None:
    assert answer_of(WorkerProcess(), Loop("mine", "epsilon-greedy", stepped=False)) == GONE


def test_an_ended_worker_is_told_by_an_oserror() -> None:
    worker = WorkerProcess()
    worker.end()
    with pytest.raises(OSError):  # noqa: PT011
        worker.ask(LOOP)
    assert worker.answer(LONGEST) == GONE


def test_without_a_known_python_there_is_no_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "")
    with pytest.raises(FileNotFoundError):
        WorkerProcess()


def test_where_its_answers_cannot_be_read_no_process_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def noted(*args: object, **kwargs: object) -> subprocess.Popen[bytes]:
        started.append(popen(*args, **kwargs))  # type: ignore[call-overload]
        return started[-1]

    def refused(_: object) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(subprocess, "Popen", noted)
    monkeypatch.setattr("threading.Thread.start", refused)
    with pytest.raises(OSError, match="new thread"):
        WorkerProcess()
    assert [each.poll() for each in started] == [-signal.SIGKILL]
