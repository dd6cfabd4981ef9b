"""The actions of a lesson."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.files import new_path, write_new
from rl_tui.lessons.file.schema import Ask, Page, ProgramToWrite, is_file_name
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import Given, LessonRecord, Passed
from rl_tui.live.commands import KeepLesson, Restart, SetSpeed, WatchProgram
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.frame.message_line import complain
from rl_tui.screen.keys.playground_keys import LESSON_ACTIONS
from rl_tui.screen.kit.bindings import key_of_hint, keys_of
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.panels.lesson.prose import plain
from rl_tui.screen.panels.lesson.words import (
    DONE,
    Offer,
    PageStage,
    is_last_page,
    named_hints,
    next_hint,
    open_page,
    stage_of,
    turns_to_truth,
)
from rl_tui.screen.playground.actions.kept_back import KeptBack
from rl_tui.screen.playground.actions.next_lesson import NextLesson
from rl_tui.screen.terminal.driver_choice import in_browser

# Tasks that ask for a program


NOT_HERE: Final = "Not here: your code cannot run on this machine. pgdn: skip."
_CHECK, _NAME, _CLAIM = "check", "name", "claim"
_LONG: Final = 15.0  # seconds of a message with instructions
CANNOT_BE_DONE: Final = Candidate(
    _CLAIM, "It cannot be done", ("Are you sure? This says that no setting and no luck can pass the task.",)
)


@dataclass(eq=False)
class OwnProgram(Subject):
    """The learner's program, with ``files`` by page id."""

    files: dict[str, Path] = field(default_factory=dict)

    def answer(self, page: Page, program: ProgramToWrite, claim: Callable[[], None]) -> None:
        """Start the page's program, or choose what to do."""
        if self.screen.in_kiosk or in_browser():
            self.screen.tell(NOT_HERE)
            return
        path = self.files.get(page.id)
        if path is None:
            self._ask_name(page, program)
            return
        candidates = (
            Candidate(_CHECK, f"Check {path.name}", ("The program runs to its end, in its own process.",)),
            Candidate(_NAME, "Another file", ("Write the first lines again, or use an existing file.",)),
            CANNOT_BE_DONE,
        )
        does: dict[str, Callable[[], None]] = {
            _CHECK: lambda: self._watch(path),
            _NAME: lambda: self._ask_name(page, program),
            _CLAIM: claim,
        }
        self.ask(Choice("Your program", candidates, "", self.glyphs), lambda chosen: does[chosen]())

    def _ask_name(self, page: Page, program: ProgramToWrite) -> None:
        hint = "A new file gets the first lines of the program. An existing file is not changed."
        prompt = Prompt("Your program", self.glyphs.spelled(hint), program.file, _read_name, "take")
        self.ask(prompt, lambda name: self._begin(page, program, Path(str(name))))

    def _begin(self, page: Page, program: ProgramToWrite, path: Path) -> None:
        try:
            written = not path.exists()
            if written:
                write_new(path, program.skeleton)
        except (UserError, OSError) as fault:
            complain(self.screen.app, fault)
            return
        self.files[page.id] = path
        what = f"{path.name} is written" if written else f"{path.name} already exists and is not changed"
        how = "Edit it in another terminal, or press ctrl+z and come back with fg. Then enter checks it."
        self.screen.notify(self.glyphs.spelled(f"{what}. {how}"), timeout=_LONG, markup=False)

    def _watch(self, path: Path) -> None:
        self.link.send(WatchProgram(path))
        if not self.board.lesson.is_docked:
            self.board.lesson.reads = True


def _read_name(text: str) -> str:
    name = text.strip()
    if not is_file_name(name):
        raise ValueError("a name such as my_agent.py: letters, digits, - and _, in this folder")
    path = Path(name).absolute()
    return str(path if path.is_file() else new_path(str(path)))


# Typed numbers


_FRACTION: Final = re.compile(r"([+-]?\d{1,9}(?:\.\d{1,9})?)\s*/\s*(\d{1,9}(?:\.\d{1,9})?)", re.ASCII)
_NUMBER: Final = re.compile(r"[+-]?(?:\d{1,15}(?:\.\d{0,15})?|\.\d{1,15})(?:[eE][+-]?\d{1,3})?", re.ASCII)
EXPECTED: Final = "type a number, such as 0.5, -2 or 1/3"
NO_COMMA: Final = "write 0.5 with a decimal point, and 184616 without a comma"


def read_answer(text: str) -> float:
    """Return the number in ``text``, which may be a fraction. Raises ValueError for other text."""
    written = text.strip().replace("−", "-").replace("–", "-")
    if fraction := _FRACTION.fullmatch(written):
        below = float(fraction[2])
        if below == 0.0:
            raise ValueError("division by 0 is not possible")
        return float(fraction[1]) / below
    if _NUMBER.fullmatch(written) and math.isfinite(value := float(written)):
        return value
    if "," in written and _NUMBER.fullmatch(written.replace(",", "")):
        raise ValueError(NO_COMMA)
    raise ValueError(EXPECTED)


