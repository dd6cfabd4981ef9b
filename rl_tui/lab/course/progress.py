"""How far somebody has come in each lesson, from the sessions in the folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rl_tui.lab.sessions.folder import all_sessions_in
from rl_tui.lab.sessions.session import StoredSession
from rl_tui.lab.sessions.stored_lesson import stored_source

if TYPE_CHECKING:
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.sessions.document import StoredLesson


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
        made = [first_answers[page.id] for page in lesson.counted_predictions if page.id in first_answers]
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
