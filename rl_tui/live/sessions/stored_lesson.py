"""How far somebody has come in a lesson, to a document and back."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lessons.file.schema import LONGEST_LESSON, LONGEST_PROGRAM
from rl_tui.lessons.file.view import Given, LessonRecord, Passed
from rl_tui.lessons.lesson import Lesson, lesson_folder, lesson_of
from rl_tui.live.sessions.document import (
    MOST_GIVEN,
    StoredGiven,
    StoredLesson,
    StoredPassed,
    StoredScenario,
    journal_from,
    recipe_from,
    scenario_from,
    stored_journal,
    stored_recipe,
    stored_scenario,
)
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.files.shipped import SUFFIX


def stored_lesson(record: LessonRecord) -> dict[str, Any]:
    """Return ``record`` as JSON. Raises UserError where it is larger than what is read again."""
    lesson = record.lesson
    if len(lesson.text) > LONGEST_LESSON:
        raise UserError(f"the lesson has more than {LONGEST_LESSON:,} characters")
    if len(record.given) > MOST_GIVEN:
        raise UserError(f"there are more than {MOST_GIVEN:,} answers")
    return {
        "id": lesson.id,
        "title": lesson.title,
        "text": lesson.text,
        "source": stored_source(lesson),
        "variant": lesson.variant,
        "page": record.page,
        "given": [_stored_given(given) for given in record.given],
        "passed": [_stored_passed(passed) for passed in record.passed],
        "skipped": list(record.skipped),
        "hints": dict(record.hints),
        "finished": record.finished,
    }


def stored_source(lesson: Lesson) -> str:
    """Return where the file of ``lesson`` is; empty where it is shipped, as that is everywhere."""
    return "" if lesson.source.parent == lesson_folder() else str(lesson.source)


def _stored_given(given: Given) -> dict[str, Any]:
    return {
        "page": given.page,
        "answer": given.answer,
        "right": given.is_right,
        "step": given.step,
        "digest": given.digest,
    }


def _stored_passed(passed: Passed) -> dict[str, Any]:
    if len(passed.program) > LONGEST_PROGRAM:
        raise UserError(f"the program of a task has more than {LONGEST_PROGRAM:,} characters")
    return {
        "page": passed.page,
        "scenario": stored_scenario(passed.recipe.scenario),
        **stored_recipe(passed.recipe),
        "journal": stored_journal(passed.journal),
        "step": passed.step,
        "claim": passed.claim,
        "program": passed.program,
    }


# And back


def lesson_from(stored: StoredLesson) -> LessonRecord:
    """Return what ``stored`` says. Raises UserError, in one line, where the lesson's text has a fault, or its
    parts do not fit together.
    """
    lesson = _lesson(stored)
    pages = {page.id: page for page in lesson.pages}
    _check_pages("page", [stored.page], pages)
    _check_pages("skipped", stored.skipped, pages)
    _check_pages("hints", stored.hints, pages)
    _check_pages("given", [given.page for given in stored.given], [id_ for id_ in pages if pages[id_].asked])
    tasks = [page.id for page in lesson.tasks]
    _check_pages("passed", [passed.page for passed in stored.passed], tasks)
    known = dict[StoredScenario, Scenario]()
    return LessonRecord(
        lesson,
        stored.page,
        tuple(_given(given, lesson, f"lesson.given[{n}]") for n, given in enumerate(stored.given)),
        tuple(_passed(passed, known, f"lesson.passed[{n}]") for n, passed in enumerate(stored.passed)),
        stored.skipped,
        tuple(stored.hints.items()),
        stored.finished,
    )


def _lesson(stored: StoredLesson) -> Lesson:
    source = Path(stored.source) if stored.source else lesson_folder() / f"{stored.id}{SUFFIX}"
    if source.stem != stored.id:
        raise UserError(f"lesson.id is {shown(stored.id)}, which is not the name of its file")
    try:
        return lesson_of(stored.text, source, stored.variant)
    except UserError as fault:
        raise UserError(f"its lesson has a fault: {_without_path(fault, source)}") from fault


def _without_path(fault: UserError, source: Path) -> str:
    """Return the first line of a fault of the lesson's text; that does not come from the file it names."""
    return str(fault).splitlines()[0].removeprefix(f"{source}: ")


def _check_pages(place: str, named: Iterable[str], known: Iterable[str]) -> None:
    """Refuse pages that are not ``known``. Raises UserError."""
    known = list(known)
    for each in named:
        if each not in known:
            raise UserError(f"lesson.{place}: there is no such page as {shown(each)}{near(each, known)}")


def _given(stored: StoredGiven, lesson: Lesson, place: str) -> Given:
    asked = lesson.page(stored.page).asked
    choices = () if asked is None else asked.choices
    if choices and stored.answer not in range(len(choices)):
        raise UserError(f"{place}.answer is {shown(stored.answer)}; it has {len(choices)} choices, from 0")
    return Given(stored.page, stored.answer, stored.right, stored.step, stored.digest)


def _passed(stored: StoredPassed, known: dict[StoredScenario, Scenario], place: str) -> Passed:
    """Return the evidence; each scenario is read once, and is then ``known``."""
    scenario = known.get(stored.scenario)
    if scenario is None:
        scenario = known[stored.scenario] = scenario_from(stored.scenario)
    recipe = recipe_from(scenario, stored.algorithm, stored.hyperparameters, stored.seed, place)
    journal = tuple(journal_from(stored.journal, place, stored.step))
    return Passed(stored.page, recipe, journal, stored.step, stored.claim, stored.program)
