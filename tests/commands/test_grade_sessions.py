"""``rl-tui grade`` with a lesson."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from called import assert_refused
from click.testing import CliRunner, Result
from lessons.lesson_sessions import TEXT, all_done, lesson, write

from rl_tui.commands.main import program
from rl_tui.lessons.file.view import begun

PROVES = "A session proves the run, not who made it."


def grade(*args: object, **how: str) -> Result:
    return CliRunner(**how).invoke(program, ["grade", *map(str, args)])


@pytest.fixture
def evening(tmp_path: Path) -> Path:
    path = tmp_path / "evening.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "sessions"
    path.mkdir()
    write(path, "all.json", all_done(lesson()))
    write(path, "none.json", begun(lesson()))
    return path


def test_a_session(folder: Path, evening: Path) -> None:
    result = grade(folder / "all.json", evening)
    assert result.exit_code == 0
    assert "An evening: 3 of 3" in result.stdout
    assert "✓ go: Go by yourself\n    ✓ two steps by hand (2)\n" in result.stdout
    assert "✗ a million" in result.stdout
    assert "1 of 1 right, 1 of 1 made before" in result.stdout
    assert result.stdout.endswith(f"{PROVES}\n")
    assert result.stderr == ""


def test_a_session_as_json(folder: Path, evening: Path) -> None:
    result = grade(folder / "none.json", evening, "--json")
    report = json.loads(result.stdout)
    assert result.exit_code == 1
    assert (report["lesson"], report["passed"]) == ("evening", False)
    assert [task["id"] for task in report["tasks"]] == ["go", "never", "lake"]
    assert report["tasks"][2]["conditions"] == [{"text": "fifty steps", "holds": False}]
    assert report["predictions"] == {"right": 0, "made": 0, "locked": 0}


def test_a_folder(folder: Path, evening: Path) -> None:
    (folder / "broken.json").write_text("{")
    result = grade(folder, evening)
    assert result.exit_code == 1
    rows = {line.split()[0]: line.split()[1:] for line in result.stdout.splitlines() if ".json " in line}
    assert rows == {
        "all.json": ["✓", "✓", "✓", "3", "of", "3", "1", "of", "1"],
        "none.json": ["✗", "✗", "✗", "0", "of", "3", "-"],
        "broken.json": ["-", "-", "-", "-", "-"],
    }
    assert "broken.json: not JSON" in result.stdout
    assert result.stdout.endswith(f"{PROVES}\n")


def test_a_folder_as_json(folder: Path, evening: Path) -> None:
    result = grade(folder, evening, "--json")
    reports = json.loads(result.stdout)
    assert [(Path(each["session"]).name, each["passed"]) for each in reports] == [
        ("all.json", True),
        ("none.json", False),
    ]
    (folder / "none.json").unlink()
    assert grade(folder, evening, "--json").exit_code == 0


def test_where_there_are_no_ticks_letters_do(folder: Path, evening: Path) -> None:
    result = grade(folder / "all.json", evening, charset="ascii")
    assert "x go: Go by yourself\n" in result.stdout
    assert "- a million" in result.stdout


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (("{all}",), "is a session: name its lesson after the file"),
        (
            ("{folder}",),
            "To grade an agent, add its world: --scenario NAME. To grade sessions, add their lesson",
        ),
        (("{all}", "{lesson}", "--seeds", "3"), "--seeds works only for submissions"),
        (("{all}", "{lesson}", "--scenario", "student"), "--scenario works only for submissions"),
        (("agent.py", "{lesson}"), "agent.py is a submission: give --scenario"),
    ],
)
def test_what_does_not_go_together(args: tuple[str, ...], message: str, folder: Path, evening: Path) -> None:
    assert_refused(
        grade(*(each.format(all=folder / "all.json", folder=folder, lesson=evening) for each in args)),
        2,
        message,
    )


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (("{all}", "no-such-lesson"), "there is no lesson"),
        (("{folder}/nowhere.json", "{lesson}"), "no such file"),
        (("{lesson}", "{lesson}"), "not JSON"),
        (("{empty}", "{lesson}"), "found no session in this folder"),
    ],
)
def test_what_cannot_be_graded(
    args: tuple[str, ...], message: str, folder: Path, evening: Path, tmp_path: Path
) -> None:
    (tmp_path / "empty").mkdir()
    names = {"all": folder / "all.json", "folder": folder, "lesson": evening, "empty": tmp_path / "empty"}
    assert_refused(grade(*(each.format(**names) for each in args)), 1, message)
