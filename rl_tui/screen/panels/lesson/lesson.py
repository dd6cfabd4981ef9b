"""The open page of a lesson, with the current task below."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, NamedTuple

from rich.style import Style
from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.common.words import counted
from rl_tui.lessons.file.schema import Ask, Page, Task
from rl_tui.lessons.file.view import NO_STEP, ConditionView, Given, LessonRecord, LessonView
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, first_that_fits, shortened, strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Block, Flow, Labelled, Row, Text
from rl_tui.screen.kit.scrolling import ScrolledPanel
from rl_tui.screen.panels.lesson import words
from rl_tui.screen.panels.lesson.prose import prose_lines
from rl_tui.screen.panels.status_line import WaitingRow, waiting_line
from rl_tui.screen.theme.look import Look

_BOLD: Final = Style(bold=True)
_BAR: Final = "┃"  # beside the task
_SIGN: Final = 3  # cells of a sign before a text
_WIDEST: Final = 60  # cells of a line of text
_MARGIN: Final = 2  # cells before a line
_AROUND_A_TITLE: Final = 4  # cells
_TRACKS: Final = (24, 12, 0)  # cells of the progress line
_LEAST_TEXT: Final = 6  # rows kept for the text above the task


@dataclass(frozen=True, slots=True)
class Spotlight:
    """The panel to look at, and its ``key``."""

    title: str
    is_seen: bool = True
    key: str = ""


class PageLines(NamedTuple):
    """A page's lines. ``news``: the newest answer, hint or explanation."""

    text: list[Line]
    now: list[Line]
    news: int


def _page_lines(
    view: LessonView, snapshot: Snapshot, look: Look, width: int, spotlight: Spotlight | None = None
) -> PageLines:
    page = _Page(view, snapshot, look)
    text, news = _lines(page.text(spotlight), " ", look.palette.text, width, look)
    now, _ = _lines(page.now(), _BAR, look.palette.you, width, look)
    return PageLines(text, now, news)


def _lines(
    blocks: Iterable[Block], margin: str, style: Style, width: int, look: Look
) -> tuple[list[Line], int]:
    lines: list[Line] = []
    news = 0
    for block in blocks:
        if block is _NEWS:
            news = len(lines)
        elif block is not BLANK or (lines and len(lines[-1]) > 1):
            made = block.lines(max(1, min(width - _MARGIN, _WIDEST + 1)), look)
            lines += [[Piece(margin, style), *line] for line in made]
    return lines, news


_NEWS: Final = Flow(())
"""A marker: everything below it is new."""


@dataclass(frozen=True, slots=True)
class _Prose:
    text: str
    style: Style | None = None

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        margin = Piece(" ", look.palette.text)
        lines = prose_lines(self.text, max(1, width - 1), look, self.style)
        return [[margin, *line] if line else [] for line in lines]


