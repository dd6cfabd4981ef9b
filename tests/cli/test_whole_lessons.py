"""Every shipped lesson is checked wholly: figures over many seeds, and programs that are watched."""

from __future__ import annotations

from pathlib import Path

import pytest

from rl_tui.lab.course.check import check_lesson
from rl_tui.lab.lessons.lesson import lesson_folder

pytestmark = [pytest.mark.process, pytest.mark.slow]


@pytest.mark.exhaustive("trains under many seeds", but=["loop"])
@pytest.mark.parametrize("path", sorted(lesson_folder().glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_lessons_have_no_faults(path: Path) -> None:
    report = check_lesson(path)
    assert [str(fault) for fault in (*report.faults, *report.warnings)] == []
