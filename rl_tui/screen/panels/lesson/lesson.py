"""The open page of a lesson, all of it beside the world, or one row where the world has the place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, NamedTuple

from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.common.words import counted
from rl_tui.lessons.file.schema import Ask, Page, Task
from rl_tui.lessons.file.view import NO_STEP, ConditionView, Given, LessonView
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Block, Flow, Labelled, Row, Text
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.panels.lesson.prose import prose_lines
from rl_tui.screen.panels.lesson.words import (
    DONE,
    NOT_COUNTED,
    PageStage,
    answer_text,
    condition_sign,
    in_run_text,
    next_keys,
    open_page,
    page_place,
    reply_to,
    stage_of,
    steps_to_truth,
    summary_line,
    truth_text,
    verdict_piece,
    went_another_way,
)
from rl_tui.screen.theme.look import Look

_SIGN: Final = 3  # cells of a sign before a text


@dataclass(frozen=True, slots=True)
class Spotlight:
    """The panel that a page says to look at: its ``title``, and the ``key`` that opens it.

    ``is_seen`` says that it has a place on the screen. The key is empty where none opens it.
    """

    title: str
    is_seen: bool = True
    key: str = ""


class PageLines(NamedTuple):
    """The lines of a page; ``news`` is the place of what came last: answer, hint or explanation."""

    lines: list[Line]
    news: int


def page_lines(
    view: LessonView, snapshot: Snapshot, look: Look, width: int, spotlight: Spotlight | None = None
) -> PageLines:
    """Return the open page in ``width`` cells, all of it."""
    lines: list[Line] = []
    news = 0
    for block in _Page(view, snapshot, look).blocks(spotlight):
        if block is _NEWS:
            news = len(lines)
        elif block is not BLANK or (lines and lines[-1]):
            lines += block.lines(max(1, width - 1), look)
    return PageLines(lines, news)


_NEWS: Final = Flow(())
"""What stands below it came last."""


@dataclass(frozen=True, slots=True)
class _Prose:
    """A text with paragraphs, lists and equations."""

    text: str

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return its lines behind a margin."""
        margin = Piece(" ", look.palette.text)
        lines = prose_lines(self.text, max(1, width - 1), look)
        return [[margin, *line] if line else [] for line in lines]


