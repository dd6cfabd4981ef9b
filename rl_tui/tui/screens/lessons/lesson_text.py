"""What is said of a lesson: what it is about, what one will be able to do, and how far one has come."""

from __future__ import annotations

from typing import Final

from rich.console import Group, RenderableType
from rich.text import Text

from rl_tui.common.errors import ScenarioError
from rl_tui.common.words import counted
from rl_tui.lab.course.entries import LessonEntries, LessonEntry
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.screens.catalogue.facts import bullets, labelled
from rl_tui.tui.theme.look import Look

DONE: Final = "✓"
_NOT_BEGUN: Final = "not begun"
_FINISHED: Final = f"{DONE} finished"


def state_of(entry: LessonEntry) -> str:
    """Return in a few words how far one has come."""
    progress = entry.progress
    if progress is None:
        return _NOT_BEGUN
    if entry.is_at_end:
        done = progress.finished or progress.tasks_passed == progress.tasks
        passed = f"{progress.tasks_passed} of {counted(progress.tasks, 'task')}"
        return _FINISHED if done else f"at its end · {passed}"
    here = f"page {entry.lesson.number_of(progress.page) + 1} of {len(entry.lesson.pages)}"
    return f"{DONE} {here}" if progress.finished else here


def lesson_details(entry: LessonEntry, look: Look) -> RenderableType:
    """Return the details of a lesson."""
    lesson, text = entry.lesson, look.palette.text
    rows = {label: Text(separated(line, look.glyphs)) for label, line in _lines(entry).items()}
    return Group(
        Text(to_ascii(lesson.summary, look.glyphs), text),
        Text(""),
        labelled(rows, look),
        Text("\nAfterwards you can", look.palette.dim),
        bullets(lesson.goals, look),
    )


def progress_line(found: LessonEntries) -> str:
    """Return in a sentence how far one has come in all lessons together."""
    begun = [entry.progress for entry in found.entries if entry.progress is not None]
    if not begun:
        return "Begin with the first: enter. Nothing moves on by itself."
    right = sum(progress.predictions_right for progress in begun)
    made = sum(progress.predictions_made for progress in begun)
    finished = f"{found.finished} of {len(found.entries)} finished"
    return f"{finished} · {right} of {counted(made, 'prediction')} right" if made else finished


def lesson_faults(error: ScenarioError, look: Look) -> Text:
    """Return every fault of a lesson file, a paragraph each."""
    text = Text("This lesson cannot be taken until its file is mended.\n", look.palette.text)
    for fault in error.faults:
        text.append(to_ascii(f"\n{fault}\n", look.glyphs), look.palette.bad)
    return text


def _lines(entry: LessonEntry) -> dict[str, str]:
    lesson, progress = entry.lesson, entry.progress
    if progress is None:
        return {
            "takes": f"about {lesson.minutes} min · {counted(len(lesson.pages), 'page')}",
            "tasks": f"{len(lesson.tasks) or 'none'}",
            "enter": "begins",
        }
    made, tasks = progress.predictions_made, progress.tasks
    here = f"{state_of(entry)}: {lesson.page(progress.page).title}"
    return {
        "stands at": state_of(entry) if entry.is_at_end else here,
        "tasks": f"{progress.tasks_passed} of {tasks} passed" if tasks else "none",
        "predictions": f"{progress.predictions_right} of {made} right" if made else "none so far",
        "enter": "opens it as a reference" if entry.is_at_end else "goes on there",
    }
