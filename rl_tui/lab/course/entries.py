"""The shipped lessons as a learner finds them: each with how far they have come."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from rl_tui.lab.course.progress import LessonProgress, StoredProgress
from rl_tui.lab.lessons.catalogue import read_lessons
from rl_tui.lab.lessons.record import LessonRecord, begun

if TYPE_CHECKING:
    from rl_tui.common.errors import ScenarioError
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.sessions.session import StoredSession


@dataclass(frozen=True, slots=True)
class LessonEntry:
    """A shipped ``lesson`` and how far it has come, None where it is not begun."""

    lesson: Lesson
    progress: LessonProgress | None = None

    @property
    def is_finished(self) -> bool:
        """Whether it was ever taken to its end, every task of it passed."""
        return self.progress is not None and self.progress.finished

    @property
    def is_at_end(self) -> bool:
        """Whether it was read to its end in its newest session: then it is a reference."""
        stored = None if self.progress is None else self.progress.session.document.lesson
        return stored is not None and stored.finished


@dataclass(frozen=True, slots=True)
class LessonStart:
    """A lesson whose open page is to begin its run; ``session`` is where it is kept, None for a new one."""

    record: LessonRecord
    session: StoredSession | None = None


class LessonEntries(NamedTuple):
    """The lessons in their order, and what is wrong with files that give none."""

    entries: list[LessonEntry]
    broken: list[ScenarioError]

    @property
    def goes_on_at(self) -> str:
        """The id of the lesson in progress that was saved last, else of the first not read to its end.

        Empty where all are.
        """
        under_way = [(each.progress.session, each) for each in self.entries if each.progress]
        begun = [(session.saved, session.written, each) for session, each in under_way if not each.is_at_end]
        if begun:
            return max(begun, key=lambda each: (each[0], each[1][1]))[2].lesson.id
        return next((each.lesson.id for each in self.entries if not each.is_at_end), "")

    @property
    def finished(self) -> int:
        """How many lessons are finished."""
        return sum(entry.is_finished for entry in self.entries)


def lesson_entries(sessions: Path | None) -> LessonEntries:
    """Return every shipped lesson; ``sessions`` is the folder of sessions, None where none are kept."""
    found, progress = read_lessons(), StoredProgress(sessions)
    entries = [LessonEntry(lesson, progress.of(lesson)) for lesson in found.lessons]
    return LessonEntries(entries, found.broken)


def start_of(lesson: Lesson, progress: LessonProgress | None) -> LessonStart | StoredSession:
    """Return what a lesson goes on with: its newest session; one at its end, its first page as a reference.

    Raises UserError where that session cannot be used here. It may import Gymnasium.
    """
    if progress is None:
        return LessonStart(begun(lesson))
    record = progress.session.record().lesson
    if record is None or not record.finished:
        return progress.session
    return LessonStart(record.open(record.lesson.pages[0].id), progress.session)
