"""A learner's progress in a lesson, as sessions keep it and snapshots show it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.runs.recipe import JournalEntry, Recipe


# The record in a session


NO_STEP: Final = -1


@dataclass(frozen=True, slots=True)
class Given:
    """An answer to a prediction or a question, locked when it was given.

    ``answer`` is the number, or the place of the choice from 0. ``step`` is where the run stood, and
    ``digest`` that of the run until there (:func:`run_digest`); NO_STEP and empty where there was none.
    """

    page: str
    answer: float
    is_right: bool
    step: int = NO_STEP
    digest: str = ""


@dataclass(frozen=True, slots=True)
class Passed:
    """A task that was passed, with its evidence: what the run began with, what was changed before ``step``.

    ``claim`` says that the task was rightly called impossible, ``program`` is the code that passed.
    """

    page: str
    recipe: Recipe
    journal: tuple[JournalEntry, ...] = ()
    step: int = 0
    claim: bool = False
    program: str = ""


@dataclass(frozen=True, slots=True)
class LessonRecord:
    """How far a learner has come in ``lesson``; ``page`` is the id of the one that is open.

    ``given`` are the answers in their order, the first one of a page counting; ``passed`` the tasks;
    ``skipped`` the pages left without; ``hints`` how many were asked for, by page.
    """

    lesson: Lesson
    page: str
    given: tuple[Given, ...] = ()
    passed: tuple[Passed, ...] = ()
    skipped: tuple[str, ...] = ()
    hints: tuple[tuple[str, int], ...] = ()
    finished: bool = False

    def given_on(self, page: str) -> Given | None:
        """Return the first answer that was given on ``page``, None where there is none."""
        return next((each for each in self.given if each.page == page), None)

    def last_given_on(self, page: str) -> Given | None:
        """Return the last answer that was given on ``page``, None where there is none."""
        return next((each for each in reversed(self.given) if each.page == page), None)

    def has_passed(self, page: str) -> bool:
        """Return whether the task of ``page`` is passed."""
        return any(each.page == page for each in self.passed)

    def hints_on(self, page: str) -> int:
        """Return how many hints were asked for on ``page``."""
        return dict(self.hints).get(page, 0)

    def is_done(self, page_id: str) -> bool:
        """Return whether the prediction of ``page_id`` is given, its question right, its task passed."""
        page = self.lesson.page(page_id)
        if page.task is not None:
            return self.has_passed(page_id)
        if page.prediction is not None:
            return self.given_on(page_id) is not None
        last = self.last_given_on(page_id)
        return page.question is None or (last is not None and last.is_right)

    @property
    def is_begun(self) -> bool:
        """Whether something was answered, passed or skipped, or another page than the first is open."""
        is_elsewhere = self.page != self.lesson.pages[0].id
        return is_elsewhere or bool(self.given or self.passed or self.skipped)

    @property
    def predictions(self) -> tuple[int, int]:
        """How many predictions were right, and how many were made. Guesses do not count."""
        pages = self.lesson.counted_predictions
        made = [given for page in pages if (given := self.given_on(page.id)) is not None]
        return sum(given.is_right for given in made), len(made)

    @property
    def hidden(self) -> frozenset[str]:
        """What is kept back now: of this page and those behind it in its setup, until they are done.

        Of a page that was skipped nothing is kept back any more.
        """
        lesson = self.lesson
        here, setup = lesson.number_of(self.page), lesson.setup_of(self.page)
        kept = set[str]()
        for page in lesson.pages[here:]:
            if lesson.setup_of(page.id) != setup:
                break
            if page.id in self.skipped or self.is_done(page.id):
                continue
            kept.update(each for each in page.hides if each != "run")
            if page.id == self.page and page.prediction is not None:
                kept.add("run")
        return frozenset(kept)

    def open(self, page: str) -> LessonRecord:
        """Return it with ``page`` open."""
        is_last = page == self.lesson.pages[-1].id
        return replace(self, page=page, finished=self.finished or (is_last and self.is_done(page)))

    def give(self, given: Given) -> LessonRecord:
        """Return it with another answer; of a prediction only the first is kept."""
        is_prediction = self.lesson.page(given.page).prediction is not None
        if is_prediction and self.given_on(given.page) is not None:
            return self
        return replace(self, given=(*self.given, given))

    def passes(self, passed: Passed) -> LessonRecord:
        """Return it with a task passed; the first evidence is kept."""
        return self if self.has_passed(passed.page) else replace(self, passed=(*self.passed, passed))

    def skip(self, page: str) -> LessonRecord:
        """Return it with ``page`` skipped."""
        return self if page in self.skipped else replace(self, skipped=(*self.skipped, page))

    def ask_hint(self, page: str) -> LessonRecord:
        """Return it with one hint more on ``page``."""
        return replace(self, hints=tuple({**dict(self.hints), page: self.hints_on(page) + 1}.items()))


def begun(lesson: Lesson) -> LessonRecord:
    """Return the record of ``lesson`` at its first page."""
    return LessonRecord(lesson, lesson.pages[0].id)


# The view in a snapshot


class ConditionView(NamedTuple):
    """One condition: ``holds`` is None while that is not known; ``found`` is the measure, in words."""

    text: str
    holds: bool | None
    found: str = ""


@dataclass(frozen=True, slots=True)
class TaskView:
    """How the task of the open page stands at this moment."""

    conditions: tuple[ConditionView, ...]
    """Each condition, in the order of the file."""
    passed: Passed | None = None
    """The evidence, where all hold now; None where they do not."""
    waits: str = ""
    """What is being worked out, in words; mostly empty."""
    awaited: Passed | None = None
    """The evidence, where all hold now but for what is being worked out."""
    remarks: tuple[str, ...] = ()
    """What was found of a program that was watched, besides: sentences for who wrote it."""


@dataclass(frozen=True, slots=True)
class LessonView:
    """A lesson beside the run."""

    record: LessonRecord
    """How far the learner has come, the lesson itself in it."""
    task: TaskView | None = None
    """The task of the open page; None where that sets none."""
    digest: str = ""
    """That of the run as it stands: what a prediction is locked with."""
    in_run: float | str | bool | None = None
    """What the open page's prediction shows of the run at the step where its truth is due, or in words why
    there is nothing; None before that, and where it shows nothing."""