class _Page:
    def __init__(self, view: LessonView, snapshot: Snapshot, look: Look) -> None:
        self._view = view
        self._record = view.record
        self._page: Page = words.open_page(view.record)
        self._snapshot = snapshot
        self._stage = words.stage_of(view, snapshot)
        self._look = look
        self._palette = look.palette

    def text(self, spotlight: Spotlight | None) -> Iterator[Block]:
        page, is_done = self._page, self._stage in words.DONE
        if spotlight is not None:
            yield self._look_at(spotlight)
        if page.text:
            yield from (BLANK, _Prose(page.text))
        if page.prediction is not None and is_done:
            yield from self._told(page.prediction)
        if page.question is not None:
            yield from self._question(page.question) if is_done else self._last_answer(page.question)
        if page.task is not None:
            yield from self._done(page.task) if is_done else self._found(page.task)
        if page.explanation and is_done:
            yield from (BLANK, _Prose(page.explanation))

    def now(self) -> Iterator[Block]:
        if self._stage in words.DONE:
            return
        ask, task = self._page.asked, self._page.task
        given = self._record.given_on(self._page.id)
        if ask is not None:
            yield from self._asked(ask)
            if self._stage is not words.PageStage.LOCKED:
                yield from (_Prose(f"- {choice.text}") for choice in ask.choices)
            elif given is not None:
                yield self._locked(ask, given)
        if task is not None:
            yield from self._to_do(task)
            yield from (Text(self._view.task.waits, self._palette.dim),) if self._view.task else ()
            if task.program is not None:
                watch = f"rl-tui watch {task.program.file} in another terminal shows it at work."
                yield Text(watch, self._palette.dim)

    def _head(self) -> Block:
        palette = self._palette
        style = palette.strong if self._stage in words.DONE else palette.you + _BOLD
        return self._row(Piece(words.name_of_deed(self._page), style))

    def _asked(self, ask: Ask) -> Iterator[Block]:
        is_open = self._stage in (words.PageStage.TO_PREDICT, words.PageStage.TO_ANSWER)
        yield from (self._head(), _Prose(ask.ask, self._palette.strong if is_open else None))

    def _told(self, ask: Ask) -> Iterator[Block]:
        palette, given = self._palette, self._record.given_on(self._page.id)
        yield from (BLANK, *self._asked(ask))
        if given is None:
            return
        truth = words.truth_text(ask, given, self._look.glyphs)
        yield from (BLANK, _NEWS, self._locked(ask, given))
        yield self._row(words.verdict_piece(given.is_right, self._look), Piece(truth, palette.text))
        yield from self._in_run(ask)
        yield from (BLANK, _Prose(words.reply_to(ask, given.answer, is_right=given.is_right)))
        right, made = self._record.predictions
        told = f"{right} of {counted(made, 'prediction')} right so far."
        yield Text(words.NOT_COUNTED if self._page.guess else told, palette.dim)

    def _in_run(self, ask: Ask) -> Iterator[Block]:
        in_run = self._view.in_run
        if in_run is None:
            return
        yield Text(f"In your run: {words.in_run_text(in_run, self._look.glyphs)}", self._palette.strong)
        if words.went_another_way(ask, in_run):
            yield Text("Your run went another way: b goes back, r p restarts it.", self._palette.text)

    def _locked(self, ask: Ask, given: Given) -> Block:
        at = "" if given.step == NO_STEP else f" at step {given.step:,}"
        said = words.answer_text(ask, given.answer, self._look.glyphs)
        text = f"You said{':' if ask.choices else ''} {said} (locked{at})"
        return Text(text, self._palette.strong)

    def _question(self, ask: Ask) -> Iterator[Block]:
        yield from (BLANK, *self._asked(ask), *self._last_answer(ask))

    def _last_answer(self, ask: Ask) -> Iterator[Block]:
        given = self._record.last_given_on(self._page.id)
        if given is not None:
            said = words.answer_text(ask, given.answer, self._look.glyphs)
            verdict = words.verdict_piece(given.is_right, self._look)
            yield from (BLANK, _NEWS, self._row(verdict, Piece(f" – {said}", self._palette.text)))
            yield _Prose(words.reply_to(ask, given.answer, is_right=given.is_right))

    def _to_do(self, task: Task) -> Iterator[Block]:
        is_open = self._stage is words.PageStage.TO_DO
        yield from (self._head(), _Prose(task.do, self._palette.strong if is_open else None))
        for condition in self._conditions(task):
            found = f" ({condition.found})" if condition.found else ""
            yield self._beside(words.condition_sign(condition.holds, self._look), f"{condition.text}{found}")

    def _found(self, task: Task) -> Iterator[Block]:
        view = self._view.task
        yield from (BLANK, _NEWS) if view is not None and view.remarks else ()
        for remark in () if view is None else view.remarks:
            yield self._beside(Piece(self._look.glyphs.cursor, self._palette.strong), remark)
        yield from self._hints(task)

    def _done(self, task: Task) -> Iterator[Block]:
        passed = Piece(f"{self._look.glyphs.holds} PASSED", self._palette.good)
        yield from (BLANK, *self._to_do(task), BLANK, _NEWS, self._row(passed))
        yield from self._hints(task)

    def _conditions(self, task: Task) -> Sequence[ConditionView]:
        passed = next((each for each in self._record.passed if each.page == self._page.id), None)
        if passed is not None and not passed.claim:
            return [ConditionView(each.text, True) for each in task.conditions]
        return () if self._view.task is None else self._view.task.conditions

    def _hints(self, task: Task) -> Iterator[Block]:
        hints = words.named_hints(task)
        asked, is_passed = self._record.hints_on(self._page.id), self._stage is words.PageStage.PASSED
        for number, (name, hint) in enumerate(hints.items(), start=1):
            if number <= asked:
                yield BLANK
                if number == min(asked, len(hints)) and not is_passed:
                    yield _NEWS
                yield from (Text(name.capitalize(), self._palette.strong), _Prose(hint))

    def _look_at(self, spotlight: Spotlight) -> Block:
        mark = self._look.glyphs.cursor
        opens = f": {spotlight.key} shows it" if spotlight.key else ": not in view, f fills the screen"
        where = "" if spotlight.is_seen else opens
        return self._row(Piece(f"{mark} look at {spotlight.title}{where}", self._palette.you))

    def _beside(self, sign: Piece, text: str) -> Block:
        return Labelled(sign.text, sign.style, _SIGN, Text(text, self._palette.text, "", ""))

    def _row(self, *pieces: Piece) -> Block:
        text = "".join(piece.text for piece in pieces)
        whole = [Piece(" ", self._palette.text), *pieces]
        return Row(whole, instead=[Text(text, pieces[0].style, rest="   ")])


