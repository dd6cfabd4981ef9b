"""The guide to writing lessons builds a valid lesson from nothing."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from rl_tui.commands.main import program
from rl_tui.lessons.lesson import read_lesson

pytestmark = pytest.mark.unit

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def written() -> str:
    """Return the lesson that the guide builds, part by part."""
    guide = (DOCS / "how-to/write-a-lesson.md").read_text(encoding="utf-8")
    return "\n".join(re.findall(r"```toml\n(.*?)```", guide, re.DOTALL))


def test_its_parts_are_a_lesson_without_a_fault(written: str, tmp_path: Path) -> None:
    path = tmp_path / "corridor.toml"
    path.write_text(written, encoding="utf-8")
    result = CliRunner().invoke(program, ["check", str(path)])
    assert (result.exit_code, result.stderr) == (0, "")
    lesson = read_lesson(path)
    assert [page.id for page in lesson.pages] == ["worth", "smaller", "walk"]


def test_a_number_in_it_that_is_not_so_is_found(written: str, tmp_path: Path) -> None:
    path = tmp_path / "corridor.toml"
    path.write_text(written.replace('value = "0.729"', 'value = "0.81"'), encoding="utf-8")
    result = CliRunner().invoke(program, ["check", str(path)])
    assert result.exit_code == 1
    assert "figures.start.value" in result.stderr
    assert "0.729" in result.stderr


def test_the_lessons_listed_are_the_ones_that_learn_lists() -> None:
    listed = json.loads(CliRunner().invoke(program, ["learn", "--list", "--json"]).stdout)
    page = (DOCS / "reference/worlds.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| `([a-z-]+)` ", page.partition("## Lessons")[2], re.MULTILINE)
    assert [each["id"] for each in listed] == table
