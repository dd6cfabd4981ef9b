"""What is wrong with a lesson file: its form, its numbers, its tasks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rl_tui.common.errors import Fault, ScenarioError, first_of
from rl_tui.common.findings import Finding, in_file_order, place
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.lab.course.checks.asked import page_findings
from rl_tui.lab.course.checks.numerals import numeral_findings
from rl_tui.lab.course.checks.tasks import TaskCheck
from rl_tui.lab.lessons.figures.figures import LessonFigures
from rl_tui.lab.lessons.figures.step_budget import StepBudget
from rl_tui.lab.lessons.judging.world_faults import reference_faults
from rl_tui.lab.lessons.lesson import Lesson, is_lesson_text, read_lesson
from rl_tui.lab.lessons.variants import readable, variants_of
from rl_tui.worlds.files.toml_file import tables_in

OnChecked = Callable[[int, int, str], None]
"""Hears how much of how much is checked, and what comes next."""
_Placed = tuple[str, str, str]


def ignore(done: int, wanted: int, what: str) -> None:
    """Ignore how far a check has come."""


@dataclass(slots=True)
class LessonReport:
    """What a check found: ``faults``, the first 100 of them, and ``warnings``, which are none."""

    faults: list[Fault] = field(default_factory=list)
    warnings: list[Fault] = field(default_factory=list)


def is_lesson_file(path: str | Path) -> bool:
    """Return whether a file holds a lesson rather than a scenario; False where it cannot be read."""
    try:
        return is_lesson_text(read_text(Path(path)))
    except UnreadableError:
        return False


def check_lesson(
    path: str | Path,
    *,
    quick: bool = False,
    on_checked: OnChecked = ignore,
    budget: StepBudget | None = None,
) -> LessonReport:
    """Return what is wrong with the lesson in a file, each of its variants as a lesson of its own.

    ``quick`` leaves out what takes many seeds. What every variant has is told once, of the first.
    All variants share the ``budget`` of steps.
    """
    report, budget = LessonReport(), budget or StepBudget()
    try:
        lessons = [read_lesson(path)]
        names = variants_of(tables_in(readable(read_text(Path(path)))))
        lessons += [read_lesson(path, name) for name in names[1:]]
    except ScenarioError as error:
        report.faults += error.faults
        return report
    counted = _Counted(on_checked, sum(map(_amount, lessons)))
    seen = set[tuple[str, str, str]]()
    for lesson in lessons:
        faults, warnings = _LessonCheck(lesson, counted, budget, quick=quick).findings()
        file = f"{path} (variant {lesson.variant})" if lesson.variant else str(path)
        for findings, reported in ((faults, report.faults), (warnings, report.warnings)):
            reported += [Fault(file, *each) for each in findings if each not in seen]
            seen.update(findings)
    report.faults = list(first_of(report.faults))
    return report


class _Counted:
    """Counts what was checked."""

    def __init__(self, on_checked: OnChecked, wanted: int) -> None:
        self._on_checked = on_checked
        self._wanted = wanted
        self._done = 0

    def next(self, what: str) -> None:
        """Say that ``what`` is checked next."""
        self._on_checked(self._done, self._wanted, what)
        self._done += 1


def _amount(lesson: Lesson) -> int:
    """Return how much there is to check."""
    tasks = [page.task for page in lesson.tasks if page.task is not None]
    attempts = sum(len(task.accepts) + len(task.rejects) for task in tasks)
    return len(lesson.figures) + len(tasks) + attempts * (2 if lesson.variant else 1)


def _placed(findings: list[Finding], raw: Mapping[str, Any]) -> list[_Placed]:
    """Return ``findings`` in the order of the file."""
    return [(place(each.location), each.found, each.expected) for each in in_file_order(findings, raw)]


class _LessonCheck:
    """Looks for all that is wrong with ``lesson``, one variant of it."""

    def __init__(self, lesson: Lesson, counted: _Counted, budget: StepBudget, *, quick: bool) -> None:
        self._lesson = lesson
        self._counted = counted
        self._quick = quick
        self._budget = budget
        self._figures = LessonFigures(lesson, budget)

    def findings(self) -> tuple[list[_Placed], list[_Placed]]:
        """Return faults and warnings: each its place, what was found, and what was expected."""
        raw = tables_in(self._lesson.text)
        unknown = [(each.place, each.found, each.expected) for each in reference_faults(self._lesson)]
        if any(where.startswith("setups") for where, _, _ in unknown):
            return unknown, []  # without a world nothing else can be told
        faults = list(self._figure_findings())
        faults += page_findings(self._lesson, raw, self._figures, quick=self._quick)
        faults += numeral_findings(self._lesson, raw, self._figures)
        warnings = list[Finding]()
        for number, page in enumerate(self._lesson.pages):
            if page.task is not None:
                check = TaskCheck(self._lesson, number, page, page.task, self._budget, quick=self._quick)
                warnings += check.warnings()
                if not unknown:
                    faults += self._task_findings(check)
        return [*unknown, *_placed(faults, raw)], _placed(warnings, raw)

    def _figure_findings(self) -> Iterator[Finding]:
        for name in self._lesson.figures:
            self._counted.next(name)
            if self._quick and self._figures.needs_seeds(name):
                continue
            finding = self._figures.finding(name)
            if finding is not None:
                yield finding

    def _task_findings(self, check: TaskCheck) -> Iterator[Finding]:
        found = list(check.findings(self._figures, self._counted.next))
        yield from found
        if self._lesson.variant and not self._quick and not found:
            yield from check.findings_over_seeds(self._counted.next)
