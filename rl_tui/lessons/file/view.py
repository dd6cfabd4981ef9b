"""A learner's progress in a lesson, for sessions and snapshots."""

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
    """An answer, locked when given: a number, or the index of a choice.

    `step` and `digest` identify the run (see `run_digest`), NO_STEP and "" without one.
    """

    page: str
    answer: float
    is_right: bool
    step: int = NO_STEP
    digest: str = ""


@dataclass(frozen=True, slots=True)
class Passed:
    """A passed task with its evidence: recipe, changes, and `step` of the run.

    `claim` means that it was rightly called impossible, and `program` is the code that passed.
    """

    page: str
    recipe: Recipe
    journal: tuple[JournalEntry, ...] = ()
    step: int = 0
    claim: bool = False
    program: str = ""


@dataclass(frozen=True, slots=True)
class LessonRecord:
    """A learner's progress in a lesson.

    `page` is the open one. `given` has all answers in order, of which the first on each page counts.
    `skipped` has pages left undone, and `hints` the number of hints by page.
    """

    lesson: Lesson
    page: str
    given: tuple[Given, ...] = ()
    passed: tuple[Passed, ...] = ()
    skipped: tuple[str, ...] = ()
    hints: tuple[tuple[str, int], ...] = ()
    finished: bool = False

    def given_on(self, page: str) -> Given | None:
        """Return the first answer, if any."""
        return next((each for each in self.given if each.page == page), None)

    def last_given_on(self, page: str) -> Given | None:
        """Return the last answer, if any."""
        return next((each for each in reversed(self.given) if each.page == page), None)

    def has_passed(self, page: str) -> bool:
        """Return True if the page's task is passed."""
        return any(each.page == page for each in self.passed)

    def hints_on(self, page: str) -> int:
        """Return the number of hints shown."""
        return dict(self.hints).get(page, 0)

    def is_done(self, page_id: str) -> bool:
        """Return True if nothing is left to do on the page."""
        page = self.lesson.page(page_id)
        if page.task is not None:
            return self.has_passed(page_id)
        if page.prediction is not None:
            return self.given_on(page_id) is not None
        last = self.last_given_on(page_id)
        return page.question is None or (last is not None and last.is_right)

    @property
    def is_begun(self) -> bool:
        """True once anything was done or opened."""
        is_elsewhere = self.page != self.lesson.pages[0].id
        return is_elsewhere or bool(self.given or self.passed or self.skipped)

    @property
    def predictions(self) -> tuple[int, int]:
        """Right predictions, and all, without guesses."""
        pages = self.lesson.counted_predictions
        made = [given for page in pages if (given := self.given_on(page.id)) is not None]
        return sum(given.is_right for given in made), len(made)

    @property
    def hidden(self) -> frozenset[str]:
        """Names hidden by this page, and later ones of its setup."""
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
        """Return a copy with `page` open."""
        is_last = page == self.lesson.pages[-1].id
        return replace(self, page=page, finished=self.finished or (is_last and self.is_done(page)))

    def give(self, given: Given) -> LessonRecord:
        """Add an answer; for a prediction, only the first."""
        is_prediction = self.lesson.page(given.page).prediction is not None
        if is_prediction and self.given_on(given.page) is not None:
            return self
        return replace(self, given=(*self.given, given))

    def passes(self, passed: Passed) -> LessonRecord:
        """Add a passed task with its first evidence."""
        return self if self.has_passed(passed.page) else replace(self, passed=(*self.passed, passed))

    def skip(self, page: str) -> LessonRecord:
        """Return a copy with `page` skipped."""
        return self if page in self.skipped else replace(self, skipped=(*self.skipped, page))

    def ask_hint(self, page: str) -> LessonRecord:
        """Return a copy with one more hint on `page`."""
        return replace(self, hints=tuple({**dict(self.hints), page: self.hints_on(page) + 1}.items()))


def begun(lesson: Lesson) -> LessonRecord:
    """Return the record of a new lesson."""
    return LessonRecord(lesson, lesson.pages[0].id)


# The view in a snapshot


class ConditionView(NamedTuple):
    """A condition: `holds` is None while unknown, and `found` is the metric in words."""

    text: str
    holds: bool | None
    found: str = ""


@dataclass(frozen=True, slots=True)
class TaskView:
    """The open page's task."""

    conditions: tuple[ConditionView, ...]
    """The conditions in file order."""
    passed: Passed | None = None
    """The evidence if all conditions are met now, else None."""
    waits: str = ""
    """The pending computation in words, usually empty."""
    awaited: Passed | None = None
    """The evidence if all conditions are met except pending ones, else None."""
    remarks: tuple[str, ...] = ()
    """Remarks about a watched program for its author."""


@dataclass(frozen=True, slots=True)
class LessonView:
    """A lesson next to the run."""

    record: LessonRecord
    """Progress of the learner, with the lesson."""
    task: TaskView | None = None
    """State of the open page's task, or None."""
    digest: str = ""
    """Digest of the run at its current step, which locks predictions."""
    in_run: float | str | bool | None = None
    """Metric shown by the page's prediction, from the step at which the answer is revealed, or the reason
    why there is none. None before that step, or if nothing is shown.
    """
