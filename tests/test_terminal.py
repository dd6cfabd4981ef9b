"""The real program trains, quits, and restores the terminal."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from pseudo_terminal import RL_TUI, PseudoTerminal, visible

from rl_tui.live.sessions.session import sessions_in

KEYBOARD_ON = re.compile(rb"\x1b\[>\d+u")  # the protocol that distinguishes all keys
KEYBOARD_OFF = b"\x1b[<u"
FASTER = "+" * 9
A_MILLION_STEPS = r"step\s+(\d{1,3}(,\d{3}){2,}|[\d.]+ ?[MG])"


@contextmanager
def rl_tui(*args: str, cache: Path | None = None, status: int = 0, **more: str) -> Iterator[PseudoTerminal]:
    """At the end of the block it must have quit and restored everything."""
    environment = {**({"RL_TUI_CACHE_DIR": str(cache)} if cache else {}), **more}
    with PseudoTerminal([*RL_TUI, *args], environment) as terminal:
        yield terminal
        assert terminal.wait_for_end() == status
        assert b"\x1b[?1049h" in terminal.written  # it did use the alternate screen
        assert terminal.modes_left_changed == set()
        assert len(KEYBOARD_ON.findall(terminal.written)) == terminal.written.count(KEYBOARD_OFF)
        assert terminal.attributes == terminal.attributes_before
        assert "Traceback" not in visible(terminal.written)


def test_it_trains_pauses_and_quits_in_the_middle_of_a_chunk() -> None:
    with rl_tui("play", "frozenlake-8x8-slippery") as terminal:
        terminal.wait_for("paused")
        terminal.press(" ")
        terminal.wait_for(r"10/s")
        terminal.press(FASTER)
        terminal.wait_for(A_MILLION_STEPS)
        terminal.press(" ")
        terminal.wait_for("paused")
        terminal.press(" ")
        terminal.wait_for("▶ max")
        terminal.press("\x11")  # ctrl+q


@pytest.mark.exhaustive("starts another terminal")
def test_it_keeps_what_was_done_when_it_is_told_to_end(tmp_path: Path) -> None:
    with rl_tui("play", "student", status=128 + signal.SIGHUP, RL_TUI_SESSIONS_DIR=str(tmp_path)) as terminal:
        terminal.wait_for("paused")
        for step in range(1, 6):
            terminal.press("s")
            terminal.wait_for(rf"step\s+{step}\b")
        terminal.process.send_signal(signal.SIGHUP)
    (session,), _ = sessions_in(tmp_path)
    assert session.step == 5
    assert len(list(tmp_path.iterdir())) == 1, "the lock is given back"


def test_the_shell_is_told_what_is_kept_and_how_to_go_on(tmp_path: Path) -> None:
    folder = str(tmp_path / "my sessions")
    with rl_tui("play", "student", RL_TUI_SESSIONS_DIR=folder) as terminal:
        terminal.wait_for("paused")
        terminal.press("s")
        terminal.wait_for(r"step\s+1\b")
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
        said = visible(terminal.written.rpartition(b"\x1b[?1049l")[2])
    (session,), _ = sessions_in(Path(folder))
    assert "A student's evening, at step 1" in said
    assert f"rl-tui play '{session.path}'" in said.replace("\r\n", "\n")


@pytest.mark.exhaustive("starts another terminal")
def test_where_nothing_is_kept_nothing_is_said(tmp_path: Path) -> None:
    for environment in ({"RL_TUI_SESSIONS_DIR": str(tmp_path)}, {"RL_TUI_KIOSK": "1"}):
        with rl_tui("play", "student", **environment) as terminal:
            terminal.wait_for("paused")
            if "RL_TUI_KIOSK" in environment:
                terminal.press("s")
                terminal.wait_for(r"step\s+1\b")
            terminal.press("qq")
            assert terminal.wait_for_end() == 0
            assert "kept" not in visible(terminal.written.rpartition(b"\x1b[?1049l")[2])


@pytest.mark.exhaustive("starts another terminal")
def test_it_may_be_told_to_end_while_it_takes_the_terminal() -> None:
    with rl_tui("play", "student", status=128 + signal.SIGTERM) as terminal:
        terminal.wait_until(lambda: b"\x1b[?1049h" in terminal.written)
        terminal.process.terminate()


@pytest.mark.usefixtures("real_start")
def test_from_the_catalogue_to_a_run_and_back() -> None:
    with rl_tui() as terminal:
        terminal.wait_for("FrozenLake")
        terminal.press("\x1b[B\x1b[B\r")
        terminal.wait_for("paused")
        terminal.press("\x1b")
        terminal.wait_for("Begin here")
        terminal.press("qq")


def test_a_fault_is_told_after_the_terminal_is_restored(tmp_path: Path) -> None:
    file = tmp_path / "nowhere.toml"
    file.write_text('[gymnasium]\nid = "NoSuchWorld-v0"\n', encoding="utf-8")
    with PseudoTerminal([*RL_TUI, "play", str(file)]) as terminal:
        assert terminal.wait_for_end() == 1
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before
        last = visible(terminal.written).splitlines()[-1]
        assert "nowhere.toml" in last
        assert "NoSuchWorld-v0" in last
