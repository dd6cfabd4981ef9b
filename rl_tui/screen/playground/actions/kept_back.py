"""Things that a lesson's page hides until it is done."""

from __future__ import annotations

from typing import Final

from rl_tui.lessons.file.schema import HIDEABLE, Page
from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.commands import StudyPolicy
from rl_tui.live.snapshot import Phase
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.keys.action import Action
from rl_tui.screen.panels.lesson.words import keeping_page

PREDICT_FIRST: Final = "predict first. enter: answer"


class KeptBack(Subject):
    """Refusals of steps before a prediction, and of revealing views."""

    @property
    def record(self) -> LessonRecord | None:
        """The progress in the lesson, if any."""
        return self.link.wanted.lesson

    def why_not_yet(self, action: Action) -> str:
        """Return why a page forbids ``action`` now."""
        record = self.record
        if record is None:
            return ""
        if action.not_in_lesson:
            return action.not_in_lesson
        phase = None if self.snapshot is None else self.snapshot.playback.phase
        pauses = bool(action.while_running) and phase in (Phase.RUNNING, Phase.SEEKING)
        if action.takes_steps and "run" in record.hidden and not pauses:
            return PREDICT_FIRST
        page = next((page for what in action.shows if (page := keeping_page(record, what))), None)
        return "" if page is None else _kept_until(record, page)

    def refuses_to_act(self) -> bool:
        """Refuse a step before a prediction, returning True."""
        is_open = self.record is not None and "run" in self.record.hidden
        if is_open:
            self.screen.refuse(PREDICT_FIRST)
        return is_open

    @property
    def notes(self) -> str:
        """The text in place of hidden notes, or empty."""
        record = self.record
        if record is None:
            return ""
        page = next((page for what in HIDEABLE if (page := keeping_page(record, what))), None)
        return "" if page is None else f"They are {_kept_until(record, page)}."

    def show_world_for(self, action: Action | None) -> None:
        """Show the world if ``action`` is about it."""
        keeps_page = action is None or action.of_lesson or action.keeps_page
        if not keeps_page and not self.board.lesson.is_docked:
            self.board.lesson.reads = False

    def close_what_is_kept(self, record: LessonRecord) -> None:
        """Close what the page hides."""
        opened = self.board.opened
        if opened is not None and record.hidden.intersection(self.board.rows[opened].shows):
            self.board.close()
        if self.link.wanted.studied is not None and record.hidden & {"policies", "answer"}:
            self.link.send(StudyPolicy(None))


def _kept_until(record: LessonRecord, page: Page) -> str:
    if page.id != record.page:
        return f"hidden until page {record.lesson.number_of(page.id) + 1} is done"
    if page.prediction is not None:
        return "hidden until you predict. enter: answer"
    return "hidden until this page is done. pgdn pgdn: skip it"