class _Page:
    """What stands on the open page, where it has come to."""

    def __init__(self, view: LessonView, snapshot: Snapshot, look: Look) -> None:
        self._view = view
        self._record = view.record
        self._page: Page = open_page(view.record)
        self._snapshot = snapshot
        self._stage = stage_of(view, snapshot)
        self._look = look
        self._palette = look.palette

    def blocks(self, spotlight: Spotlight | None) -> Iterator[Block]:
        page = self._page
        yield Text(page.title, self._palette.strong)
        if spotlight is not None:
            yield self._look_at(spotlight)
        if page.text:
            yield from (BLANK, _Prose(page.text))
        if page.prediction is not None:
            yield from self._prediction(page.prediction)
        if page.question is not None:
            yield from self._question(page.question)
        if page.task is not None:
            yield from self._task(page.task)
        if page.explanation and self._stage in DONE:
            yield from (BLANK, _Prose(page.explanation))

    def _prediction(self, ask: Ask) -> Iterator[Block]:
        palette, given = self._palette, self._record.given_on(self._page.id)
        yield from self._head("Guess" if self._page.guess else "Predict")
        yield _Prose(ask.ask)
        if given is None:
            yield from self._choices(ask)
            yield from (BLANK, self._key("A", "say what you expect; no step is taken before"))
            return
        yield from (BLANK, _NEWS, self._locked(ask, given))
        missing = steps_to_truth(ask, given, self._snapshot)
        if missing:
            to_go = f": {missing:,} to go" if missing < ask.steps else ""
            yield Text(f"The truth comes {counted(ask.steps, 'step')} later{to_go}.", palette.dim)
            return
        truth = truth_text(ask, given, self._look.glyphs)
        yield self._row(verdict_piece(given.is_right, self._look), Piece(truth, palette.text))
        yield from self._in_run(ask)
        yield _Prose(reply_to(ask, given.answer, is_right=given.is_right))
        right, made = self._record.predictions
        told = f"{right} of {counted(made, 'prediction')} right so far."
        yield Text(NOT_COUNTED if self._page.guess else told, palette.dim)

    def _in_run(self, ask: Ask) -> Iterator[Block]:
        in_run = self._view.in_run
        if in_run is None:
            return
        yield Text(f"In your run: {in_run_text(in_run, self._look.glyphs)}", self._palette.strong)
        if went_another_way(ask, in_run):
            yield Text("Your run went another way: b goes back, r p restarts it.", self._palette.text)

    def _locked(self, ask: Ask, given: Given) -> Block:
        at = "" if given.step == NO_STEP else f" at step {given.step:,}"
        said = answer_text(ask, given.answer, self._look.glyphs)
        text = f"You said: {said} (locked{at})" if ask.choices else f"You said {said}{at}; locked."
        return Text(text, self._palette.strong)

    def _question(self, ask: Ask) -> Iterator[Block]:
        yield from self._head("Question")
        yield _Prose(ask.ask)
        given = self._record.last_given_on(self._page.id)
        if given is not None:
            said = answer_text(ask, given.answer, self._look.glyphs)
            verdict = verdict_piece(given.is_right, self._look)
            yield from (BLANK, _NEWS, self._row(verdict, Piece(f" – {said}", self._palette.text)))
            yield _Prose(reply_to(ask, given.answer, is_right=given.is_right))
            if given.is_right:
                return
            yield BLANK
        yield from self._choices(ask)
        yield from (BLANK, self._key("A", "answer" if given is None else "try again"))

    def _choices(self, ask: Ask) -> Iterator[Block]:
        return (_Prose(f"- {choice.text}") for choice in ask.choices)

    def _task(self, task: Task) -> Iterator[Block]:
        yield from self._head("Do")
        yield from (_Prose(task.do), BLANK)
        view = self._view.task
        is_passed = self._stage is PageStage.PASSED
        for condition in self._conditions(task):
            found = f" ({condition.found})" if condition.found else ""
            yield self._beside(condition_sign(condition.holds, self._look), f"{condition.text}{found}")
        if view is not None:
            yield Text("" if is_passed else view.waits, self._palette.dim)
            yield from (BLANK, _NEWS) if view.remarks else ()
            for remark in view.remarks:  # what was found of a program
                yield self._beside(Piece(self._look.glyphs.cursor, self._palette.strong), remark)
        if not is_passed:
            yield from self._hints(task)
            yield from (BLANK, *self._what_to_press(task))
            return
        yield from (BLANK, _NEWS, self._row(Piece(f"{self._look.glyphs.holds} PASSED", self._palette.good)))
        yield from self._hints(task)

    def _conditions(self, task: Task) -> Sequence[ConditionView]:
        """Return how the conditions stood when the task was passed, until then how they stand.

        Of a task that is rightly called impossible they never hold all.
        """
        passed = next((each for each in self._record.passed if each.page == self._page.id), None)
        if passed is not None and not passed.claim:
            return [ConditionView(each.text, True) for each in task.conditions]
        return () if self._view.task is None else self._view.task.conditions

    def _what_to_press(self, task: Task) -> Iterator[Block]:
        dim = self._palette.dim
        if task.program is None:
            yield Labelled("A", dim, _SIGN, Text("if you think that it cannot be done", dim, "", ""))
            return
        yield self._key("A", f"writes {task.program.file}, and once it is there checks it")
        yield Text(f"rl-tui watch {task.program.file} in another terminal shows it at work.", dim)

    def _hints(self, task: Task) -> Iterator[Block]:
        hints = {f"hint {number} of {len(task.hints)}": each for number, each in enumerate(task.hints, 1)}
        hints |= {"solution": task.solution} if task.solution else {}
        asked, is_passed = self._record.hints_on(self._page.id), self._stage is PageStage.PASSED
        for number, (name, hint) in enumerate(hints.items(), start=1):
            if number <= asked:
                yield BLANK
                if number == min(asked, len(hints)) and not is_passed:
                    yield _NEWS
                yield from (Text(name.capitalize(), self._palette.strong), _Prose(hint))
        if not is_passed and asked < len(hints):
            following = list(hints)[asked]
            yield from (BLANK, self._key("h", "the solution" if following == "solution" else following))

    def _look_at(self, spotlight: Spotlight) -> Block:
        mark = self._look.glyphs.cursor
        opens = f": {spotlight.key} opens it" if spotlight.key else ": not in view here, f zooms a panel"
        where = "" if spotlight.is_seen else opens
        return self._row(Piece(f"{mark} look at {spotlight.title}{where}", self._palette.strong))

    def _head(self, text: str) -> Sequence[Block]:
        return BLANK, self._row(Piece(text, self._palette.strong))

    def _key(self, key: str, does: str) -> Block:
        return self._beside(Piece(key, self._palette.press), does)

    def _beside(self, sign: Piece, text: str) -> Block:
        return Labelled(sign.text, sign.style, _SIGN, Text(text, self._palette.text, "", ""))

    def _row(self, *pieces: Piece) -> Block:
        """Return ``pieces`` in a row, in further ones of the first one's style where they are too long."""
        text = "".join(piece.text for piece in pieces)
        whole = [Piece(" ", self._palette.text), *pieces]
        return Row(whole, instead=[Text(text, pieces[0].style, rest="   ")])


