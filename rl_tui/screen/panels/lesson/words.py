"""The stage of a lesson page."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum, auto
from typing import Final

from rl_tui.common.words import counted
from rl_tui.lessons.file.schema import Ask, Page, Task
from rl_tui.lessons.file.view import NO_STEP, Given, LessonRecord, LessonView
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, length, shortened, spelled
from rl_tui.screen.panels.lesson.prose import plain
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

Offer = tuple[tuple[str, str], ...]
"""One form of the keys to press now, with their effects."""


class PageStage(Enum):
    """The stage of a page."""

    TO_READ = auto()  # it asks nothing
    TO_PREDICT = auto()  # a prediction is open: no step is taken
    LOCKED = auto()  # predicted: steps to the true result remain
    TOLD = auto()  # the true result is shown
    TO_ANSWER = auto()  # a question, unanswered or answered wrong
    ANSWERED = auto()
    TO_DO = auto()
    PASSED = auto()


DONE: Final = (PageStage.TO_READ, PageStage.TOLD, PageStage.ANSWERED, PageStage.PASSED)
"""Stages in which a page asks nothing more."""


def open_page(record: LessonRecord) -> Page:
    """Return the open page."""
    return record.lesson.page(record.page)


def stage_of(view: LessonView, snapshot: Snapshot) -> PageStage:
    """Return the open page's stage."""
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
    """Return the missing steps to a prediction's result.

    The branch's furthest step counts, because the run may have gone back. Work on a later page also reveals
    the result.
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
    """Return the first page from here on that hides ``what``."""
    if what not in record.hidden:
        return None
    lesson = record.lesson
    for page in lesson.pages[lesson.number_of(record.page) :]:
        is_open = page.id not in record.skipped and not record.is_done(page.id)
        if is_open and (what in page.hides or (what == "run" and page.prediction is not None)):
            return page
    return None


def name_of_deed(page: Page) -> str:
    """Name in one word what ``page`` asks."""
    if page.prediction is not None:
        return "Guess" if page.guess else "Predict"
    return "Do" if page.task is not None else "Question"


def _asks_for_program(record: LessonRecord) -> bool:
    task = open_page(record).task
    return task is not None and task.program is not None


def turns_to_truth(record: LessonRecord) -> bool:
    """Return whether the predicted steps follow on the next page."""
    ask = open_page(record).prediction
    return ask is not None and ask.keys[:1] == ("enter",)


def _page_place(record: LessonRecord) -> str:
    return f"{record.lesson.number_of(record.page) + 1}/{len(record.lesson.pages)}"


def progress(record: LessonRecord, cells: int, glyphs: Glyphs) -> str:
    """Return place and progress line."""
    done = round(cells * (record.lesson.number_of(record.page) + 1) / len(record.lesson.pages))
    place = f"page {_page_place(record).replace('/', ' of ')}"
    return f"{place} {glyphs.track_done * done}{glyphs.track_rest * (cells - done)}".rstrip()


def is_last_page(record: LessonRecord) -> bool:
    """Return whether the last page is open."""
    return record.page == record.lesson.pages[-1].id


NOT_COUNTED: Final = "A guess does not count as a prediction."

_LEAST_TITLE = 8
_LONGEST_SAID = 16
_MOST_ONE_BY_ONE = 12
"""Steps that people take one by one, rather than run."""


def number_text(x: float, glyphs: Glyphs) -> str:
    """Write an answer: 0.5, 184,616."""
    if x == int(x) and 10_000 <= abs(x) < 1e12:
        return numbers.whole(x, glyphs)
    return numbers.brief(x, glyphs, leading_zero=True)


def answer_text(ask: Ask, answer: float, glyphs: Glyphs) -> str:
    """Write the answer to ``ask``."""
    if not ask.choices:
        return number_text(answer, glyphs)
    return plain(ask.choices[min(max(int(answer), 0), len(ask.choices) - 1)].text)


def truth_text(ask: Ask, given: Given, glyphs: Glyphs) -> str:
    """Write the correct answer after a verdict."""
    if ask.answer is not None:
        return f" – it is {number_text(ask.answer, glyphs)}"
    if given.is_right:
        return ""
    return f" – the answer: {'; '.join(plain(choice.text) for choice in ask.choices if choice.right)}"


def in_run_text(in_run: float | str | bool, glyphs: Glyphs) -> str:
    """Write the run's result, or its absence."""
    if isinstance(in_run, bool):
        return "yes" if in_run else "no"
    return in_run if isinstance(in_run, str) else number_text(in_run, glyphs)


def went_another_way(ask: Ask, in_run: float | str | bool | None) -> bool:
    """Return whether the run differs beyond the answer's tolerance."""
    if in_run is None or ask.choices:
        return False
    return isinstance(in_run, str) or not ask.is_right(float(in_run))


def reply_to(ask: Ask, answer: float, *, is_right: bool) -> str:
    """Return the author's reply to an answer."""
    if ask.choices:
        return ask.choices[min(max(int(answer), 0), len(ask.choices) - 1)].reply
    if is_right:
        return ""
    near = [(abs(each.answer - answer), each) for each in ask.wrong]
    distance, nearest = min(near, key=lambda each: each[0], default=(0.0, None))
    return nearest.reply if nearest is not None and distance <= max(ask.tolerance, 1e-9) else ""


def named_hints(task: Task) -> dict[str, str]:
    """Return hints by name, the solution last."""
    hints = {f"hint {number} of {len(task.hints)}": each for number, each in enumerate(task.hints, 1)}
    return hints | ({"solution": task.solution} if task.solution else {})


def next_hint(record: LessonRecord) -> str:
    """Name the next hint, if any."""
    page = open_page(record)
    names = [] if page.task is None or record.has_passed(page.id) else [*named_hints(page.task)]
    return next(iter(names[record.hints_on(page.id) :]), "")


