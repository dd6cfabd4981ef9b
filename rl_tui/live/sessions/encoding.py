"""Conversion between records and documents."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from rl_tui import __version__
from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lessons.file.schema import LONGEST_LESSON, LONGEST_PROGRAM
from rl_tui.lessons.file.view import Given, LessonRecord, Passed
from rl_tui.lessons.lesson import Lesson, lesson_folder, lesson_of
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.sessions.document import (
    FORMAT,
    MOST_BRANCHES,
    MOST_DRAWN,
    MOST_ENTRIES,
    MOST_GIVEN,
    MOST_IN_ALL,
    MOST_PAIRS_KEPT,
    VERSION,
    Document,
    Entry,
    StoredGiven,
    StoredLane,
    StoredLesson,
    StoredPassed,
    StoredScenario,
    StoredTable,
    Value,
    stored_source,
)
from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.runs.changes import ALGORITHM, SWEEP, TAKE, WORLD, change_of, name_and_value
from rl_tui.runs.recipe import Change, JournalEntry, Recipe, SetParameter
from rl_tui.runs.timeline.branches import Branch, RunRecord
from rl_tui.worlds.files.scenario import PREFIX, Scenario, environment_scenario, scenario_of
from rl_tui.worlds.files.shipped import SUFFIX

# To a document


def document_of(record: Record, *, title: str, kept: bool, digest: str) -> dict[str, Any]:
    """Convert `record` to JSON data, with the current time. Raises UserError above a limit of the reader.

    `title` is the user's or "", `kept` is True if the user saved it, and `digest` is that of the visible
    run's Q, or "".
    """
    scenario = record.lanes[0].recipe.scenario
    fields = {
        "format": FORMAT,
        "version": VERSION,
        "program": __version__,
        "title": title,
        "kept": kept,
        "saved": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "scenario": _stored_scenario(scenario),
        "lanes": [_stored_lane(lane) for lane in record.lanes],
        "shown": record.shown,
        "breakpoints": {
            "states": sorted(record.breakpoints.states),
            "pairs": sorted(record.breakpoints.pairs),
        },
        "speed": record.speed,
        "digest": digest,
    }
    if record.drawn.choices:
        fields["drawn"] = _stored_drawing(record.drawn)
    table = None if record.table is None else _stored_table(record.table)
    lesson = None if record.lesson is None else _stored_lesson(record.lesson)
    asked = {"answer_hidden": record.answer_is_hidden, "table": table, "lesson": lesson}
    return fields | {name: value for name, value in asked.items() if value is not None}


def _stored_drawing(drawn: DrawnPolicy) -> list[list[int]]:
    if len(drawn.choices) > MOST_DRAWN:
        raise UserError(f"the drawn policy has more than {MOST_DRAWN:,} choices")
    return [list(choice) for choice in drawn.choices]


def _stored_lane(lane: RunRecord) -> dict[str, Any]:
    if len(lane.branches) > MOST_BRANCHES:
        raise UserError(f"there are more than {MOST_BRANCHES:,} branches")
    return {
        **_stored_recipe(lane.recipe),
        "branches": [_stored_branch(branch, lane.branches) for branch in lane.branches],
        "branch": lane.branch,
    }


def _stored_branch(branch: Branch, branches: Sequence[Branch]) -> dict[str, Any]:
    shared = 0
    if branch.parent is not None:
        for own, of_parent in zip(branch.journal, branches[branch.parent].journal, strict=False):
            if own != of_parent:
                break
            shared += 1
    if len(branch.journal) > MOST_ENTRIES:
        raise UserError(f"there are more than {MOST_ENTRIES:,} changes")
    return {
        "name": branch.name,
        "parent": branch.parent,
        "fork": branch.fork,
        "end": branch.end,
        "here": branch.here,
        "shared": shared,
        "journal": _stored_journal(branch.journal[shared:]),
    }


def _stored_table(table: LearnedTable) -> dict[str, Any] | None:
    if len(table.q) > MOST_PAIRS_KEPT or not np.isfinite(table.q).all():
        return None
    return {
        "q": table.q.tolist(),
        "visits": table.visits.tolist(),
        "episodes": table.episodes,
        "state": table.state,
    }


def _stored_scenario(scenario: Scenario) -> dict[str, str]:
    if scenario.id.startswith(PREFIX):
        return {"id": scenario.id, "kind": "gymnasium", "title": scenario.title}
    if not scenario.text:
        raise UserError(f"the file of scenario {scenario.id} is not known")
    return {"id": scenario.id, "kind": "file", "title": scenario.title, "text": scenario.text}


def _stored_recipe(recipe: Recipe) -> dict[str, Any]:
    return {
        "seed": recipe.seed,
        "algorithm": recipe.algorithm,
        "hyperparameters": recipe.hyperparameters.as_dict(),
    }


def _stored_journal(journal: Iterable[JournalEntry]) -> list[dict[str, Any]]:
    stored = [_stored_entry(entry) for entry in journal]
    if len(stored) > MOST_ENTRIES:
        raise UserError(f"there are more than {MOST_ENTRIES:,} changes")
    return stored


def _stored_entry(entry: JournalEntry) -> dict[str, Any]:
    name, value = name_and_value(entry.change)
    if isinstance(entry.change, SetParameter):
        return {"step": entry.step, "set": name, "to": value}
    return {"step": entry.step, name: value}


def _stored_lesson(record: LessonRecord) -> dict[str, Any]:
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
        "scenario": _stored_scenario(passed.recipe.scenario),
        **_stored_recipe(passed.recipe),
        "journal": _stored_journal(passed.journal),
        "step": passed.step,
        "claim": passed.claim,
        "program": passed.program,
    }


# To a record. `place` is the position in the document


def record_of(document: Document) -> Record:
    """Convert `document` to a record. Raises UserError, in one line, if parts do not fit."""
    scenario = _scenario(document.scenario)
    lanes = enumerate(document.lanes)
    return Record(
        lanes=tuple(_lane(lane, scenario, f"lanes[{number}]") for number, lane in lanes),
        shown=document.shown,
        breakpoints=Breakpoints(
            frozenset(document.breakpoints.states), frozenset(document.breakpoints.pairs)
        ),
        speed=document.speed,
        answer_is_hidden=document.answer_hidden,
        drawn=DrawnPolicy(tuple(sorted(dict(document.drawn).items()))),
        lesson=None if document.lesson is None else _lesson_record(document.lesson),
        table=None if document.table is None else _table(document.table),
    )


def _table(stored: StoredTable) -> LearnedTable:
    q, visits = np.array(stored.q, np.float64), np.array(stored.visits, np.int64)
    return LearnedTable(q, visits, stored.episodes, stored.state)


def _lane(stored: StoredLane, scenario: Scenario, place: str) -> RunRecord:
    recipe = _recipe(scenario, stored.algorithm, stored.hyperparameters, stored.seed, place)
    return RunRecord(recipe, tuple(_branches(stored, place)), stored.branch)


def _branches(lane: StoredLane, lane_place: str) -> Iterator[Branch]:
    made: list[Branch] = []
    in_all = 0
    for number, stored in enumerate(lane.branches):
        place = f"{lane_place}.branches[{number}]"
        parent = () if stored.parent is None else made[stored.parent].journal
        if stored.shared > len(parent):
            raise UserError(
                f"{place}.shared is {stored.shared}, but its parent branch has {len(parent)} changes"
            )
        in_all += stored.shared + len(stored.journal)
        if in_all > MOST_IN_ALL:
            raise UserError(f"{lane_place}: its branches have more than {MOST_IN_ALL:,} changes")
        if max(stored.here, stored.fork) > stored.end:
            raise UserError(
                f"{place}: the position or the start of the branch is after the last step, {stored.end}"
            )
        shared = parent[: stored.shared]
        latest = shared[-1].step if shared else 0
        journal = (*shared, *_journal(stored.journal, place, stored.end, latest))
        made.append(Branch(stored.name, journal, stored.parent, stored.fork, stored.end, stored.here))
        yield made[-1]


def _scenario(stored: StoredScenario) -> Scenario:
    if stored.kind == "gymnasium":
        return environment_scenario(stored.id)
    try:
        return scenario_of(stored.text, Path(f"{stored.id}.toml"), ask_environment=False)
    except UserError as fault:
        raise UserError(f"the scenario in it cannot be played: {str(fault).splitlines()[0]}") from fault


def _recipe(
    scenario: Scenario, algorithm: str, settings: Mapping[str, Value], seed: int, place: str
) -> Recipe:
    _check_algorithm(algorithm, f"{place}.algorithm")
    hyperparameters = Hyperparameters()
    for name, value in settings.items():
        hyperparameters = _changed(hyperparameters, name, value, f"{place}.hyperparameters")
    return Recipe(scenario, algorithm, hyperparameters, seed)


def _journal(stored: Iterable[Entry], place: str, end: int, latest: int = 0) -> Iterator[JournalEntry]:
    _check_order(0, latest, end, place)
    for number, each in enumerate(stored):
        _check_order(latest, each.step, end, place)
        latest = each.step
        yield JournalEntry(each.step, _change(each, f"{place}.journal[{number}]"))


def _check_order(before: int, step: int, end: int, place: str) -> None:
    if not before <= step <= end:
        raise UserError(f"{place}.journal: step {step} is out of order, or beyond the end of the branch")


def _change(entry: Entry, place: str) -> Change:
    keys = ("set", "to", ALGORITHM, TAKE, SWEEP, WORLD)
    match [(key, value) for key in keys if (value := getattr(entry, key)) is not None]:
        case [("set", name), ("to", value)]:
            return SetParameter(name, _changed(Hyperparameters(), name, value, place).value(name))
        case [(name, value)] if name not in ("set", "to"):
            if name == ALGORITHM:
                _check_algorithm(value, f"{place}.{name}")
            try:
                return change_of(name, value)
            except ValueError as fault:
                raise UserError(f"{place}.{name}: {fault}") from fault
    raise UserError(f"{place}: not a change; expected set and to, algorithm, take, sweep, or world")


def _check_algorithm(algorithm: str, place: str) -> None:
    if algorithm not in BY_ID:
        raise UserError(f"{place} is {shown(algorithm)}, which is not known{near(algorithm, BY_ID)}")


def _changed(values: Hyperparameters, name: str, value: Value, place: str) -> Hyperparameters:
    if name not in PARAMETERS:
        raise UserError(f"{place}: there is no setting {shown(name)}{near(name, PARAMETERS)}")
    try:
        return values.changed(name, value)
    except ValueError as fault:
        raise UserError(f"{place}: {fault}") from fault


def _lesson_record(stored: StoredLesson) -> LessonRecord:
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
        raise UserError(f"lesson.id is {shown(stored.id)}, but the lesson's file has another name")
    try:
        return lesson_of(stored.text, source, stored.variant)
    except UserError as fault:
        raise UserError(f"the lesson in it has an error: {_without_path(fault, source)}") from fault


def _without_path(fault: UserError, source: Path) -> str:
    """Return an error's first line without the path, from which the lesson's text does not come."""
    return str(fault).splitlines()[0].removeprefix(f"{source}: ")


def _check_pages(place: str, named: Iterable[str], known: Iterable[str]) -> None:
    known = list(known)
    for each in named:
        if each not in known:
            raise UserError(f"lesson.{place}: there is no such page as {shown(each)}{near(each, known)}")


def _given(stored: StoredGiven, lesson: Lesson, place: str) -> Given:
    asked = lesson.page(stored.page).asked
    choices = () if asked is None else asked.choices
    if choices and stored.answer not in range(len(choices)):
        raise UserError(
            f"{place}.answer is {shown(stored.answer)}; expected a choice, 0 to {len(choices) - 1}"
        )
    return Given(stored.page, stored.answer, stored.right, stored.step, stored.digest)


def _passed(stored: StoredPassed, known: dict[StoredScenario, Scenario], place: str) -> Passed:
    scenario = known.get(stored.scenario)
    if scenario is None:
        scenario = known[stored.scenario] = _scenario(stored.scenario)
    recipe = _recipe(scenario, stored.algorithm, stored.hyperparameters, stored.seed, place)
    journal = tuple(_journal(stored.journal, place, stored.step))
    return Passed(stored.page, recipe, journal, stored.step, stored.claim, stored.program)
