"""Every shipped lesson passes the full check."""

from __future__ import annotations

from pathlib import Path

import pytest

from rl_tui.lessons.check import check_lesson
from rl_tui.lessons.figures.step_budget import FIGURE_STEPS, FILE_STEPS, StepBudget
from rl_tui.lessons.lesson import lesson_folder

pytestmark = [pytest.mark.process, pytest.mark.slow]


@pytest.mark.exhaustive("trains under many seeds", but=["loop"])
@pytest.mark.parametrize("path", sorted(lesson_folder().glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_lessons_have_no_faults(path: Path) -> None:
    budget = StepBudget()
    report = check_lesson(path, budget=budget)
    assert [str(fault) for fault in (*report.faults, *report.warnings)] == []
    assert 5 * max(budget.of_figures.values(), default=0) <= FIGURE_STEPS, "a budget with room"
    assert 5 * budget.taken <= FILE_STEPS
