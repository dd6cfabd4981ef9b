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
    """Return in two or three words how far one has come."""
    record = entry.record
    if record is None:
        return _NOT_BEGUN
    if record.finished:
        return _FINISHED
    return f"page {record.lesson.number_of(record.page) + 1} of {len(record.lesson.pages)}"


def lesson_details(entry: LessonEntry, look: Look) -> RenderableType:
    """Return the details of a lesson."""
    lesson, text = entry.lesson, look.palette.text
    rows = {label: Text(separated(line, look.glyphs)) for label, line in _lines(entry).items()}
    return Group(
        Text(to_ascii(lesson.summary, look.glyphs), text),
        Text("\nAfterwards you can", look.palette.dim),
        bullets(lesson.goals, look),
        Text(""),
        labelled(rows, look),
    )


def progress_line(found: LessonEntries) -> str:
    """Return in a sentence how far one has come in all lessons together."""
    records = [entry.record for entry in found.entries if entry.record is not None]
    if not records:
        return "Begin with the first: enter. Nothing moves on by itself."
    right = sum(record.predictions[0] for record in records)
    made = sum(record.predictions[1] for record in records)
    finished = f"{found.finished} of {len(found.entries)} finished"
    return f"{finished} · {right} of {counted(made, 'prediction')} right" if made else finished


def lesson_faults(error: ScenarioError, look: Look) -> Text:
    """Return every fault of a lesson file, a paragraph each."""
    text = Text("This lesson cannot be taken until its file is mended.\n", look.palette.text)
    for fault in error.faults:
        text.append(to_ascii(f"\n{fault}\n", look.glyphs), look.palette.bad)
    return text


def _lines(entry: LessonEntry) -> dict[str, str]:
    lesson, record = entry.lesson, entry.record
    takes = f"about {counted(lesson.minutes, 'minute')} · {counted(len(lesson.pages), 'page')}"
    if record is None:
        return {
            "takes": takes,
            "tasks": f"{len(lesson.tasks)}" if lesson.tasks else "none",
            "enter": "begins",
        }
    lesson = record.lesson  # as it was when it was begun
    page = lesson.page(record.page)
    right, made = record.predictions
    passed = sum(record.has_passed(page.id) for page in lesson.tasks)
    return {
        "takes": takes,
        "stands at": _FINISHED if record.finished else f"{state_of(entry)}: {page.title}",
        "tasks": f"{passed} of {len(lesson.tasks)} passed" if lesson.tasks else "none",
        "predictions": f"{right} of {made} right" if made else "none so far",
        "enter": "shows it from its first page, with all your answers"
        if record.finished
        else "goes on there",
        "r": "begins it again; what you did stays among the sessions",
    }