# The lesson


NOT_DONE: Final = "This page is not done. Press pgdn again to skip it."
SEEN_BEFORE: Final = "You are in the past. end: latest step, r p: restart."
CAN_BE_DONE: Final = "Not right: this can be done."


@dataclass(eq=False)
class LessonActions(Subject):
    """The learner's actions. ``set_out`` opens another setup."""

    kept_back: KeptBack
    set_out: Callable[[LessonRecord], object]
    resume_acting: Callable[[Snapshot], None]
    _to_be_skipped: str = ""
    """The page that one more press skips."""

    def __post_init__(self) -> None:
        self._own_program = OwnProgram(self.screen, self.board, self.link)
        self._next_lesson = NextLesson(self.screen, self.board, self.link)

    @property
    def record(self) -> LessonRecord | None:
        """The progress in the lesson, if any."""
        return self.link.wanted.lesson

    @property
    def stage(self) -> PageStage | None:
        """The page's stage, if known."""
        snapshot, record = self.snapshot, self.record
        if snapshot is None or snapshot.lesson is None or record is None:
            return None
        return stage_of(replace(snapshot.lesson, record=record), snapshot)

    @property
    def is_over(self) -> bool:
        """True if the last page is done."""
        return self.record is not None and is_last_page(self.record) and self.stage in DONE

    @property
    def offers(self) -> tuple[Offer, ...]:
        """The hints for enter."""
        if self.record is None:
            return ()
        place, taken = self.board.lesson, keys_of(self.screen.focused)
        offers = place.panel.offers if place.is_in_view else ((("enter", "page"),),)
        forms = (tuple(each for each in form if key_of_hint(each[0]) not in taken) for form in offers)
        return tuple(form for form in forms if form)

    @property
    def _is_asking(self) -> bool:
        return self.record is not None and self.stage in (PageStage.TO_PREDICT, PageStage.TO_ANSWER)

    @property
    def idle_keys(self) -> frozenset[str]:
        """The actions to leave out of the key line."""
        if self._is_asking:
            return frozenset(each.id for each in self.screen.known_actions if each.id != "help")
        if self.record is None:
            return frozenset(each.id for each in LESSON_ACTIONS)
        taken = keys_of(self.screen.focused)
        idle = frozenset(each.id for each in LESSON_ACTIONS if not taken.isdisjoint(each.keys))
        return idle if next_hint(self.record) else idle | {"lesson.hint"}

    def rows(self, rows: tuple[PanelRow, ...]) -> tuple[PanelRow, ...]:
        """Drop the lesson panel without a lesson."""
        return rows if self.record is not None else tuple(row for row in rows if not row.of_lesson)

    # Reading

    def go_on(self) -> None:
        """Do what the page asks, or show it."""
        stage, place = self.stage, self.board.lesson
        if not place.is_in_view:
            self.board.zoom(None)
            place.reads = True
        elif self._is_asking:
            self._answer()
        elif stage is PageStage.TO_DO:
            self._choose_deed()
        elif stage is PageStage.LOCKED and self.record is not None and not turns_to_truth(self.record):
            self._show_way()
        else:
            self.next_page()

    def _show_way(self) -> None:
        key, does = self.board.lesson.panel.offers[0][-1]
        self._show_world()
        self.screen.tell(f"{key}: {does}.")

    def _show_world(self) -> None:
        self.board.lesson.reads = False
        self.board.lesson.leave()

    def next_page(self) -> None:
        """Scroll to the end, then turn the page."""
        record, place = self.record, self.board.lesson
        if record is None or (place.is_in_view and place.panel.scroll_page(1)):
            return
        page = record.page
        is_undone = not record.is_done(page) and page not in record.skipped
        if is_undone and self._to_be_skipped != page:
            self._to_be_skipped = page
            self.screen.tell(NOT_DONE)
            return
        if is_undone:
            record = record.skip(page)
        if is_last_page(record):
            if is_undone:
                self._keep(record)
            self._next_lesson.turn()
            return
        pages = record.lesson.pages
        self._open(record, pages[record.lesson.number_of(page) + 1])

    def previous_page(self) -> None:
        """Scroll to the top, then turn back."""
        record, place = self.record, self.board.lesson
        if record is None or (place.is_in_view and place.panel.scroll_page(-1)):
            return
        number = record.lesson.number_of(record.page)
        if not number:
            self.screen.tell("This is the first page.")
            return
        self._open(record, record.lesson.pages[number - 1])

    def _open(self, record: LessonRecord, page: Page) -> None:
        self._to_be_skipped = ""
        lesson = record.lesson
        opened = record.open(page.id)
        if lesson.setup_of(page.id) != lesson.setup_of(record.page):
            self.set_out(opened)
            return
        self._keep(opened)
        self.kept_back.close_what_is_kept(opened)
        self.board.lesson.reads = True

    def _keep(self, record: LessonRecord) -> None:
        if is_last_page(record):
            record = record.open(record.page)  # the lesson is finished with its last page
        self.link.send(KeepLesson(record))

    # Answering

    def _answer(self) -> None:
        record, snapshot = self.record, self.snapshot
        ask = None if record is None else open_page(record).asked
        if record is None or ask is None or snapshot is None:
            return
        is_prediction = open_page(record).prediction is not None
        if is_prediction and snapshot.timeline.in_past:
            self.screen.tell(SEEN_BEFORE)
        elif ask.choices:
            self._ask_choice(ask)
        else:
            self._ask_number(ask, is_prediction=is_prediction)

    def _choose_deed(self) -> None:
        page = None if self.record is None else open_page(self.record)
        if page is None or page.task is None:
            return
        if page.task.program is not None:
            self._own_program.answer(page, page.task.program, lambda: self._claim(page))
            return
        do = Candidate("do", "Do it", ("Do it in the world.",))
        choice = Choice("Your task", (do, CANNOT_BE_DONE), "", self.glyphs, self._off_page(page.task.do))
        self.ask(choice, lambda chosen: self._claim(page) if chosen == _CLAIM else self._show_world())

    def _ask_number(self, ask: Ask, *, is_prediction: bool) -> None:
        title = "Your prediction" if is_prediction else "Your answer"
        verb = "lock" if is_prediction else "answer"
        hint = self.glyphs.spelled(f"{self._off_page(ask.ask)}\nA number, such as 0.5, −2 or 1/3.".strip())
        self.ask(Prompt(title, hint, "", read_answer, verb), lambda value: self._give(float(value)))

    def _ask_choice(self, ask: Ask) -> None:
        candidates = [Candidate(str(place), plain(choice.text)) for place, choice in enumerate(ask.choices)]
        choice = Choice("Your answer", candidates, "", self.glyphs, self._off_page(ask.ask))
        self.ask(choice, lambda place: self._give(float(place)))

    def _off_page(self, text: str) -> str:
        """Return ``text`` to repeat it, unless the page keeps it in view."""
        return "" if self.board.lesson.panel.is_pinned else plain(text)

    def _give(self, answer: float) -> None:
        record, snapshot = self.record, self.snapshot
        if record is None or snapshot is None or snapshot.lesson is None:
            return
        ask = open_page(record).asked
        if ask is None:
            return
        given = Given(
            record.page, answer, ask.is_right(answer), snapshot.counters.step, snapshot.lesson.digest
        )
        self._keep(record.give(given))

    def _claim(self, page: Page) -> None:
        record, snapshot = self.record, self.snapshot
        if record is None or snapshot is None or page.task is None:
            return
        if page.task.proof is None:
            self.screen.tell(CAN_BE_DONE, timeout=_LONG)
            return
        self._keep(record.passes(Passed(page.id, snapshot.recipe, (), snapshot.counters.step, claim=True)))
        self._tell_passed()

    def hint(self) -> None:
        """Show the next hint, then the solution."""
        record = self.record
        if record is None:
            return
        task = open_page(record).task
        if task is None or not (hints := named_hints(task)):
            self.screen.tell("There is no hint on this page.")
            return
        if record.hints_on(record.page) >= len(hints):
            self.screen.tell("That was the last hint. The solution is on the page.")
        else:
            self._keep(record.ask_hint(record.page))
        self.board.lesson.reads = True

    def set_up(self) -> None:
        """Restart the page's run, after a confirmation if steps were taken."""
        if self.snapshot is None or not self.snapshot.timeline.current.end:
            self._set_up()
            return
        question = "Restart with the settings of the page. Answers and passed tasks stay."
        self.ask(Confirm("Restart the run?", question, "set up", self.glyphs), lambda _: self._set_up())

    def _set_up(self) -> None:
        record = self.record
        if record is None:
            return
        setup = record.lesson.setup_of(record.page)
        try:
            recipe = recipe_of(record.lesson, setup)
        except UserError as fault:
            complain(self.screen.app, fault)
            return
        self.link.send(Restart(recipe))
        speed = record.lesson.setups[setup].speed
        if speed is not None:
            self.link.send(SetSpeed(speed))
        self.screen.tell("The run of this page starts again.")

    # News of the run

    def announce(self, before: Snapshot | None, now: Snapshot) -> None:
        """Record and announce a passed task."""
        view, record = now.lesson, self.record
        if view is None or record is None:
            return
        if before is None or before.lesson is None:
            self.board.lesson.reads = True
        self.resume_acting(now)
        self._next_lesson.look_for(record)
        passed = None if view.task is None else view.task.passed
        if passed is None or record.has_passed(passed.page):
            return  # the page may have been turned since
        self._keep(record.passes(passed))
        self._tell_passed()

    def _tell_passed(self) -> None:
        place = self.board.lesson
        self.screen.tell("Task passed." if place.is_in_view else "Task passed. enter: read why.")
