"""The check of a lesson file.

A number in a text must be a figure, `{name}`, or come from the page itself: its settings, its world, its
conditions, answers or attempts. 0 and 1 are always allowed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.catalogue import parameters_of
from rl_tui.common.errors import Fault, ScenarioError, UserError, first_of
from rl_tui.common.findings import Finding, Location, in_file_order, place, shown
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.lessons.figures.figures import LessonFigures
from rl_tui.lessons.figures.step_budget import StepBudget
from rl_tui.lessons.figures.written import in_digits_of, written_number
from rl_tui.lessons.file.variants import readable, variants_of
from rl_tui.lessons.judging.world_faults import reference_faults
from rl_tui.lessons.lesson import Lesson, is_lesson_text, read_lesson
from rl_tui.lessons.task_check import TaskCheck
from rl_tui.runs.changes import name_and_value, read_change
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.files.scenario import PANEL_IDS, unknown_panels
from rl_tui.worlds.files.toml_file import tables_in

if TYPE_CHECKING:
    from rl_tui.lessons.figures.subject import FigureSubject
    from rl_tui.lessons.file.schema import Ask, Page


# What a page may highlight


SPOTLIGHTS: Final = (
    *PANEL_IDS,
    "microscope",
    "many_seeds",
    "discount",
    "policies",
    "program",
    "findings",
    "output",
)
"""Ids that a page may highlight. A test compares them with the catalogue of panels."""


# Predictions and questions


_FIGURE: Final = re.compile(r"\{([a-z][a-z0-9_-]*)\}")
_SLACK: Final = 1e-9


def page_findings(
    lesson: Lesson, raw: Mapping[str, Any], figures: LessonFigures, *, quick: bool
) -> Iterator[Finding]:
    """Yield errors of a page. `raw` is the file without figures."""
    for number, page in enumerate(lesson.pages):
        where: Location = ("pages", number)
        yield from _panel_findings(lesson, page, where)
        if page.asked is not None:
            kind = "prediction" if page.prediction is not None else "question"
            written = raw["pages"][number][kind].get("answer")
            yield from _ask_findings(page.asked, written, (*where, kind), figures, quick=quick)


def _panel_findings(lesson: Lesson, page: Page, where: Location) -> Iterator[Finding]:
    named = () if page.panels is None else page.panels
    spotlight = () if page.spotlight is None else (page.spotlight,)
    yield from unknown_panels((*where, "spotlight"), spotlight, SPOTLIGHTS)
    yield from unknown_panels((*where, "panels"), named)
    in_view = lesson.panels_of(page.id)
    if page.spotlight in PANEL_IDS and in_view is not None and page.spotlight not in in_view:
        yield Finding((*where, "spotlight"), f"{shown(page.spotlight)} is not in view; add it to panels")


def _ask_findings(
    ask: Ask, written: object, where: Location, figures: LessonFigures, *, quick: bool
) -> Iterator[Finding]:
    if ask.answer is None:
        yield from _choice_findings(ask, where)
        return
    yield from _answer_findings(ask, ask.answer, written, where, figures, quick=quick)
    known: list[float] = []
    for number, wrong in enumerate(ask.wrong):
        at = (*where, "wrong", number, "answer")
        if abs(wrong.answer - ask.answer) <= ask.tolerance + _SLACK:
            right = f"{shown(wrong.answer)} is right, within {shown(ask.answer)} ± {ask.tolerance:g}"
            yield Finding(at, f"{right}; give a wrong answer")
        elif any(abs(wrong.answer - each) <= _SLACK for each in known):
            yield Finding(at, f"{shown(wrong.answer)} is listed twice; remove one")
        known.append(wrong.answer)


def _answer_findings(
    ask: Ask, answer: float, written: object, where: Location, figures: LessonFigures, *, quick: bool
) -> Iterator[Finding]:
    figure = _FIGURE.fullmatch(written.strip()) if isinstance(written, str) else None
    if figure is None:
        if answer not in (0.0, 1.0):
            yield Finding((*where, "answer"), shown(answer), 'a computed figure, answer = "{name}"')
        return
    name = figure[1]
    if quick and figures.needs_seeds(name):
        return
    if figures.finding(name) is not None:
        return  # reported for the figure itself
    exact = figures.value(name)
    if isinstance(exact, int | float) and abs(exact - answer) > ask.tolerance + _SLACK * max(
        1.0, abs(answer)
    ):
        found = f"{shown(answer)} ± {ask.tolerance:g}"
        expected = f"a tolerance that includes the exact value: {in_digits_of(float(exact), '')}"
        yield Finding((*where, "tolerance"), found, expected)


def _choice_findings(ask: Ask, where: Location) -> Iterator[Finding]:
    seen = set[str]()
    for number, choice in enumerate(ask.choices):
        if choice.text in seen:
            yield Finding(
                (*where, "choices", number, "text"), f"{shown(choice.text)} is listed twice; list it once"
            )
        seen.add(choice.text)


# Numbers in texts


PROSE: Final = frozenset(
    ("title", "summary", "goals", "text", "explanation", "ask", "reply", "do", "hints", "solution")
)
"""Keys of a lesson file whose texts learners read."""
_NOT_PROSE: Final = frozenset(("figures", "setups", "variants", "accepts", "rejects", "program", "proof"))
_SAME: Final = 1e-9
_ALWAYS: Final = (0.0, 1.0)
_PLACEHOLDER: Final = re.compile(r"\$?\{[a-z][a-z0-9_-]*\}")
_CODE: Final = re.compile(r"`([^`\n]*)`")
_COMMAND: Final = re.compile(
    r"(rl-tui|pip|python|uv|git|make)\b.*|\w+\.(py|toml|json|csv)|.|(ctrl|shift|alt)\+\S+|f\d+"
)
_REFERENCE: Final = re.compile(
    r"\b(equations?|sections?|chapters?|figures?|exercises?|examples?|pages?|lessons?)\s+"
    r"\d+(\.\d+)*((,| and| or| to|–)\s*\d+(\.\d+)*)*|\((19|20)\d\d\)|^\s*\d+[.)]\s",
    re.IGNORECASE | re.MULTILINE,
)
_STATES: Final = re.compile(
    r"\b(?:states?|cells?)\s+(\d+(?:(?:,| and| or| to|–)\s*\d+)*)|[A-Za-zπδ*]\((\d+)(?=[,)])", re.IGNORECASE
)
_NUMERAL: Final = re.compile(
    r"(?<![\w.,])[-−+]?(?:\d+/\d+|\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d*\.?\d+)"
    r"(?:·10⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+|[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)?[^\W\d_]*(?:\s?%)?"
)


def numeral_findings(lesson: Lesson, raw: Mapping[str, Any], figures: LessonFigures) -> Iterator[Finding]:
    """Yield numbers without a source."""
    for location, text in _texts({key: value for key, value in raw.items() if key != "pages"}, ()):
        yield from _findings(location, text, _ALWAYS, ())
    pages = raw.get("pages", [])
    for number, (page, table) in enumerate(zip(lesson.pages, pages, strict=True)):
        allowed, states = _allowed(page, figures)
        for location, text in _texts(table, ("pages", number)):
            yield from _findings(location, text, allowed, states)


def _texts(value: Any, location: Location) -> Iterator[tuple[Location, str]]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            is_wrong_choice = key == "text" and "choices" in location and not value.get("right", False)
            if key in _NOT_PROSE or is_wrong_choice:
                continue
            is_text = isinstance(inner, str) or (
                isinstance(inner, list) and all(isinstance(x, str) for x in inner)
            )
            if key in PROSE or not is_text:
                yield from _texts(inner, (*location, key))
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from _texts(inner, (*location, number))
    elif isinstance(value, str):
        yield location, value


def _findings(
    location: Location, text: str, allowed: tuple[float, ...], states: tuple[str, ...]
) -> Iterator[Finding]:
    for numeral in numerals_in(text, states):
        number = written_number(numeral)
        if number is None or not any(_is_same(abs(number.value), each) for each in allowed):
            expected = "a figure {name}, a number from the setup of the page, or a number in words"
            yield Finding(location, shown(numeral), expected)


def numerals_in(text: str, states: tuple[str, ...] = ()) -> list[str]:
    """Return distinct numbers, without `states`, code and references."""
    plain = _PLACEHOLDER.sub("x", text)
    plain = _CODE.sub(lambda match: " " if _COMMAND.fullmatch(match[1].strip()) else match[1], plain)
    plain = _REFERENCE.sub(" ", plain)
    plain = _STATES.sub(lambda match: " " if _are_states(match, states) else match[0], plain)
    return list(dict.fromkeys(match[0].strip() for match in _NUMERAL.finditer(plain)))


def _are_states(match: re.Match[str], states: tuple[str, ...]) -> bool:
    return all(number in states for number in re.findall(r"\d+", match[1] or match[2]))


def _is_same(one: float, other: float) -> bool:
    return abs(one - other) <= _SAME * max(1.0, abs(one))


def _allowed(page: Page, figures: LessonFigures) -> tuple[tuple[float, ...], tuple[str, ...]]:
    numbers = set(_ALWAYS)
    names: tuple[str, ...] = ()
    try:
        subject = figures.subject_of_page(page.id)
        numbers.update(_settings(subject), _world(subject))
        names = tuple(subject.world.space.state_names)
    except UserError:
        pass  # a setup that cannot be played is reported elsewhere
    if page.asked is not None:
        numbers.update(_numbers(each.answer for each in page.asked.wrong))
        for choice in page.asked.choices:
            if not choice.right:
                numbers.update(_in_text(choice.text))
    if page.task is not None:
        for condition in page.task.conditions:
            numbers.update(_numbers(condition.model_dump().values()))
        for attempt in (*page.task.accepts, *page.task.rejects):
            numbers.update(_numbers(attempt.settings.values()))
            numbers.update(_numbers((attempt.steps, attempt.episodes)))
            numbers.update(_numbers(_changed(attempt.changes)))
    return tuple(numbers), names


def _settings(subject: FigureSubject) -> Iterator[float]:
    used = parameters_of(subject.recipe.algorithm, subject.values.policy)
    yield from _numbers(subject.values.value(name) for name in used)
    yield float(subject.recipe.seed)
    yield from _in_text(subject.recipe.scenario.title)
    yield from _in_text(subject.recipe.scenario.id)


def _world(subject: FigureSubject) -> Iterator[float]:
    world = subject.world
    yield from _numbers((world.space.time_limit, world.budget))
    if isinstance(world.drawing, Grid):
        yield from (float(world.drawing.rows), float(world.drawing.columns))
    if world.mdp is not None and not subject.recipe.scenario.section.drawn_from_seed:
        for array in (world.mdp.reward, world.mdp.probability):
            yield from (abs(float(each)) for each in set(array.tolist()))


def _numbers(values: Any) -> Iterator[float]:
    for value in values:
        if isinstance(value, int | float) and not isinstance(value, bool):
            yield abs(float(value))
        elif isinstance(value, tuple):
            yield from _numbers(value)


def _in_text(text: str) -> Iterator[float]:
    for numeral in _NUMERAL.findall(text):
        number = written_number(numeral)
        if number is not None:
            yield abs(number.value)


def _changed(changes: tuple[str, ...]) -> Iterator[float | str]:
    for text in changes:
        try:
            _, value = name_and_value(read_change(text).change)
        except ValueError:
            continue  # reported where the attempt is replayed
        yield value


# The whole check


OnChecked = Callable[[int, int, str], None]
"""Called with (done, wanted, name of the next check)."""
_Placed = tuple[str, str, str]


def ignore(done: int, wanted: int, what: str) -> None:
    """Ignore progress."""


@dataclass(slots=True)
class LessonReport:
    """At most 100 `faults` and a note, and `warnings`."""

    faults: list[Fault] = field(default_factory=list)
    warnings: list[Fault] = field(default_factory=list)


def is_lesson_file(path: str | Path) -> bool:
    """Return True for a readable lesson rather than a scenario."""
    try:
        return is_lesson_text(read_text(Path(path)))
    except UnreadableError:
        return False


def check_lesson(
    path: str | Path,
    *,
    quick: bool = False,
    on_checked: OnChecked = ignore,
    budget: StepBudget | None = None,
) -> LessonReport:
    """Check a lesson file, each variant as a lesson of its own.

    `quick` skips work with many seeds. `budget` limits the steps of all variants together.
    """
    report, budget = LessonReport(), budget or StepBudget()
    try:
        lessons = [read_lesson(path)]
        names = variants_of(tables_in(readable(read_text(Path(path)))))
        lessons += [read_lesson(path, name) for name in names[1:]]
    except ScenarioError as error:
        report.faults += error.faults
        return report
    counted = _Counted(on_checked, sum(map(_amount, lessons)))
    seen = set[tuple[str, str, str]]()
    for lesson in lessons:
        faults, warnings = _LessonCheck(lesson, counted, budget, quick=quick).findings()
        file = f"{path} (variant {lesson.variant})" if lesson.variant else str(path)
        for findings, reported in ((faults, report.faults), (warnings, report.warnings)):
            reported += [Fault(file, *each) for each in findings if each not in seen]
            seen.update(findings)
    report.faults = list(first_of(report.faults))
    return report


class _Counted:
    def __init__(self, on_checked: OnChecked, wanted: int) -> None:
        self._on_checked = on_checked
        self._wanted = wanted
        self._done = 0

    def next(self, what: str) -> None:
        self._on_checked(self._done, self._wanted, what)
        self._done += 1


def _amount(lesson: Lesson) -> int:
    tasks = [page.task for page in lesson.tasks if page.task is not None]
    attempts = sum(len(task.accepts) + len(task.rejects) for task in tasks)
    return len(lesson.figures) + len(tasks) + attempts * (2 if lesson.variant else 1)


def _placed(findings: list[Finding], raw: Mapping[str, Any]) -> list[_Placed]:
    return [(place(each.location), each.found, each.expected) for each in in_file_order(findings, raw)]


class _LessonCheck:
    def __init__(self, lesson: Lesson, counted: _Counted, budget: StepBudget, *, quick: bool) -> None:
        self._lesson = lesson
        self._counted = counted
        self._quick = quick
        self._budget = budget
        self._figures = LessonFigures(lesson, budget)

    def findings(self) -> tuple[list[_Placed], list[_Placed]]:
        raw = tables_in(self._lesson.text)
        unknown = [(each.place, each.found, each.expected) for each in reference_faults(self._lesson)]
        if any(where.startswith("setups") for where, _, _ in unknown):
            return unknown, []  # the rest needs the worlds
        faults = list(self._figure_findings())
        faults += page_findings(self._lesson, raw, self._figures, quick=self._quick)
        faults += numeral_findings(self._lesson, raw, self._figures)
        warnings = list[Finding]()
        for number, page in enumerate(self._lesson.pages):
            if page.task is not None:
                check = TaskCheck(self._lesson, number, page, page.task, self._budget, quick=self._quick)
                warnings += check.warnings()
                if not unknown:
                    faults += self._task_findings(check)
        return [*unknown, *_placed(faults, raw)], _placed(warnings, raw)

    def _figure_findings(self) -> Iterator[Finding]:
        for name in self._lesson.figures:
            self._counted.next(name)
            if self._quick and self._figures.needs_seeds(name):
                continue
            finding = self._figures.finding(name)
            if finding is not None:
                yield finding

    def _task_findings(self, check: TaskCheck) -> Iterator[Finding]:
        found = list(check.findings(self._figures, self._counted.next))
        yield from found
        if self._lesson.variant and not self._quick and not found:
            yield from check.findings_over_seeds(self._counted.next)
