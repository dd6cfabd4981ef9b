"""``rl-tui new`` and ``edit``."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from rl_tui.commands.main import program

pytestmark = pytest.mark.unit


def test_a_new_file_is_played_checked_and_never_written_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    new = ["new", "my-maze", "--template", "maze", "--rows", "7", "--columns", "7", "--seed", "3"]
    result = CliRunner().invoke(program, new)
    assert (result.exit_code, result.stdout.splitlines()[0]) == (0, "rl-tui edit my-maze.toml")
    text = Path("my-maze.toml").read_text(encoding="utf-8")
    assert 'title = "my-maze"' in text
    assert CliRunner().invoke(program, ["check", "my-maze.toml"]).exit_code == 0
    again = CliRunner().invoke(program, ["new", "my-maze"])
    assert again.exit_code == 1
    assert "already exists" in again.stderr
    assert Path("my-maze.toml").read_text(encoding="utf-8") == text


@pytest.mark.parametrize("name", ["a b", "ünï 世界", "mine.toml", "a'b\"c", "[x]", "-x", "n" * 100])
def test_whatever_it_is_called_what_is_written_is_a_scenario(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(program, ["new", "--", name])
    assert result.exit_code == 0
    (written,) = tmp_path.iterdir()
    assert written.name == f"{name.removesuffix('.toml')}.toml"
    commands = [shlex.split(line) for line in result.stdout.splitlines()]
    assert [each[1] for each in commands] == ["edit", "check"]
    for _, *arguments in commands[1:]:
        assert CliRunner().invoke(program, arguments[:1] + arguments[2:]).exit_code == 0


@pytest.mark.parametrize("name", ["../mine", "", ".", "..", ".toml"])
def test_a_name_is_no_path(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(program, ["new", name])
    assert result.exit_code == 1
    assert "expected a name" in result.stderr


@pytest.mark.parametrize(
    ("scenario", "fault"),
    [("taxi", "cannot be edited"), ("no-such", "no-such"), ("no-such.toml", "rl-tui new")],
)
def test_what_cannot_be_drawn_says_so_before_the_screen_is_taken(
    scenario: str, fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rl_tui.commands.line.screen.require_terminal", lambda: None)
    result = CliRunner().invoke(program, ["edit", scenario])
    assert result.exit_code == 1
    assert fault in result.stderr
