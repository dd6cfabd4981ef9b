"""Numbers in the texts of a lesson that no figure stands for.

Each has to be a figure, ``{name}``, or to stand in what the page itself is made of: settings of its setup,
rewards and chances of its world, its conditions, answers and attempts. 0 and 1 are always there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.catalogue import parameters_of
from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, Location, shown
from rl_tui.lab.lessons.figures.written import written_number
from rl_tui.lab.run.changes import read_change
from rl_tui.worlds.drawing import Grid

if TYPE_CHECKING:
    from rl_tui.lab.lessons.figures.figures import LessonFigures
    from rl_tui.lab.lessons.figures.subject import FigureSubject
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.lessons.schema import Page

PROSE: Final = frozenset(
    ("title", "summary", "goals", "text", "explanation", "ask", "reply", "do", "hints", "solution")
)
"""The keys of a lesson file under which texts stand that learners read."""
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
    """Yield the numbers that nothing stands behind. ``raw`` is the file as it was read, without figures."""
    for location, text in _texts({key: value for key, value in raw.items() if key != "pages"}, ()):
        yield from _findings(location, text, _ALWAYS, ())
    pages = raw.get("pages", [])
    for number, (page, table) in enumerate(zip(lesson.pages, pages, strict=True)):
        allowed, states = _allowed(page, figures)
        for location, text in _texts(table, ("pages", number)):
            yield from _findings(location, text, allowed, states)


def _texts(value: Any, location: Location) -> Iterator[tuple[Location, str]]:
    """Yield the texts that learners read in a table, and where they stand."""
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
            expected = "a figure, {name}, a number of the page's own setup, or a word"
            yield Finding(location, shown(numeral), expected)


def numerals_in(text: str, states: tuple[str, ...] = ()) -> list[str]:
    """Return the numbers that ``text`` writes, each once; not the names of ``states``, code or references."""
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
    """Return the numbers of which a page is made, without signs, and the names of its world's states."""
    numbers = set(_ALWAYS)
    names: tuple[str, ...] = ()
    try:
        subject = figures.subject_of_page(page.id)
        numbers.update(_settings(subject), _world(subject))
        names = tuple(subject.world.space.state_names)
    except UserError:
        pass  # told elsewhere: a setup that cannot be played
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
    """Yield rewards and chances of the world, its limits, and the size of its map."""
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
            yield read_change(text).value
        except ValueError:
            continue  # told where the attempt is replayed
