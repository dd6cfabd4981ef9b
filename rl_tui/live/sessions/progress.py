"""A learner's progress in each lesson, from the saved sessions."""

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
    """Progress in the `session` saved last.

    `finished` is True if any session reached the end with every task passed.
    """

    session: StoredSession
    page: str
    tasks_passed: int
    tasks: int
    predictions_right: int
    predictions_made: int
    finished: bool


class StoredProgress:
    """Progress in the sessions of `folder`, read once."""

    def __init__(self, folder: Path | None) -> None:
        self._sessions = dict[tuple[str, str], list[StoredSession]]()
        for session in [] if folder is None else all_sessions_in(folder)[0]:
            stored = session.document.lesson
            if stored is not None:
                self._sessions.setdefault((stored.id, stored.source), []).append(session)

    def of(self, lesson: Lesson, variant: str = "") -> LessonProgress | None:
        """Return the progress, if begun, in one `variant` or any."""
        sessions = [
            session
            for session in self._sessions.get((lesson.id, stored_source(lesson)), [])
            if session.document.lesson and variant in ("", session.document.lesson.variant)
        ]
        stored = sessions[0].document.lesson if sessions else None
        if stored is None:
            return None
        first_answers = {given.page: given for given in reversed(stored.given)}
        # the open page may not have revealed the answer yet
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
    """A shipped lesson with its progress, if begun."""

    lesson: Lesson
    progress: LessonProgress | None = None

    @property
    def is_finished(self) -> bool:
        """True if finished, with every task passed."""
        return self.progress is not None and self.progress.finished

    @property
    def is_at_end(self) -> bool:
        """True if its newest session is at the end."""
        stored = None if self.progress is None else self.progress.session.document.lesson
        return stored is not None and stored.finished


@dataclass(frozen=True, slots=True)
class LessonStart:
    """A lesson whose open page begins its run, in a new session if `session` is None."""

    record: LessonRecord
    session: StoredSession | None = None


class LessonEntries(NamedTuple):
    """The lessons, and the errors of other files."""

    entries: list[LessonEntry]
    broken: list[ScenarioError]

    @property
    def goes_on_at(self) -> str:
        """Id of the unfinished lesson saved last, else of the first, or ""."""
        under_way = [(each.progress.session, each) for each in self.entries if each.progress]
        begun = [(session.saved, session.written, each) for session, each in under_way if not each.is_at_end]
        if begun:
            return max(begun, key=lambda each: (each[0], each[1][1]))[2].lesson.id
        return next((each.lesson.id for each in self.entries if not each.is_at_end), "")

    @property
    def finished(self) -> int:
        """Number of finished lessons."""
        return sum(entry.is_finished for entry in self.entries)


def lesson_entries(sessions: Path | None) -> LessonEntries:
    """Return all shipped lessons, with progress in `sessions`."""
    found, progress = read_lessons(), StoredProgress(sessions)
    entries = [LessonEntry(lesson, progress.of(lesson)) for lesson in found.lessons]
    return LessonEntries(entries, found.broken)


def start_of(lesson: Lesson, progress: LessonProgress | None) -> LessonStart | StoredSession:
    """Return the session with which a lesson continues, or its first page after the end.

    This may import Gymnasium. Raises UserError for an unusable session.
    """
    if progress is None:
        return LessonStart(begun(lesson))
    record = progress.session.record().lesson
    if record is None or not record.finished:
        return progress.session
    return LessonStart(record.open(record.lesson.pages[0].id), progress.session)
