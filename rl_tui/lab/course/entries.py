"""The shipped lessons as a learner finds them: each with how far they have come."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from rl_tui.common.errors import ScenarioError
from rl_tui.lab.lessons.catalogue import read_lessons
from rl_tui.lab.lessons.lesson import Lesson
from rl_tui.lab.lessons.record import LessonRecord
from rl_tui.lab.sessions.session import StoredSession


@dataclass(frozen=True, slots=True, eq=False)
class LessonEntry:
    """A shipped ``lesson``; the ``record`` of it is in the newest ``session``, None where it is not begun."""

    lesson: Lesson
    record: LessonRecord | None = None
    session: StoredSession | None = None

    @property
    def is_finished(self) -> bool:
        """Whether it was taken to its end."""
        return self.record is not None and self.record.finished


class LessonEntries(NamedTuple):
    """The lessons in their order, and what is wrong with files that give none."""

    entries: list[LessonEntry]
    broken: list[ScenarioError]

    @property
    def finished(self) -> int:
        """How many lessons are finished."""
        return sum(entry.is_finished for entry in self.entries)


def lesson_entries(sessions: Path | None) -> LessonEntries:
    """Return every shipped lesson; ``sessions`` is the folder of sessions, None where none are kept."""
    found = read_lessons()
    return LessonEntries([LessonEntry(lesson) for lesson in found.lessons], found.broken)
