"""The actions of a lesson: turn its pages, answer, ask for hints, and restart its run."""

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
from rl_tui.screen.draw.to_ascii import to_ascii
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
_LONG: Final = 15.0  # seconds that a message stays that tells what to do
CANNOT_BE_DONE: Final = Candidate(
    _CLAIM, "It cannot be done", ("Are you sure? Then no setting and no luck passes this task.",)
)


@dataclass(eq=False)
class OwnProgram(Subject):
    """What a learner does with the program that a page asks for; ``files`` are theirs, by page."""

    files: dict[str, Path] = field(default_factory=dict)

    def answer(self, page: Page, program: ProgramToWrite, claim: Callable[[], None]) -> None:
        """Begin the program of ``page``; once it is begun, choose what to do with it.

        ``claim`` says that its task cannot be done.
        """
        if self.screen.in_kiosk or in_browser():
            self.screen.tell(NOT_HERE)
            return
        path = self.files.get(page.id)
        if path is None:
            self._ask_name(page, program)
            return
        candidates = (
            Candidate(_CHECK, f"Check {path.name}", ("It is run to its end, in a process of its own.",)),
            Candidate(_NAME, "Another file", ("Write the beginning again, or take a file that is there.",)),
            CANNOT_BE_DONE,
        )
        does: dict[str, Callable[[], None]] = {
            _CHECK: lambda: self._watch(path),
            _NAME: lambda: self._ask_name(page, program),
            _CLAIM: claim,
        }
        self.ask(Choice("Your program", candidates, "", self.glyphs), lambda chosen: does[chosen]())

    def _ask_name(self, page: Page, program: ProgramToWrite) -> None:
        hint = "A new file gets the beginning of the program. An existing file is not changed."
        prompt = Prompt("Your program", to_ascii(hint, self.glyphs), program.file, _read_name, "take")
        self.ask(prompt, lambda name: self._begin(page, program, Path(str(name))))

    def _begin(self, page: Page, program: ProgramToWrite, path: Path) -> None:
        """Write the skeleton where there is no such file; whatever is there stays as it is."""
        try:
            written = not path.exists()
            if written:
                write_new(path, program.skeleton)
        except (UserError, OSError) as fault:
            self.screen.notify(str(fault), severity="error", markup=False)
            return
        self.files[page.id] = path
        what = f"{path.name} is written" if written else f"{path.name} exists already and is not changed"
        how = "Edit it in another terminal, or press ctrl+z and come back with fg. Then enter checks it."
        self.screen.notify(to_ascii(f"{what}. {how}", self.glyphs), timeout=_LONG, markup=False)

    def _watch(self, path: Path) -> None:
        self.link.send(WatchProgram(path))
        if not self.board.lesson.is_docked:
            self.board.lesson.reads = True


def _read_name(text: str) -> str:
    """Return the path of the program in the working folder; raises ValueError where it can be none."""
    name = text.strip()
    if not is_file_name(name):
        raise ValueError("a name such as my_agent.py: letters, digits, - and _, in this folder")
    path = Path(name).absolute()
    if path.is_file():
        return str(path)
    try:
        return str(new_path(str(path)))
    except UserError as fault:
        raise ValueError(str(fault)) from fault


# Numbers as learners type them


_FRACTION: Final = re.compile(r"([+-]?\d{1,9}(?:\.\d{1,9})?)\s*/\s*(\d{1,9}(?:\.\d{1,9})?)", re.ASCII)
_NUMBER: Final = re.compile(r"[+-]?(?:\d{1,15}(?:\.\d{0,15})?|\.\d{1,15})(?:[eE][+-]?\d{1,3})?", re.ASCII)
EXPECTED: Final = "type a number, such as 0.5, -2 or 1/3"
NO_COMMA: Final = "write a decimal point, not a comma: 0.5, or 184616"


def read_answer(text: str) -> float:
    """Return the number that ``text`` is; raises ValueError with what to type where it is none."""
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
FIRST_PAGE: Final = "This is the first page."
SEEN_BEFORE: Final = "You are in the past. end: latest step, r p: restart."
CAN_BE_DONE: Final = "Not right: this can be done."
_LONGEST_REPLY: Final = 15.0


