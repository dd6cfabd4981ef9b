"""The report of ``grade`` on sessions of a lesson."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rl_tui.commands.line.output import can_print, columns
from rl_tui.common.findings import printable
from rl_tui.common.words import counted
from rl_tui.lessons.lesson import Lesson
from rl_tui.live.sessions.grade import PROVES, GradedSession


def session_grade(lesson: Lesson, graded: GradedSession) -> str:
    """Return the tasks, conditions and predictions of one session."""
    lines = [f"{lesson.title}: {_passed_tasks(graded)}", ""]
    for task in graded.tasks:
        lines.append(f"{_mark(task.passed)} {task.id}: {task.title}")
        for each in task.conditions:
            found = f" ({each.found})" if each.found else ""
            lines.append(f"    {_mark(each.holds is True)} {each.text}{found}")
    lines += ["", *_ending(graded)]
    return "\n".join(map(printable, lines))


def session_table(lesson: Lesson, graded: Sequence[GradedSession]) -> str:
    """Return a table of sessions by tasks."""
    head = ["session", *(page.id for page in lesson.tasks), "passed", "predictions right"]
    rows = [head, *(_row(each, len(lesson.tasks)) for each in graded)]
    remarks = [
        f"{each.path.name}: {remark}" for each in graded for remark in (each.fault, *each.remarks) if remark
    ]
    parts = [f"{lesson.title}: {counted(len(graded), 'session')}", "", columns(rows)]
    if remarks:
        parts += ["", *map(printable, remarks)]
    return "\n".join([*parts, "", PROVES])


def _row(graded: GradedSession, tasks: int) -> list[str]:
    name = printable(graded.path.name)
    if graded.fault:
        return [name, *("-" for _ in range(tasks)), "-", "-"]
    marks = [_mark(task.passed) for task in graded.tasks]
    right, made, _ = graded.predictions
    return [name, *marks, _passed_tasks(graded), f"{right} of {made}" if made else "-"]


def _passed_tasks(graded: GradedSession) -> str:
    return f"{sum(task.passed for task in graded.tasks)} of {len(graded.tasks)}"


def _ending(graded: GradedSession) -> Iterator[str]:
    yield from graded.remarks
    right, made, locked = graded.predictions
    if made:
        yield f"Predictions: {right} of {made} right, {locked} of {made} made before the run moved on."
    yield PROVES


def _mark(holds: bool) -> str:
    # ASCII if stdout cannot encode these
    sign, plain = ("✓", "x") if holds else ("✗", "-")
    return sign if can_print(sign) else plain
