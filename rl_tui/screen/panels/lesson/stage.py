"""How far the open page of a lesson has come, and what is to do on it next."""

from __future__ import annotations

from enum import Enum, auto
from typing import Final

from rl_tui.lessons.file.schema import Ask, Page
from rl_tui.lessons.file.view import NO_STEP, Given, LessonRecord, LessonView
from rl_tui.live.snapshot import Snapshot


class PageStage(Enum):
    """Where a page stands."""

    TO_READ = auto()  # it asks nothing
    TO_PREDICT = auto()  # a prediction is open: no step is taken
    LOCKED = auto()  # it is given, and the steps that tell the truth are to be taken
    TOLD = auto()  # the truth stands beside it
    TO_ANSWER = auto()  # a question, not answered or answered wrong
    ANSWERED = auto()
    TO_DO = auto()  # a task
    PASSED = auto()


DONE: Final = (PageStage.TO_READ, PageStage.TOLD, PageStage.ANSWERED, PageStage.PASSED)
"""Stages in which a page asks nothing any more."""


def open_page(record: LessonRecord) -> Page:
    """Return the page that is open."""
    return record.lesson.page(record.page)


def stage_of(view: LessonView, snapshot: Snapshot) -> PageStage:
    """Return where the open page stands beside the run of ``snapshot``."""
    record, page = view.record, open_page(view.record)
    if page.task is not None:
        return PageStage.PASSED if record.has_passed(page.id) else PageStage.TO_DO
    if page.question is not None:
        return PageStage.ANSWERED if record.is_done(page.id) else PageStage.TO_ANSWER
    if page.prediction is None:
        return PageStage.TO_READ
    given = record.given_on(page.id)
    if given is None:
        return PageStage.TO_PREDICT
    return PageStage.LOCKED if steps_to_truth(page.prediction, given, snapshot) else PageStage.TOLD


def steps_to_truth(ask: Ask, given: Given, snapshot: Snapshot) -> int:
    """Return how many steps are missing to the truth of a prediction; 0 once the run has been there.

    The run may have gone back since: how far the branch has come counts. And it may have been set up again,
    or be that of another setup: who has done something on a later page, or all of it, is told.
    """
    record = None if snapshot.lesson is None else snapshot.lesson.record
    if given.step == NO_STEP or not ask.steps or (record is not None and _is_past(record, given.page)):
        return 0
    reached = max(snapshot.counters.step, snapshot.timeline.current.end)
    return max(0, given.step + ask.steps - reached)


def _is_past(record: LessonRecord, page: str) -> bool:
    here, number_of = record.lesson.number_of(page), record.lesson.number_of
    done = [*(each.page for each in record.given), *(each.page for each in record.passed)]
    return record.finished or any(number_of(page) > here for page in done)


def keeping_page(record: LessonRecord, what: str) -> Page | None:
    """Return the page that keeps ``what`` back, the open one or the first behind it; None if none does."""
    if what not in record.hidden:
        return None
    lesson = record.lesson
    for page in lesson.pages[lesson.number_of(record.page) :]:
        is_open = page.id not in record.skipped and not record.is_done(page.id)
        if is_open and (what in page.hides or (what == "run" and page.prediction is not None)):
            return page
    return None


def asks_for_program(record: LessonRecord) -> bool:
    """Return whether the task of the open page asks for a program."""
    task = open_page(record).task
    return task is not None and task.program is not None


def page_place(record: LessonRecord) -> str:
    """Return the place of the open page among all, such as 3/9."""
    return f"{record.lesson.number_of(record.page) + 1}/{len(record.lesson.pages)}"


def is_last_page(record: LessonRecord) -> bool:
    """Return whether no page follows the one that is open."""
    return record.page == record.lesson.pages[-1].id
