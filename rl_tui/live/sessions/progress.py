"""A learner's progress in each lesson, read from the saved sessions."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from rl_tui.lessons.catalogue import read_lessons
from rl_tui.lessons.file.view import LessonRecord, begun
from rl_tui.live.sessions.document import stored_source
from rl_tui.live.sessions.session import StoredSession, all_sessions_in

if TYPE_CHECKING:
    from rl_tui.common.errors import ScenarioError
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.live.sessions.document import StoredLesson


# Progress in saved sessions


@dataclass(frozen=True, slots=True)
class LessonProgress:
    """How far a lesson has come, in the ``session`` of it that was saved last.

    ``page`` is the id of the open page. ``finished`` says whether it was ever, in any session: read to its
    end, and every task passed.
    """

    session: StoredSession
    page: str
    tasks_passed: int
    tasks: int
    predictions_right: int
    predictions_made: int
    finished: bool


class StoredProgress:
    """What the sessions in ``folder`` tell of lessons, read once; None: no sessions are kept."""

    def __init__(self, folder: Path | None) -> None:
        self._sessions = dict[tuple[str, str], list[StoredSession]]()
        for session in [] if folder is None else all_sessions_in(folder)[0]:
            stored = session.document.lesson
            if stored is not None:
                self._sessions.setdefault((stored.id, stored.source), []).append(session)

    def of(self, lesson: Lesson, variant: str = "") -> LessonProgress | None:
        """Return how far ``lesson`` has come, in that ``variant`` or in any; None where it is not begun."""
        sessions = [
            session
            for session in self._sessions.get((lesson.id, stored_source(lesson)), [])
            if session.document.lesson and variant in ("", session.document.lesson.variant)
        ]
        stored = sessions[0].document.lesson if sessions else None
        if stored is None:
            return None
        first_answers = {given.page: given for given in reversed(stored.given)}
        # the open page may not have shown the truth yet
        told = [page.id for page in lesson.counted_predictions if stored.finished or page.id != stored.page]
        made = [first_answers[page] for page in told if page in first_answers]
        pages = {page.id for page in lesson.pages}
        documents = [each.document.lesson for each in sessions if each.document.lesson]
        tasks = len(lesson.tasks)
        return LessonProgress(
            session=sessions[0],
            page=stored.page if stored.page in pages else lesson.pages[0].id,
            tasks_passed=_passed(lesson, stored),
            tasks=tasks,
            predictions_right=sum(given.right for given in made),
            predictions_made=len(made),
            finished=any(each.finished and _passed(lesson, each) == tasks for each in documents),
        )


def _passed(lesson: Lesson, stored: StoredLesson) -> int:
    passed = {each.page for each in stored.passed}
    return sum(page.id in passed for page in lesson.tasks)


# The list of lessons


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