@dataclass(eq=False)
class LessonActions(Subject):
    """What a learner does with the lesson.

    What its pages have ``kept_back`` is closed when one is opened. ``set_out`` opens a record whose page has
    another setup. ``resume_acting`` lets a person go on acting, where they did so last.
    """

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
        """How far the learner has come, with all that was asked for; None where there is no lesson."""
        return self.link.wanted.lesson

    @property
    def stage(self) -> PageStage | None:
        """Where the open page stands, None before that is known."""
        snapshot, record = self.snapshot, self.record
        if snapshot is None or snapshot.lesson is None or record is None:
            return None
        return stage_of(replace(snapshot.lesson, record=record), snapshot)

    @property
    def is_over(self) -> bool:
        """Whether the last page is open and asks nothing any more."""
        return self.record is not None and is_last_page(self.record) and self.stage in DONE

    @property
    def offers(self) -> tuple[Offer, ...]:
        """What enter does now, for the key line: its forms, the longest first; none without a lesson.

        A key that the panel in focus takes is left out.
        """
        if self.record is None:
            return ()
        place, taken = self.board.lesson, keys_of(self.screen.focused)
        offers = place.panel.offers if place.is_in_view else ((("enter", "page"),),)
        forms = (tuple(each for each in form if key_of_hint(each[0]) not in taken) for form in offers)
        return tuple(form for form in forms if form)

    @property
    def is_asking(self) -> bool:
        """Whether an answer is due."""
        return self.record is not None and self.stage in (PageStage.TO_PREDICT, PageStage.TO_ANSWER)

    @property
    def idle_keys(self) -> frozenset[str]:
        """The ids of the actions that have nothing to do: the key line leaves them out.

        While an answer is due it names nothing else. It never names a key that the panel in focus takes.
        """
        if self.is_asking:
            return frozenset(each.id for each in self.screen.known_actions if each.id != "help")
        if self.record is None:
            return frozenset(each.id for each in LESSON_ACTIONS)
        taken = keys_of(self.screen.focused)
        idle = frozenset(each.id for each in LESSON_ACTIONS if not taken.isdisjoint(each.keys))
        return idle if next_hint(self.record) else idle | {"lesson.hint"}

    def rows(self, rows: tuple[PanelRow, ...]) -> tuple[PanelRow, ...]:
        """Return those of ``rows`` that may be there: without a lesson not its panel."""
        return rows if self.record is not None else tuple(row for row in rows if not row.of_lesson)

    # Reading

    def go_on(self) -> None:
        """Do what the page asks next, or show the page."""
        stage, place = self.stage, self.board.lesson
        if not place.is_in_view:
            self.board.zoom(None)
            place.reads = True
        elif self.is_asking:
            self._answer()
        elif stage is PageStage.TO_DO:
            self._choose_deed()
        elif stage is PageStage.LOCKED and self.record is not None and not turns_to_truth(self.record):
            self._show_way()
        else:
            self.next_page()

    def _show_way(self) -> None:
        """Show the world, where steps to the truth are to be taken, and say with which keys."""
        key, does = self.board.lesson.panel.offers[0][-1]
        self._show_world()
        self.screen.tell(f"{key}: {does}.")

    def _show_world(self) -> None:
        """Let the world have the place of the page, and the keys."""
        self.board.lesson.reads = False
        self.board.lesson.leave()

    def next_page(self) -> None:
        """Scroll the page to its end, then turn to the next; where this one is not done, say so first."""
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
        """Scroll the page to its top, then turn to the one before."""
        record, place = self.record, self.board.lesson
        if record is None or (place.is_in_view and place.panel.scroll_page(-1)):
            return
        number = record.lesson.number_of(record.page)
        if not number:
            self.screen.tell(FIRST_PAGE)
            return
        self._open(record, record.lesson.pages[number - 1])

    def _open(self, record: LessonRecord, page: Page) -> None:
        """Open ``page``: the run goes on where it has the same setup."""
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
            record = record.open(record.page)  # it is finished with its last page
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
        """Ask what to do about the task of the page: do it, or say that it cannot be done."""
        page = None if self.record is None else open_page(self.record)
        if page is None or page.task is None:
            return
        if page.task.program is not None:
            self._own_program.answer(page, page.task.program, lambda: self._claim(page))
            return
        do = Candidate("do", "Do it", ("Do it in the world.",))
        choice = Choice("Your task", (do, CANNOT_BE_DONE), "", self.glyphs, plain(page.task.do))
        self.ask(choice, lambda chosen: self._claim(page) if chosen == _CLAIM else self._show_world())

    def _ask_number(self, ask: Ask, *, is_prediction: bool) -> None:
        title = "Your prediction" if is_prediction else "Your answer"
        verb = "lock" if is_prediction else "answer"
        hint = to_ascii(f"{plain(ask.ask)}\nA number, as 0.5, −2 or 1/3.", self.glyphs)
        self.ask(Prompt(title, hint, "", read_answer, verb), lambda value: self._give(float(value)))

    def _ask_choice(self, ask: Ask) -> None:
        candidates = [Candidate(str(place), plain(choice.text)) for place, choice in enumerate(ask.choices)]
        choice = Choice("Your answer", candidates, "", self.glyphs, plain(ask.ask))
        self.ask(choice, lambda place: self._give(float(place)))

    def _give(self, answer: float) -> None:
        """Keep ``answer`` with where the run stands: of a prediction before any further step."""
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
            self.screen.tell(CAN_BE_DONE, timeout=_LONGEST_REPLY)
            return
        self._keep(record.passes(Passed(page.id, snapshot.recipe, (), snapshot.counters.step, claim=True)))
        self._tell_passed()

    def hint(self) -> None:
        """Show the next hint, at the end the solution."""
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
        """Begin the run of the page again; ask where something was done."""
        if self.snapshot is None or not self.snapshot.timeline.current.end:
            self._set_up()
            return
        question = "Restart with the settings of the page. Answers and passed tasks stay."
        self.ask(Confirm("Set the run up again?", question, "set up", self.glyphs), lambda _: self._set_up())

    def _set_up(self) -> None:
        record = self.record
        if record is None:
            return
        setup = record.lesson.setup_of(record.page)
        try:
            recipe = recipe_of(record.lesson, setup)
        except UserError as fault:
            self.screen.notify(str(fault), severity="error", markup=False)
            return
        self.link.send(Restart(recipe))
        speed = record.lesson.setups[setup].speed
        if speed is not None:
            self.link.send(SetSpeed(speed))
        self.screen.tell("The run of this page starts again.")

    # News

    def announce(self, before: Snapshot | None, now: Snapshot) -> None:
        """Keep a task that is passed, and say so; begin with the page where it and the world take turns."""
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
