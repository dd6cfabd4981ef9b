"""The very first start, with nothing compiled yet."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from programs.watched_scripts import lives
from pseudo_terminal import RL_TUI, PseudoTerminal

pytestmark = [
    pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are looked for in /proc"),
    pytest.mark.exhaustive("compiles into an empty cache"),
]

FASTER, SLOWER = "+" * 9, "-" * 9
FULL_SPEED = " " + FASTER
TEN_MILLIONS = r"step\s+\d{2,3}(,\d{3}){2,}"
MOST_SECONDS = 120.0


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[PseudoTerminal]:
    variables = {"RL_TUI_CACHE_DIR": str(tmp_path / "cache")}
    with PseudoTerminal([*RL_TUI, "play", "frozenlake"], variables) as opened:
        opened.wait_for("no step yet")
        yield opened


def compilers_of(pid: int) -> list[int]:
    found = []
    for folder in Path("/proc").iterdir():
        with suppress(OSError):
            parent = folder.joinpath("stat").read_text().rpartition(")")[2].split()[1]
            if int(parent) == pid and b"compiling.worker" in folder.joinpath("cmdline").read_bytes():
                found.append(int(folder.name))
    return found


def becomes(condition: Callable[[], bool]) -> bool:
    end = time.perf_counter() + MOST_SECONDS
    while not condition() and time.perf_counter() < end:
        time.sleep(0.01)
    return condition()


def test_it_takes_steps_at_once_and_goes_on_as_machine_code(terminal: PseudoTerminal) -> None:
    terminal.press("s")
    terminal.wait_for(r"step\s+1\s")
    terminal.press(FULL_SPEED)
    terminal.wait_for("compiling")
    terminal.press(SLOWER)  # so that the compiler has the processor
    assert becomes(lambda: not compilers_of(terminal.process.pid))
    terminal.press(FASTER)
    terminal.wait_for(TEN_MILLIONS)
    assert "compiling" not in terminal.screen
    terminal.press("qq")
    assert terminal.wait_for_end() == 0


def test_a_compiler_that_is_killed_is_done_without(terminal: PseudoTerminal) -> None:
    assert becomes(lambda: bool(compilers_of(terminal.process.pid)))
    os.kill(compilers_of(terminal.process.pid)[0], signal.SIGKILL)
    terminal.press(FULL_SPEED)
    terminal.wait_for(TEN_MILLIONS, MOST_SECONDS)
    terminal.press("qq")
    assert terminal.wait_for_end() == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_the_compiler_ends_with_the_program(terminal: PseudoTerminal, number: signal.Signals) -> None:
    assert becomes(lambda: bool(compilers_of(terminal.process.pid)))
    (compiler,) = compilers_of(terminal.process.pid)
    terminal.process.send_signal(number)
    terminal.wait_for_end()
    assert becomes(lambda: not lives(compiler))
