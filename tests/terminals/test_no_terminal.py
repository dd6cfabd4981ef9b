"""The program without a usable terminal."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

pytest.importorskip("pty", reason="there are no pseudo-terminals here")

from pseudo_terminal import RL_TUI, PseudoTerminal, visible

from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.timeline.branches import FIRST, RunRecord


@pytest.mark.parametrize(
    ("args", "term", "said"),
    [
        ((), "dumb", "TERM=dumb"),
        (("play", "frozenlake"), "unknown", "TERM=unknown"),
        (("play", "student"), None, "TERM is not set"),
    ],
)
def test_a_terminal_that_cannot_be_drawn_on(args: tuple[str, ...], term: str | None, said: str) -> None:
    with PseudoTerminal([*RL_TUI, *args], {"TERM": term}) as terminal:
        assert terminal.wait_for_end() == 2
        assert b"\x1b" not in terminal.written
        assert visible(terminal.written).count("\n") == 1
        assert said in visible(terminal.written)


def test_a_session_needs_a_terminal_too(tmp_path: Path) -> None:
    session = tmp_path / "session.json"
    session.write_bytes(encoded(Record((RunRecord(recipe_for(find("student")), (FIRST,)),))))
    with PseudoTerminal([*RL_TUI, "play", str(session)], {"TERM": "dumb"}) as terminal:
        assert terminal.wait_for_end() == 2
        assert visible(terminal.written).count("\n") == 1


@pytest.mark.parametrize(("redirected", "said"), [("</dev/null", "stdin"), ("| cat", "stdout")])
def test_a_pipe_or_a_file_in_its_place(tmp_path: Path, redirected: str, said: str) -> None:
    script = f"cd '{tmp_path}'; {' '.join(RL_TUI)} play student {redirected}"
    with PseudoTerminal(["sh", "-c", script]) as terminal:
        terminal.wait_for_end()
        assert b"\x1b" not in terminal.written
        assert visible(terminal.written).count("\n") == 1
        assert f"needs a terminal, and {said} is not one" in visible(terminal.written)


def test_without_any_terminal_the_status_is_2() -> None:
    done = subprocess.run(RL_TUI, capture_output=True, stdin=subprocess.DEVNULL, env=dict(os.environ))
    assert done.returncode == 2
    assert done.stdout == b""
    assert done.stderr.count(b"\n") == 1