_Shown = tuple[str, words.PageStage | None, int, tuple[str, ...]]
"""Page, stage, number of hints and answers, and remarks."""


class LessonPanel(ScrolledPanel, WaitingRow):
    """The open page of the lesson.

    The task stays visible at the bottom, the text above scrolls to news. One row shows the progress, or why
    the run waits. ``takes_turns``: the page hides the world. ``following``: title of the next lesson.
    """

    class Offered(Message):
        """The current task changed."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "scroll_rows(-1)", "lesson.up", "Scroll up"),
        binding("down", "scroll_rows(1)", "lesson.down", "Scroll down"),
        binding("home", "scroll_rows(-999)", "lesson.first", "To the top"),
        binding("end", "scroll_rows(999)", "lesson.last", "To the end"),
    ]
    title = "Lesson"
    spotlight: Spotlight | None = None
    is_manual = False
    takes_turns = replaces_header = False
    is_pinned = False
    """True if the task is in view whatever part of the text is."""
    following = ""
    offers: tuple[words.Offer, ...] = ()
    _shown: _Shown = ("", None, 0, ())
    _lines: Sequence[Line] = ()
    _news = 0

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the page, or its row."""
        if snapshot is None or snapshot.lesson is None or height == 1:
            self.heading = self.footing = ""
        if snapshot is None or snapshot.lesson is None:
            return strips_of([], width, height, self.look)
        if height == 1:
            self._offer(((("enter", "page"),),))
            line = None
            if self.replaces_header:
                line = waiting_line(snapshot, self.look, width, unanswered=self.unanswered)
            line = line or words.summary_line(snapshot.lesson, snapshot, self.look, width)
            return strips_of([line], width, height, self.look)
        return self._page(snapshot.lesson, snapshot, width, height)

    def _page(self, view: LessonView, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        text, now, self._news = _page_lines(view, snapshot, self.look, width - 1, self.spotlight)
        gap: list[Line] = [[]] if text else []
        is_spaced = len(text) + len(now) + 4 <= height
        ask = words.open_page(view.record).asked
        is_typed = self.takes_turns and ask is not None and not ask.choices  # its box covers the last rows
        if now and (is_spaced or is_typed):
            now = [*now, [self._margin(view, snapshot)]]
        text = [[], *text] if is_spaced else text
        self.is_pinned = height - len(now) - 2 >= min(_LEAST_TEXT, len(text))
        self._lines = text if self.is_pinned else [*text, *gap, *now]
        foot = [*gap, *(now if self.is_pinned else ())]
        area = max(0, min(len(self._lines), height - len(foot) - 1))
        strips = super().picture(snapshot, width, area)
        below = len(self._lines) - self._first - area
        self._offer(
            words.next_keys(
                view,
                snapshot,
                is_more=below > 0,
                takes_turns=self.takes_turns,
                is_manual=self.is_manual,
                following=self.following,
            )
        )
        self._label(view.record, below, width)
        keys = self._key_row(view, snapshot, width, is_alone=not self.is_pinned and below > 0)
        foot = [*foot, keys][-height:]
        return [*strips, *strips_of(foot, width, height - len(strips), self.look)]

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the scrolling rows."""
        if snapshot is not None and snapshot.lesson is not None:
            view, record = snapshot.lesson, snapshot.lesson.record
            told = record.hints_on(record.page) + len(record.given)
            remarks = () if view.task is None else view.task.remarks
            self._follow((record.page, words.stage_of(view, snapshot), told, remarks), height)
        return strips_of(self._lines, width, len(self._lines), self.look)

    def hints(self, snapshot: Snapshot | None, *, is_scrolled: bool) -> Sequence[str]:
        """Return nothing: the border shows the progress."""
        return ()

    def scroll_page(self, pages: int) -> bool:
        """Scroll, and return whether anything moved."""
        before = self._first
        self.action_scroll_pages(pages)
        return self._first != before

    def _offer(self, offers: tuple[words.Offer, ...]) -> None:
        if offers != self.offers:
            self.offers = offers
            self.post_message(self.Offered())

    def _key_row(self, view: LessonView, snapshot: Snapshot, width: int, *, is_alone: bool) -> Line:
        palette, hint = self.look.palette, words.next_hint(view.record)
        start = [self._margin(view, snapshot)]
        word = (
            [Piece(f" {words.name_of_deed(words.open_page(view.record))} ", palette.you + _BOLD)]
            if is_alone
            else []
        )
        hints: words.Offer = (("h", hint),) if hint else ()
        forms = [
            [*start, *word, *(piece for each in (*before, *form) for piece in _hint(*each, self.look))]
            for before in (hints, ())
            for form in self.offers
        ]
        return first_that_fits(forms, width, self.look)

    def _margin(self, view: LessonView, snapshot: Snapshot) -> Piece:
        is_done = words.stage_of(view, snapshot) in words.DONE
        return Piece(" " if is_done else _BAR, self.look.palette.you)

    def _label(self, record: LessonRecord, below: int, width: int) -> None:
        title = words.open_page(record).title
        self.heading = self.fitting((title, shortened(title, width - _AROUND_A_TITLE, "…")), width)
        tracks = [words.progress(record, cells, self.look.glyphs) for cells in _TRACKS]
        more = [f"{counted(below, 'more line')} · {each}" for each in tracks] if below > 0 else []
        self.footing = self.fitting((*more, *tracks), width)

    def _follow(self, shown: _Shown, height: int) -> None:
        before, self._shown = self._shown, shown
        news, rows = self._news, len(self._lines)
        if before[0] != shown[0]:
            self._first = 0
        elif before != shown and not self._first <= news < rows <= self._first + height:
            self._first = max(0, min(news - 1, rows - height))

    def on_click(self, event: events.Click) -> None:
        """Open the page from its row."""
        if self.size.height == 1:
            event.stop()
            self.app.simulate_key("enter")


def _hint(key: str, does: str, look: Look) -> tuple[Piece, Piece]:
    return Piece(f" {key}", look.palette.press), Piece(f" {does} ", look.palette.text)
