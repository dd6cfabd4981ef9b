"""The program over SSH."""

from __future__ import annotations

import getpass
import os
import shlex
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import ssh_server
from losable_terminal import CONTROLLING, LosableTerminal, is_gone, kept_step, wait_until
from pseudo_terminal import RL_TUI
from ssh_server import DEADLINE, SshServer

pytestmark = pytest.mark.skipif(bool(ssh_server.why_not()), reason=ssh_server.why_not())

# ssh closes inherited descriptors, by which the pseudo-terminal notices a running program
KEPT_OPEN = ("sh", "-c", '"$@"; exit $?', "sh")
INHERITED = ("PYTHONPATH", "RL_TUI_CACHE_DIR")


def environment(sessions: Path) -> dict[str, str]:
    kept = {name: os.environ[name] for name in INHERITED if name in os.environ}
    return {**kept, "RL_TUI_SESSIONS_DIR": str(sessions), "LC_ALL": "C.UTF-8"}


def classroom() -> str:
    return f"""
        Match User {getpass.getuser()}
            ForceCommand {shlex.join(RL_TUI)}
            AuthenticationMethods publickey
            PermitTTY yes
            DisableForwarding yes
            AllowTcpForwarding no
            AllowStreamLocalForwarding no
            AllowAgentForwarding no
            X11Forwarding no
            PermitTunnel no
            PermitUserRC no
            MaxSessions 1
            ClientAliveInterval 15
            ClientAliveCountMax 4
    """


@contextmanager
def serving(folder: Path, rules: str = "") -> Iterator[SshServer]:
    (folder / "sshd").mkdir()
    with SshServer(folder / "sshd", environment(folder / "sessions"), rules) as server:
        yield server


@contextmanager
def student(server: SshServer, folder: Path) -> Iterator[LosableTerminal]:
    numbers = f"echo $$ > {folder}/program; echo $PPID > {folder}/server"
    program = shlex.join([*RL_TUI, "play", "student"])
    client = [*CONTROLLING, *KEPT_OPEN, *server.login("-tt"), f"{numbers}; exec {program}"]
    with LosableTerminal(client, size=(100, 30)) as terminal:
        terminal.wait_for("paused")
        yield terminal


def number_in(file: Path) -> int:
    return int(file.read_text(encoding="utf-8"))


def test_it_trains_steps_and_quits_over_ssh(tmp_path: Path) -> None:
    with serving(tmp_path) as server, student(server, tmp_path) as terminal:
        assert b"38;5;" in terminal.written  # 256 colours: ssh does not send COLORTERM
        terminal.press("sss")
        terminal.wait_for(r"step\s+3\b")
        terminal.press("1s")  # to the first slider
        terminal.wait_for(r"step\s+4\b")
        terminal.press("\x1b[C")
        terminal.wait_for(r"α step size\W+0\.1[1-9]")
        terminal.press("?")
        terminal.wait_for("Words  Pages")
        terminal.press("\x1b")
        terminal.resize(60, 17)
        terminal.wait_for("is 60×17")  # the program reports that it is too small
        terminal.resize(80, 24)
        terminal.wait_for("paused")
        terminal.press(" " + "+" * 9)
        terminal.wait_for(r"step\s+(\d+,\d{3},|[\d.]+ ?[MG])")
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before
    wait_until(lambda: is_gone(number_in(tmp_path / "program")), "the program is gone")


@pytest.mark.exhaustive("loses a terminal in two more ways")
@pytest.mark.parametrize("broken", ["stopped client", "server"])
def test_a_connection_that_breaks_leaves_no_process_and_loses_nothing(tmp_path: Path, broken: str) -> None:
    with serving(tmp_path) as server, student(server, tmp_path) as terminal:
        program = number_in(tmp_path / "program")
        terminal.press("sss")
        terminal.wait_for(r"step\s+3\b")
        if broken == "stopped client":
            terminal.press("+ ")
            terminal.wait_for(r"▶.*step\s+\d\d")
            os.killpg(terminal.process.pid, signal.SIGSTOP)
            aim = kept_step(tmp_path / "sessions") + 30
            wait_until(lambda: kept_step(tmp_path / "sessions") > aim, "it goes on while nobody looks")
            os.killpg(terminal.process.pid, signal.SIGKILL)
        else:
            os.kill(number_in(tmp_path / "server"), signal.SIGKILL)
        wait_until(lambda: is_gone(program), "the program ends")
    assert kept_step(tmp_path / "sessions") >= 3


@pytest.mark.exhaustive("starts another server")
def test_from_the_classroom_recipe_there_is_no_way_out(tmp_path: Path) -> None:
    with serving(tmp_path, classroom()) as server:
        needs_a_terminal = refused([*server.login(), "echo", "out"])
        assert "rl-tui: the playground needs a terminal" in needs_a_terminal
        refused([*server.transfer("sftp", "-b", "-"), f"{getpass.getuser()}@127.0.0.1"], b"pwd\n")
        refused([*server.transfer("scp"), __file__, f"{getpass.getuser()}@127.0.0.1:{tmp_path}/copy"])
        there = f"127.0.0.1:{server.port}"
        assert "forwarding failed" in refused(server.login("-W", there))
        assert "forwarding failed" in refused(server.login("-NR", f"0:{there}", "-oExitOnForwardFailure=yes"))
        with LosableTerminal([*CONTROLLING, *KEPT_OPEN, *server.login("-tt"), "sh"]) as terminal:
            terminal.wait_for("Begin here")
            terminal.press("\x1a")
            terminal.wait_for("no shell")
            terminal.press("qq")
            assert terminal.wait_for_end() == 0
    assert not (tmp_path / "copy").exists()


def refused(command: list[str], sent: bytes = b"") -> str:
    result = subprocess.run(command, input=sent, capture_output=True, timeout=DEADLINE, check=False)
    assert result.returncode != 0
    assert result.stdout.replace(b"sftp> pwd\n", b"") == b""
    return result.stderr.decode()
