"""``rl-tui agent new``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from called import assert_refused
from called import called as rl_tui
from programs.course_agents import UPDATES

from rl_tui.programs.own_agents.binding import Style

STYLES = [style.value for style in Style]


def filled_in(text: str, style: str) -> str:
    lines = text.split("\n")
    place = next(place for place, line in enumerate(lines) if "TODO" in line)
    return "\n".join([*lines[:place], UPDATES[style], *lines[place + 1 :]])


@pytest.mark.exhaustive("learns in every style", but=["function"])
@pytest.mark.process
@pytest.mark.parametrize("style", STYLES)
def test_a_skeleton_learns_nothing_until_its_update_is_written(style: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    assert rl_tui("agent", "new", str(path), "--style", style).exit_code == 0
    grade = ("grade", str(path), "--scenario", "frozenlake", "--seeds", "1", "--json", "--episodes")
    result = rl_tui(*grade, "20")
    assert result.exit_code == 1
    [before] = json.loads(result.stdout)["submissions"]
    learned = before["runs"][0]["expected_return"]
    assert learned == pytest.approx(0.013939795959171436)
    path.write_text(filled_in(path.read_text(), style))
    result = rl_tui(*grade, "600")
    assert result.exit_code == 0, result.stdout
    [after] = json.loads(result.stdout)["submissions"]
    assert after["passed"]
    assert after["share_of_best"]["mean"] == pytest.approx(1.0)
    assert after["findings"] == []


@pytest.mark.parametrize("style", STYLES)
def test_a_skeleton_says_what_is_missing(style: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    result = rl_tui("agent", "new", str(path), "--style", style)
    assert (
        result.stdout == f"rl-tui play frozenlake --agent {path}\nrl-tui grade {path} --scenario frozenlake\n"
    )
    text = path.read_text()
    assert "6.8" in text
    assert "Q(S, A) ← Q(S, A) + α [R + γ max_a Q(S′, a) − Q(S, A)]" in text
    assert text.count("TODO") == 1


def test_what_is_there_is_not_written_over(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text("my work")
    result = rl_tui("agent", "new", str(path))
    assert result.exit_code == 1
    assert f'"{path}" already exists' in result.stderr
    assert path.read_text() == "my work"


@pytest.mark.parametrize(
    ("name", "said"), [("mine.txt", "ends in .py"), ("no/such/folder/mine.py", "cannot be written")]
)
def test_a_file_that_cannot_be_written(name: str, said: str, tmp_path: Path) -> None:
    assert_refused(rl_tui("agent", "new", str(tmp_path / name)), 1, said)
