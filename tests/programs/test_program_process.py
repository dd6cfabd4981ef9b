"""A watched program as a process."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest
from held_programs import held
from watched_scripts import LOOP, lines_of, lives, script_in, wait_until, watched

from rl_tui.programs.watched.program_process import ProgramProcess, ProgramRequest

pytestmark = pytest.mark.process


def test_it_leaves_neither_descriptors_nor_processes(tmp_path: Path) -> None:
    path = script_in(tmp_path, LOOP.format(episodes=2))
    watched(path)
    before = descriptors(), children()
    for _ in range(3):
        watched(path)
        process = ProgramProcess(ProgramRequest(path))
        process.end()
        process.end()
    gc.collect()
    assert (descriptors(), children()) == before


@pytest.mark.parametrize("executable", ["", "/no/such/python", "/dev/null"])
def test_where_nothing_can_be_started_that_is_an_oserror_and_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, executable: str
) -> None:
    monkeypatch.setattr(sys, "executable", executable)
    before = descriptors()
    with pytest.raises(OSError):  # noqa: PT011
        ProgramProcess(ProgramRequest(script_in(tmp_path, "")))
    assert descriptors() == before


@pytest.mark.usefixtures("real_start")
def test_it_needs_no_folder_for_temporary_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", "/no/such/folder")
    monkeypatch.setattr("tempfile.tempdir", "/no/such/folder")
    log = watched(script_in(tmp_path, LOOP.format(episodes=2) + "print('done')\n"))
    assert (lines_of(log), log.error) == (["done"], None)


@pytest.mark.usefixtures("real_start")
def test_nothing_is_imported_from_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("gymnasium", "numpy", "random", "json"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('from the current folder')\n")
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path)
    log = watched(script_in(tmp_path / "in", "import gymnasium, random\nprint('fine')\n"))
    assert (lines_of(log), log.error) == (["fine"], None)


@pytest.mark.exhaustive("kills many programs", but=["9-while True: pass"])
@pytest.mark.parametrize(
    "code",
    [
        "import time; time.sleep(600)",
        "while True: pass",
        "import re; re.match('(a+)+$', 'a' * 60 + 'b')",
        "import signal; signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM, signal.SIGINT])\ninput",
        "import subprocess; subprocess.run(['sleep', '600'])",
        pytest.param(
            "import signal, time; signal.signal(signal.SIGIO, signal.SIG_IGN); time.sleep(600)",
            marks=pytest.mark.skipif(sys.platform != "linux", reason="only Linux has a signal for it"),
        ),
        "import sys\nwhile True: print('flood'); print('flood', file=sys.stderr)",
    ],
)
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_it_ends_with_the_process_that_watches(tmp_path: Path, code: str, how: signal.Signals) -> None:
    path = script_in(
        tmp_path,
        f"""\
        import os, subprocess
        child = subprocess.Popen(["sleep", "600"])
        with open({str(tmp_path / "new")!r}, "w") as file:
            file.write(f"{{os.getpid()}} {{child.pid}}")
        os.rename({str(tmp_path / "new")!r}, {str(tmp_path / "numbers")!r})
        exec({code!r})
        os.wait()
        """,
    )
    watching = dedent(
        f"""\
        from pathlib import Path
        from rl_tui.programs.watched.program_process import ProgramRequest, watched_to_the_end
        watched_to_the_end(ProgramRequest(Path({str(path)!r})))
        """
    )
    watcher = subprocess.Popen([sys.executable, "-c", watching])
    try:
        numbers = tmp_path / "numbers"
        wait_until(numbers.exists)
        processes = [int(number) for number in numbers.read_text().split()]
    finally:
        watcher.send_signal(how)
        watcher.wait()
    wait_until(lambda: not any(map(lives, processes)))


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux can seal memory")
def test_what_both_sides_share_cannot_be_taken_away(tmp_path: Path) -> None:
    path = script_in(
        tmp_path,
        """\
        import os
        refused = 0
        for descriptor in map(int, os.listdir("/proc/self/fd")):
            try:
                refused += os.readlink(f"/proc/self/fd/{descriptor}").startswith("/memfd:")
                os.ftruncate(descriptor, 0)
            except OSError:
                pass
        print(refused > 0)
        """,
    )
    log = watched(path)
    assert (lines_of(log), log.error) == (["True"], None)


def test_its_children_end_with_it(tmp_path: Path) -> None:
    path = script_in(
        tmp_path,
        """\
        import os, subprocess, time
        for _ in range(3):
            print(subprocess.Popen(["sleep", "600"]).pid, flush=True)
        for _ in range(3):
            number = os.fork()  # keeps all pipes open
            if number == 0:
                time.sleep(600)
            print(number, flush=True)
        os.kill(os.getpid(), 9)
        """,
    )
    log = watched(path)
    numbers = [int(line) for line in lines_of(log)]
    assert len(numbers) == 6
    assert "SIGKILL" in log.error.text
    wait_until(lambda: not any(map(lives, numbers)))


def test_asking_a_program_that_never_listens_does_not_wait(tmp_path: Path) -> None:
    process = ProgramProcess(ProgramRequest(script_in(tmp_path, "while True: pass\n")))
    try:
        for number in range(3000):
            process.ask({"stop": {"states": list(range(number % 200))}})
            process.allow(number)
    finally:
        process.end()


def test_output_stands_behind_the_step_before_it(tmp_path: Path) -> None:
    text = """\
    import gymnasium as gym
    env = gym.make("CliffWalking-v1")
    env.reset()
    for number in range(100):
        env.step(0)
        print("after", number + 1)
    """
    with held(tmp_path, text) as program:
        for allowed in range(5):
            log = program.go_to(allowed)
    assert [line.text for line in log.output] == [f"after {number}" for number in range(1, 5)]
    # on a busy machine, output written just before a step may arrive just after it
    assert all(number - line.step in (0, 1) for number, line in enumerate(log.output, 1))


def descriptors() -> list[str]:
    return sorted(os.listdir("/dev/fd"))


def children() -> list[str]:
    ours = str(os.getpid())
    states = {folder.name: folder / "stat" for folder in Path("/proc").glob("[0-9]*")}
    return sorted(name for name, state in states.items() if parent_in(state) == ours)


def parent_in(state: Path) -> str:
    try:
        return state.read_text(encoding="utf-8").rpartition(")")[2].split()[1]
    except OSError:  # it has ended meanwhile
        return ""
