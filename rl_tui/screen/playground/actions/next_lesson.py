"""The way to the next lesson."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass

from textual.message import Message

from rl_tui.lessons.catalogue import following_lesson
from rl_tui.lessons.file.view import LessonRecord
from rl_tui.lessons.lesson import Lesson
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.panels.lesson.words import is_last_page

LAST_PAGE = "This is the last page. esc: leave the lesson."


@dataclass
class LessonWanted(Message):
    """The learner goes on with ``lesson``."""

    lesson: Lesson


@dataclass(eq=False)
class NextLesson(Subject):
    """Names and opens the next lesson."""

    _following: Lesson | None = None
    _looked: bool = False
    _has_said_so: bool = False

    def look_for(self, record: LessonRecord) -> None:
        """Look for the next lesson on the last page."""
        if not is_last_page(record):
            self._has_said_so = False
        elif not self._looked:
            self._looked = True
            self.screen.run_worker(self._find(record.lesson), name="find the next lesson", group="lessons")

    def turn(self) -> None:
        """Name the next lesson, then open it."""
        if self._following is None:
            self.screen.tell(LAST_PAGE)
        elif self._has_said_so:
            self.screen.post_message(LessonWanted(self._following))
        else:
            self._has_said_so = True
            self.screen.tell(f"Last page. Press enter again for the next lesson: {self._following.title}.")

    async def _find(self, lesson: Lesson) -> None:
        self._following = await asyncio.to_thread(following_lesson, lesson)
        if self._following is not None:
            self.board.lesson.panel.following = self._following.title
            self.board.lesson.panel.redraw()
