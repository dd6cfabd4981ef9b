"""A terminal that is gone or does not read."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from losable_terminal import CONTROLLING, DEAF, LosableTerminal, kept_step, wait_until
from pseudo_terminal import RL_TUI, visible

STEPS = 3
FAILING = (
    sys.executable,
    "-c",
    "from rl_tui.commands.main import main\n"
    "from rl_tui.screen.playground.actions.run import RunActions\n"
    "def fail(self): raise ZeroDivisionError('of [red]all\\nthings')\n"
    "RunActions.episode = fail\n"
    "main()",
)


@contextmanager
def student(folder: Path, *before: str, command: tuple[str, ...] = RL_TUI) -> Iterator[LosableTerminal]:
    environment = {"RL_TUI_SESSIONS_DIR": str(folder)}
    with LosableTerminal([*before, *command, "play", "student"], environment) as terminal:
        terminal.wait_for("paused")
        terminal.press("s" * STEPS)
        terminal.wait_for(rf"step\s+{STEPS}\b")
        yield terminal


@pytest.mark.exhaustive("loses a terminal in many ways")
@pytest.mark.parametrize("before", [CONTROLLING, CONTROLLING + DEAF], ids=["told", "deaf"])
def test_it_ends_by_itself_when_the_terminal_is_gone(tmp_path: Path, before: tuple[str, ...]) -> None:
    with student(tmp_path, *before) as terminal:
        terminal.vanish()
        assert terminal.wait_for_exit() == 128 + signal.SIGHUP
    assert kept_step(tmp_path) == STEPS
    assert len(list(tmp_path.iterdir())) == 1, "the lock is given back"


@pytest.mark.exhaustive("loses a terminal in many ways")
def test_it_ends_when_the_terminal_is_gone_in_the_middle_of_a_frame_and_nobody_says_so(
    tmp_path: Path,
) -> None:
    with student(tmp_path) as terminal:
        terminal.press(" " + "+" * 9)
        terminal.wait_for(r"step\s+\d+,\d{3},")
        terminal.vanish()
        assert terminal.wait_for_exit() == 128 + signal.SIGHUP
    assert kept_step(tmp_path) > STEPS


@pytest.mark.exhaustive("loses a terminal in many ways")
def test_a_terminal_that_does_not_read_holds_up_nothing_not_even_the_end(tmp_path: Path) -> None:
    with student(tmp_path) as terminal:
        terminal.stall()
        terminal.press("+ ")
        wait_until(lambda: kept_step(tmp_path) > 60, "it takes keys, goes on and is kept")
        terminal.press("?")
        terminal.wait_for("Words  Pages")  # read again: the latest request is there
        terminal.stall()
        terminal.process.send_signal(signal.SIGQUIT)
        assert terminal.wait_for_exit() == 128 + signal.SIGQUIT


@pytest.mark.exhaustive("loses a terminal in many ways")
def test_a_terminal_that_does_not_read_and_is_gone_then_ends_it(tmp_path: Path) -> None:
    with student(tmp_path) as terminal:
        terminal.stall()
        terminal.press(" ")
        wait_until(lambda: kept_step(tmp_path) > STEPS, "it goes on")
        terminal.vanish()
        assert terminal.wait_for_exit() == 128 + signal.SIGHUP
    assert kept_step(tmp_path) > STEPS


@pytest.mark.exhaustive("loses a terminal in many ways")
def test_to_be_interrupted_from_outside_is_to_be_told_to_end(tmp_path: Path) -> None:
    with student(tmp_path) as terminal:
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.wait_for_end() == 128 + signal.SIGINT
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before
    assert kept_step(tmp_path) == STEPS


def test_an_unexpected_fault_is_one_line_and_the_session_is_kept(tmp_path: Path) -> None:
    with student(tmp_path, command=FAILING) as terminal:
        terminal.press("e")
        assert terminal.wait_for_end() == 1
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before
        (file,) = tmp_path.iterdir()
        shown = visible(terminal.written[terminal.written.rindex(b"\x1b[?1004l") :])
    assert shown.splitlines() == [
        "rl-tui: unexpected ZeroDivisionError: of [red]all things; "
        f"your run is saved: rl-tui play {file} (RL_TUI_TRACEBACK=1 shows where)"
    ]
    assert kept_step(tmp_path) == STEPS