TO_WORLD: Final = "R: to the world"

_Shown = tuple[str, PageStage | None, int, tuple[str, ...]]
"""The open page, where it stands, how many hints and answers there were, and the remarks on a program."""


class LessonPanel(ScrolledPanel):
    """Draws the open page of the lesson in the newest snapshot; a new page begins at its top.

    What is new on it, such as an answer or a hint, comes into view. In one row it says how the page stands.
    ``spotlight`` is the panel that the page says to look at; ``is_manual`` says that a person acts in place
    of the agent, ``takes_turns`` that the page hides the world. ``following`` is the title of the next
    lesson, empty where there is none or that is not known.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        *scroll_bindings("lesson"),
        binding("enter", "screen.do('lesson.go_on')", "lesson.go_on", "Do what the page asks next"),
    ]
    title = "Lesson"
    spotlight: Spotlight | None = None
    is_manual = False
    takes_turns = False
    following = ""
    _shown: _Shown = ("", None, 0, ())

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the page, or its row."""
        view = None if snapshot is None else snapshot.lesson
        if snapshot is None or view is None or height > 1:
            strips = super().picture(snapshot, width, height)
            self.footing = self.fitting(self._footings(self.keys(snapshot), height), width)
            return strips
        self.heading = self.footing = ""
        return strips_of([summary_line(view, snapshot, self.look, width)], width, height, self.look)

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of the page."""
        view = None if snapshot is None else snapshot.lesson
        if snapshot is None or view is None:
            return []
        record = view.record
        written = page_lines(view, snapshot, self.look, width, self.spotlight)
        lines = written.lines
        remarks = () if view.task is None else view.task.remarks
        told = record.hints_on(record.page) + len(record.given)
        shown = record.page, stage_of(view, snapshot), told, remarks
        self._follow(shown, written.news, len(lines), height)
        title = f"{record.lesson.title} · {page_place(record)}"
        self.heading = self.fitting((title, f"Lesson · {page_place(record)}", page_place(record)), width)
        return strips_of(lines, width, len(lines), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key of what is to do next."""
        if snapshot is None or snapshot.lesson is None:
            return (TO_WORLD,)
        keys = next_keys(
            snapshot.lesson,
            snapshot,
            has_focus=self.has_focus,
            is_manual=self.is_manual,
            following=self.following,
        )
        page = open_page(snapshot.lesson.record)
        if not self.takes_turns or (page.spotlight is None and page.task is None):
            return keys
        own = [each for each in keys if "to the world" not in each and not each.startswith("R:")]
        return *(f"{each} · {TO_WORLD}" for each in own), TO_WORLD

    def _footings(self, keys: Sequence[str], height: int) -> Sequence[str]:
        below = self._rows_in_all - self._first - height
        if below > 0:
            return *(f"↓ {below:,} more · {each}" for each in keys), f"↓ {below:,} more"
        return (*(f"↑ · {each}" for each in keys), *keys) if self._first else keys

    def _follow(self, shown: _Shown, news: int, rows: int, height: int) -> None:
        before, self._shown = self._shown, shown
        if before[0] != shown[0]:
            self._first = 0
        elif before != shown and not self._first <= news < rows <= self._first + height:
            self._first = max(0, min(news - 1, rows - height))

    def on_focus(self) -> None:
        """Name the keys that count now."""
        self.redraw()

    def on_blur(self) -> None:
        """Name them again."""
        self.redraw()

    def on_click(self, event: events.Click) -> None:
        """Read the page where its row was clicked."""
        if self.size.height == 1:
            event.stop()
            self.app.simulate_key("R")