def next_keys(
    view: LessonView,
    snapshot: Snapshot,
    *,
    is_more: bool = False,
    takes_turns: bool = False,
    is_manual: bool = False,
    following: str = "",
) -> tuple[Offer, ...]:
    """Return forms of the keys to press now, enter first.

    ``takes_turns``: a key leads to the world. ``is_manual``: a person acts.
    """
    world: Offer = (("esc", "world"),) if takes_turns else ()
    does: tuple[str, ...]
    match stage_of(view, snapshot):
        case PageStage.TO_PREDICT:
            does = ("your guess",) if open_page(view.record).guess else ("your prediction",)
        case PageStage.TO_ANSWER:
            again = view.record.last_given_on(view.record.page) is not None
            does = ("try again",) if again else ("your answer",)
        case PageStage.TO_DO if _asks_for_program(view.record):
            does = ("your program",)
        case PageStage.TO_DO:
            does = ("do it",) if takes_turns else ("your task",)
        case PageStage.LOCKED:
            ways = _ways_to_truth(view, snapshot, is_manual=is_manual)
            world = (("enter", "world"),) if takes_turns and not turns_to_truth(view.record) else ()
            return tuple((*world, way) for way in ways)
        case _ if is_more:
            does = ("read on",)
        case _ if is_last_page(view.record) and not following:
            return ((("esc", "the lessons"),),)
        case _ if is_last_page(view.record):
            world = (("esc", "the lessons"),) if takes_turns else ()
            does = (f"next lesson: {following}", "next lesson")
        case _:
            does = ("next page",)
    return tuple((("enter", each), *world) for each in does)


def _ways_to_truth(view: LessonView, snapshot: Snapshot, *, is_manual: bool) -> tuple[tuple[str, str], ...]:
    ask, given = open_page(view.record).prediction, view.record.given_on(view.record.page)
    assert ask is not None
    assert given is not None
    missing = steps_to_truth(ask, given, snapshot)
    if ask.keys:
        key = " then ".join(each for each in ask.keys if not (is_manual and each == "y")) or "act"
    elif missing > _MOST_ONE_BY_ONE:
        key = "space or u"
    elif snapshot.agent.row.planner:
        key = "e or s"
    else:
        key = "act" if is_manual else "s"
    steps = counted(ask.steps, "step")
    if missing < ask.steps:
        to_go = f"{missing:,} to go"
        return (key, f"to the result: {steps}, {to_go}"), (key, f"to the result: {to_go}"), (key, to_go)
    return (key, f"to the result: {steps}"), (key, "to the result")


def summary_line(view: LessonView, snapshot: Snapshot, look: Look, width: int) -> Line:
    """Summarize the page in one row."""
    record, palette = view.record, look.palette
    page, marks = open_page(record), list(_marks(view, snapshot, look))
    tail: list[Piece] = [Piece("  ", palette.text), *marks] if marks else []
    place = _page_place(record)
    title = page.title if page.task is None or stage_of(view, snapshot) in DONE else plain(page.task.do)
    key = Piece(look.glyphs.separated(" · enter reads"), palette.dim)
    line = spelled([Piece(f" {place} {title}", palette.strong), *tail, key], look)
    if length(line) <= width:
        return line
    room = width - length(spelled([*tail, key], look))
    if room < _LEAST_TITLE:
        return spelled([Piece(f" {place}", palette.strong), *tail], look)
    head = shortened(look.glyphs.separated(f" {place} {title}"), room, look.glyphs.ellipsis)
    return [Piece(head, palette.strong), *spelled([*tail, key], look)]


def _marks(view: LessonView, snapshot: Snapshot, look: Look) -> Iterator[Piece]:
    palette, stage = look.palette, stage_of(view, snapshot)
    match stage:
        case PageStage.TO_DO if view.task is not None:
            for condition in view.task.conditions:
                yield condition_sign(condition.holds, look)
            if view.task.waits:
                yield Piece(f" {view.task.waits}", palette.dim)
        case PageStage.PASSED:
            yield Piece(f"{look.glyphs.holds} PASSED", palette.good)
        case PageStage.TO_PREDICT:
            yield Piece("your prediction", palette.you)
        case PageStage.TO_ANSWER:
            yield Piece("your answer", palette.you)
        case PageStage.LOCKED:
            ask, given = open_page(view.record).prediction, view.record.given_on(view.record.page)
            if ask is not None and given is not None:
                said = answer_text(ask, given.answer, look.glyphs)
                missing = counted(steps_to_truth(ask, given, snapshot), "step")
                yield Piece(
                    f"you said {shortened(said, _LONGEST_SAID, look.glyphs.ellipsis)}; {missing}", palette.you
                )
        case PageStage.TOLD:
            ask, given = open_page(view.record).prediction, view.record.given_on(view.record.page)
            if given is not None:
                yield verdict_piece(given.is_right, look)
            if ask is not None and view.in_run is not None and went_another_way(ask, view.in_run):
                yield Piece(f"; in your run {in_run_text(view.in_run, look.glyphs)}", palette.bad)
        case _:
            return


def condition_sign(holds: bool | None, look: Look) -> Piece:
    """Return a condition's sign."""
    if holds is None:
        return Piece(look.glyphs.ellipsis, look.palette.dim)
    if holds:
        return Piece(look.glyphs.holds, look.palette.good)
    return Piece(look.glyphs.open, look.palette.strong)


def verdict_piece(is_right: bool, look: Look) -> Piece:
    """Return sign and word of a verdict."""
    if is_right:
        return Piece(f"{look.glyphs.holds} right", look.palette.good)
    return Piece(f"{look.glyphs.fails} not right", look.palette.bad)
