"""What is asked on a page: predictions and questions whose answers contradict each other or a figure."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.findings import Finding, Location, near, shown
from rl_tui.lab.lessons.figures.written import in_digits_of
from rl_tui.lab.lessons.spotlights import SPOTLIGHTS

if TYPE_CHECKING:
    from rl_tui.lab.lessons.figures.figures import LessonFigures
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.lessons.schema import Ask

_FIGURE: Final = re.compile(r"\{([a-z][a-z0-9_-]*)\}")
_SLACK: Final = 1e-9


def page_findings(
    lesson: Lesson, raw: Mapping[str, Any], figures: LessonFigures, *, quick: bool
) -> Iterator[Finding]:
    """Yield what is wrong with spotlights, predictions and questions. ``raw`` is the file without figures."""
    for number, page in enumerate(lesson.pages):
        where: Location = ("pages", number)
        if page.spotlight is not None and page.spotlight not in SPOTLIGHTS:
            expected = f"the id of a panel: {', '.join(SPOTLIGHTS)}{near(page.spotlight, SPOTLIGHTS)}"
            yield Finding((*where, "spotlight"), shown(page.spotlight), expected)
        if page.asked is not None:
            kind = "prediction" if page.prediction is not None else "question"
            written = raw["pages"][number][kind].get("answer")
            yield from _ask_findings(page.asked, written, (*where, kind), figures, quick=quick)


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
            yield Finding(
                at, shown(wrong.answer), f"a wrong answer: {shown(ask.answer)} is right, ± {ask.tolerance:g}"
            )
        elif any(abs(wrong.answer - each) <= _SLACK for each in known):
            yield Finding(at, f"{shown(wrong.answer)} twice", "each wrong answer once")
        known.append(wrong.answer)


def _answer_findings(
    ask: Ask, answer: float, written: object, where: Location, figures: LessonFigures, *, quick: bool
) -> Iterator[Finding]:
    """Yield that an answer is no figure, or that who knows it exactly would be told that it is wrong."""
    figure = _FIGURE.fullmatch(written.strip()) if isinstance(written, str) else None
    if figure is None:
        if answer not in (0.0, 1.0):
            yield Finding(
                (*where, "answer"), shown(answer), 'a figure, answer = "{name}", that is worked out'
            )
        return
    name = figure[1]
    if quick and figures.needs_seeds(name):
        return
    if figures.finding(name) is not None:
        return  # told of the figure itself
    exact = figures.value(name)
    if isinstance(exact, int | float) and abs(exact - answer) > ask.tolerance + _SLACK * max(
        1.0, abs(answer)
    ):
        found = f"{shown(answer)} ± {ask.tolerance:g}"
        expected = f"a tolerance that takes the exact answer in: {in_digits_of(float(exact), '')}"
        yield Finding((*where, "tolerance"), found, expected)


def _choice_findings(ask: Ask, where: Location) -> Iterator[Finding]:
    seen = set[str]()
    for number, choice in enumerate(ask.choices):
        if choice.text in seen:
            yield Finding((*where, "choices", number, "text"), shown(choice.text), "each choice once")
        seen.add(choice.text)
