"""The refusals of a kiosk."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from rl_tui.commands.line.screen import COMMANDS
from rl_tui.commands.main import RlTui, program
from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import VARIABLE, in_kiosk
from rl_tui.live.sessions.session import SessionError, read_session
from rl_tui.worlds.files.catalogue import find, read_catalogue
from rl_tui.worlds.files.shipped import shipped_folder


@pytest.fixture
def kiosk(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    before = dict(os.environ)
    monkeypatch.setattr(sys, "dont_write_bytecode", sys.dont_write_bytecode)
    os.environ[VARIABLE] = "1"
    yield
    os.environ.clear()
    os.environ.update(before)


def refusal(*args: str) -> str:
    result = CliRunner().invoke(program, list(args))
    assert result.exit_code in (1, 2)
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    return str(line)


@pytest.mark.parametrize("command", sorted(set(RlTui.modules) - set(COMMANDS)))
@pytest.mark.usefixtures("kiosk")
def test_it_has_no_other_commands(command: str) -> None:
    assert refusal(command, "x") == (
        f"rl-tui: kiosk mode has no {command}: it shows only scenarios of rl-tui, and opens no files"
    )


@pytest.mark.parametrize(
    "name", ["gym:FrozenLake-v1", "gym:os:X-v0", "/etc/passwd", "a.toml", "../frozenlake"]
)
@pytest.mark.usefixtures("kiosk")
def test_it_opens_shipped_scenarios_only(name: str) -> None:
    with pytest.raises(UserError, match="choose a scenario from rl-tui list"):
        find(name)


@pytest.mark.usefixtures("kiosk")
def test_it_opens_no_session(tmp_path: Path) -> None:
    with pytest.raises(SessionError, match="kiosk mode opens no files"):
        read_session(tmp_path / "a.json")


@pytest.mark.usefixtures("kiosk")
def test_it_imports_no_module() -> None:
    line = "rl-tui: kiosk mode imports no modules: leave out --allow-module"
    assert refusal("play", "frozenlake", "--allow-module", "antigravity") == line


def test_the_user_s_own_scenarios_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.toml").write_text("[bandit]\narms = 2\n")
    monkeypatch.setattr("rl_tui.worlds.files.catalogue.user_folder", lambda: tmp_path)
    assert "mine" in {each.id for each in read_catalogue().scenarios}
    monkeypatch.setenv(VARIABLE, "1")
    shipped = {path.stem for path in shipped_folder().glob("*.toml")}
    assert {each.id for each in read_catalogue().scenarios} == shipped
    with pytest.raises(UserError, match="there is no scenario"):
        find("mine")


@pytest.mark.parametrize(("value", "is_one"), [("1", True), ("yes", True), ("0", False), ("", False)])
def test_the_variable(monkeypatch: pytest.MonkeyPatch, value: str, is_one: bool) -> None:
    monkeypatch.setenv(VARIABLE, value)
    assert in_kiosk() is is_one


@pytest.mark.process
@pytest.mark.parametrize(
    "args", [["--kiosk", "train", "frozenlake"], ["--kiosk", "screenshot", "--out", "a.svg"]]
)
def test_the_flag_counts_for_every_command(args: list[str], tmp_path: Path) -> None:
    ended = subprocess.run(
        [sys.executable, "-m", "rl_tui", *args], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert ended.returncode == 1
    assert "kiosk mode has no" in ended.stderr
    assert list(tmp_path.iterdir()) == []


LIMITED = """
import os, resource
os.environ["TEXTUAL_LOG"] = os.environ["TEXTUAL"] = os.environ["TEXTUAL_SCREENSHOT"] = "log"
os.environ["TEXTUAL_DRIVER"] = "textual.drivers.web_driver:WebDriver"
from rl_tui.commands.line.screen import confine, enter_kiosk
enter_kiosk("play")
confine()
try:
    print("x" * 10, file=open("written", "w"), flush=True)
except OSError as refusal:
    print(refusal.strerror)
try:
    resource.setrlimit(resource.RLIMIT_FSIZE, (1, 1))
except ValueError:
    print("not taken back")
print(sorted(name for name in os.environ if name.startswith("TEXTUAL")))
from rl_tui.screen.terminal.driver_choice import IN_BROWSER
os.environ["TEXTUAL_DRIVER"] = IN_BROWSER
enter_kiosk("play")
print(os.environ["TEXTUAL_DRIVER"] == IN_BROWSER)
"""


@pytest.mark.process
def test_the_system_holds_it_to_its_word(tmp_path: Path) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", LIMITED],
        env={**os.environ, VARIABLE: "1"},
        capture_output=True,
        text=True,
        check=True,
        cwd=tmp_path,
    )
    lines = ended.stdout.splitlines()
    assert lines[0] == "File too large"
    assert lines[-2:] == ["[]", "True"], "whatever else a driver is, Textual would import it"
    assert (tmp_path / "written").read_bytes() == b""
