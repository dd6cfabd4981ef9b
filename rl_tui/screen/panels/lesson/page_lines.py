"""The open page of a lesson as lines: its text, what it asks, how that stands, hints and explanation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from rich.style import Style

from rl_tui.lessons.file.schema import Ask, Page, Task
from rl_tui.lessons.file.view import NO_STEP, ConditionView, Given, LessonView
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, wrapped
from rl_tui.screen.panels.lesson.prose import prose_lines
from rl_tui.screen.panels.lesson.stage import PageStage, open_page, stage_of, steps_to_truth
from rl_tui.screen.panels.lesson.words import (
    NOT_COUNTED,
    answer_text,
    condition_sign,
    counted,
    in_run_text,
    reply_to,
    truth_text,
    verdict_piece,
    went_another_way,
)
from rl_tui.screen.theme.look import Look

_MARGIN = 1


@dataclass(frozen=True, slots=True)
class Spotlight:
    """The panel that a page says to look at: its ``title``, and the ``key`` that opens it.

    ``is_seen`` says that it has a place on the screen. The key is empty where none opens it.
    """

    title: str
    is_seen: bool = True
    key: str = ""


@dataclass(slots=True)
class PageLines:
    """The lines of a page; ``news`` is the place of what came last: answer, hint or explanation."""

    lines: list[Line] = field(default_factory=list)
    news: int = 0


def page_lines(
    view: LessonView, snapshot: Snapshot, look: Look, width: int, spotlight: Spotlight | None = None
) -> PageLines:
    """Return the open page in ``width`` cells, all of it."""
    return _Writer(view, snapshot, look, width).written(spotlight)


class _Writer:
    def __init__(self, view: LessonView, snapshot: Snapshot, look: Look, width: int) -> None:
        self._view = view
        self._record = view.record
        self._page: Page = open_page(view.record)
        self._snapshot = snapshot
        self._stage = stage_of(view, snapshot)
        self._look = look
        self._palette = look.palette
        self._room = max(1, width - 2 * _MARGIN)
        self._out = PageLines()

    def written(self, spotlight: Spotlight | None) -> PageLines:
        page = self._page
        self._say(page.title, is_strong=True)
        if spotlight is not None:
            self._look_at(spotlight)
        if page.text:
            self._gap()
            self._prose(page.text)
        if page.prediction is not None:
            self._prediction(page.prediction)
        if page.question is not None:
            self._question(page.question)
        if page.task is not None:
            self._task(page.task)
        if page.explanation and self._stage in (PageStage.TOLD, PageStage.ANSWERED, PageStage.PASSED):
            self._gap()
            self._prose(page.explanation)
        if self._stage is PageStage.TO_READ and page.explanation:
            self._gap()
            self._prose(page.explanation)
        return self._out

    def _prediction(self, ask: Ask) -> None:
        self._head("Guess" if self._page.guess else "Predict")
        self._prose(ask.ask)
        given = self._record.given_on(self._page.id)
        if given is None:
            self._choices(ask)
            self._gap()
            self._key("A", "say what you expect; no step is taken before")
            return
        self._gap()
        self._news()
        self._locked(ask, given)
        missing = steps_to_truth(ask, given, self._snapshot)
        if missing:
            to_go = f": {missing:,} to go" if missing < ask.steps else ""
            self._say(f"The truth comes {counted(ask.steps, 'step')} later{to_go}.", is_dim=True)
            return
        truth = truth_text(ask, given, self._look.glyphs)
        self._row([verdict_piece(given.is_right, self._look), Piece(truth, self._palette.text)])
        self._in_run(ask)
        self._reply(reply_to(ask, given.answer, is_right=given.is_right))
        if self._page.guess:
            self._say(NOT_COUNTED, is_dim=True)
            return
        right, made = self._record.predictions
        self._say(f"{right} of {counted(made, 'prediction')} right so far.", is_dim=True)

    def _in_run(self, ask: Ask) -> None:
        in_run = self._view.in_run
        if in_run is None:
            return
        self._say(f"In your run: {in_run_text(in_run, self._look.glyphs)}", is_strong=True)
        if went_another_way(ask, in_run):
            self._say("Your run went another way: b goes back, N sets it up again.")

    def _locked(self, ask: Ask, given: Given) -> None:
        at = "" if given.step == NO_STEP else f" at step {given.step:,}"
        said = answer_text(ask, given.answer, self._look.glyphs)
        text = f"You said: {said} (locked{at})" if ask.choices else f"You said {said}{at}; locked."
        self._say(text, is_strong=True)

    def _question(self, ask: Ask) -> None:
        self._head("Question")
        self._prose(ask.ask)
        given = self._record.last_given_on(self._page.id)
        if given is None:
            self._choices(ask)
            self._gap()
            self._key("A", "answer")
            return
        self._gap()
        self._news()
        said = answer_text(ask, given.answer, self._look.glyphs)
        self._row([verdict_piece(given.is_right, self._look), Piece(f" – {said}", self._palette.text)])
        self._reply(reply_to(ask, given.answer, is_right=given.is_right))
        if not given.is_right:
            self._gap()
            self._choices(ask)
            self._gap()
            self._key("A", "try again")

    def _choices(self, ask: Ask) -> None:
        for choice in ask.choices:
            self._prose(f"- {choice.text}")

    def _task(self, task: Task) -> None:
        self._head("Do")
        self._prose(task.do)
        self._gap()
        view = self._view.task
        is_passed = self._stage is PageStage.PASSED
        for condition in self._conditions(task):
            sign = condition_sign(condition.holds, self._look)
            found = f" ({condition.found})" if condition.found else ""
            self._beside(sign, condition.text, found)
        if view is not None and view.waits and not is_passed:
            self._say(view.waits, is_dim=True)
        self._remarks(() if view is None else view.remarks)
        if not is_passed:
            self._hints(task)
            self._gap()
            self._what_to_press(task)
            return
        self._gap()
        self._news()
        self._row([Piece(f"{self._look.glyphs.holds} PASSED", self._palette.good)])
        self._hints(task)

    def _conditions(self, task: Task) -> Sequence[ConditionView]:
        """Return how the conditions stood when the task was passed, until then how they stand.

        Of a task that is rightly called impossible they never hold all.
        """
        passed = next((each for each in self._record.passed if each.page == self._page.id), None)
        if passed is not None and not passed.claim:
            return [ConditionView(each.text, True) for each in task.conditions]
        return () if self._view.task is None else self._view.task.conditions

    def _remarks(self, remarks: Sequence[str]) -> None:
        """Write what was found of a program, each with a sign of its own."""
        if not remarks:
            return
        self._gap()
        self._news()
        for remark in remarks:
            self._beside(Piece(self._look.glyphs.cursor, self._palette.strong), remark)

    def _what_to_press(self, task: Task) -> None:
        if task.program is None:
            dim = self._palette.dim
            self._beside(Piece("A", dim), "if you think that it cannot be done", style=dim)
            return
        self._key("A", f"writes {task.program.file}, and once it is there checks it")
        self._say(f"rl-tui watch {task.program.file} in another terminal shows it at work.", is_dim=True)

    def _hints(self, task: Task) -> None:
        all_hints = [*task.hints, *([task.solution] if task.solution else [])]
        asked = min(self._record.hints_on(self._page.id), len(all_hints))
        for number, hint in enumerate(all_hints[:asked], start=1):
            is_solution = bool(task.solution) and number == len(all_hints)
            self._gap()
            if number == asked and self._stage is not PageStage.PASSED:
                self._news()
            self._say("Solution" if is_solution else f"Hint {number} of {len(task.hints)}", is_strong=True)
            self._prose(hint)
        if self._stage is not PageStage.PASSED and asked < len(all_hints):
            is_solution = bool(task.solution) and asked + 1 == len(all_hints)
            self._gap()
            self._key("H", "the solution" if is_solution else f"hint {asked + 1} of {len(task.hints)}")

    def _reply(self, text: str) -> None:
        if text:
            self._prose(text)

    def _look_at(self, spotlight: Spotlight) -> None:
        mark = self._look.glyphs.cursor
        opens = f": {spotlight.key} opens it" if spotlight.key else ": not in view here, f zooms a panel"
        where = "" if spotlight.is_seen else opens
        self._row([Piece(f"{mark} look at {spotlight.title}{where}", self._palette.strong)])

    # How it is written

    def _news(self) -> None:
        """Note that what is written next came last."""
        self._out.news = len(self._out.lines)

    def _gap(self) -> None:
        if self._out.lines and self._out.lines[-1]:
            self._out.lines.append([])

    def _head(self, text: str) -> None:
        self._gap()
        self._row([Piece(text, self._palette.strong)])

    def _key(self, key: str, does: str) -> None:
        self._beside(Piece(key, self._palette.press), does)

    def _say(self, text: str, *, is_strong: bool = False, is_dim: bool = False) -> None:
        palette = self._palette
        style = palette.strong if is_strong else palette.dim if is_dim else palette.text
        for line in wrapped(text, self._room, style, self._look):
            self._put(line)

    def _beside(self, sign: Piece, text: str, note: str = "", style: Style | None = None) -> None:
        """Write ``text`` behind ``sign``, its further lines below its first."""
        room = max(1, self._room - 2)
        lines = wrapped(f"{text}{note}", room, style or self._palette.text, self._look)
        for number, line in enumerate(lines):
            first = sign if not number else Piece(" ", sign.style)
            self._put([first, Piece(" ", self._palette.text), *line])

    def _row(self, pieces: Sequence[Piece]) -> None:
        """Write ``pieces`` in a row, in further ones of the last one's style where they are too long."""
        first, *rest = pieces
        text = "".join(piece.text for piece in rest)
        lines = wrapped(f"{first.text}{text}", self._room, first.style, self._look, "", "  ")
        self._put([first, *rest] if len(lines) == 1 else lines[0])
        for line in lines[1:]:
            self._put(line)

    def _prose(self, text: str) -> None:
        for line in prose_lines(text, self._room, self._look):
            self._put(line)

    def _put(self, line: Line) -> None:
        margin = Piece(" " * _MARGIN, self._palette.text)
        self._out.lines.append([margin, *line] if line else [])
