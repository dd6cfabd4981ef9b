"""What is wrong with a lesson file: its form, its numbers, its tasks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rl_tui.common.errors import Fault, ScenarioError, UserError
from rl_tui.common.findings import Finding, place
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.lab.course.checks.asked import page_findings
from rl_tui.lab.course.checks.numerals import numeral_findings
from rl_tui.lab.lessons.figures.figures import Figures
from rl_tui.lab.lessons.lesson import Lesson, is_lesson_text, read_lesson
from rl_tui.lab.lessons.setups import recipe_of
from rl_tui.lab.lessons.variants import variants_of
from rl_tui.lab.run.recipe import begin
from rl_tui.worlds.files.toml_file import tables_in

OnChecked = Callable[[int, int, str], None]
"""Hears how much of how much is checked, and what comes next."""


def ignore(done: int, wanted: int, what: str) -> None:
    """Ignore how far a check has come."""


@dataclass(slots=True)
class LessonReport:
    """What a check found: ``faults`` in the order in which it looks, and ``warnings``, whole lines."""

    faults: list[Fault] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def is_lesson_file(path: str | Path) -> bool:
    """Return whether a file holds a lesson rather than a scenario; False where it cannot be read."""
    try:
        return is_lesson_text(read_text(Path(path)))
    except UnreadableError:
        return False


def check_lesson(path: str | Path, *, quick: bool = False, on_checked: OnChecked = ignore) -> LessonReport:
    """Return what is wrong with the lesson in a file, each of its variants as a lesson of its own.

    ``quick`` leaves out what takes many seeds.
    """
    report = LessonReport()
    try:
        lesson = read_lesson(path)
    except ScenarioError as error:
        report.faults += error.faults
        return report
    names = variants_of(tables_in(read_text(Path(path))))
    for variant in names or ("",):
        try:
            lesson = read_lesson(path, variant)
        except ScenarioError as error:
            report.faults += error.faults
            continue
        _check(lesson, report, quick=quick, on_checked=on_checked)
    return report


def _check(lesson: Lesson, report: LessonReport, *, quick: bool, on_checked: OnChecked) -> None:
    """Add to ``report`` what is wrong with one variant."""
    file = f"{lesson.source} (variant {lesson.variant})" if lesson.variant else str(lesson.source)
    unplayable = list(_setup_findings(lesson))
    for finding in unplayable or _findings(lesson, quick=quick, on_checked=on_checked):
        report.faults.append(Fault(file, place(finding.location), finding.found, finding.expected))


def _setup_findings(lesson: Lesson) -> Iterator[Finding]:
    """Yield the setups that cannot be played: without them nothing else can be told."""
    for name in lesson.setups:
        try:
            begin(recipe_of(lesson, name))
        except UserError as fault:
            yield Finding(("setups", name), str(fault), "a setup that can be played")


def _findings(lesson: Lesson, *, quick: bool, on_checked: OnChecked) -> Iterator[Finding]:
    known: dict[Any, Any] = {}
    raw = tables_in(lesson.text)
    figures = Figures(lesson, known)
    for done, name in enumerate(lesson.figures):
        on_checked(done, len(lesson.figures), name)
        if not (quick and figures.needs_seeds(name)):
            finding = figures.finding(name)
            if finding is not None:
                yield finding
    yield from page_findings(lesson, raw, figures, quick=quick)
    yield from numeral_findings(lesson, raw, known)
