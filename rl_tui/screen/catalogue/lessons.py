"""The lessons screen: all lessons in order, with what each teaches and your progress."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, ClassVar, Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.text import Text
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.events import Key
from textual.message import Message
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.lessons.file.view import begun
from rl_tui.live.sessions.progress import LessonEntries, LessonEntry, LessonStart, lesson_entries, start_of
from rl_tui.live.sessions.session import StoredSession
from rl_tui.screen.catalogue.facts import FullWidth, bullets, faults_text, labelled
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.frame.action_screen import ActionScreen
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.terminal.key_queue import EarlyKeys
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.screen.dialogs.dialog import Dialog

# Texts about a lesson


DONE: Final = "✓"


def state_of(entry: LessonEntry) -> str:
    """Return in a few words how far one has come."""
    progress = entry.progress
    if progress is None:
        return "not begun"
    if entry.is_at_end:
        done = progress.finished or progress.tasks_passed == progress.tasks
        passed = f"{progress.tasks_passed} of {counted(progress.tasks, 'task')}"
        return f"{DONE} finished" if done else f"at its end · {passed}"
    here = f"page {entry.lesson.number_of(progress.page) + 1} of {len(entry.lesson.pages)}"
    return f"{DONE} {here}" if progress.finished else here


def lesson_details(entry: LessonEntry, look: Look) -> RenderableType:
    """Return the details of a lesson."""
    lesson, text = entry.lesson, look.palette.text
    rows = {label: Text(separated(line, look.glyphs)) for label, line in _lines(entry).items()}
    return Group(
        Text(to_ascii(lesson.summary, look.glyphs), text),
        Text(""),
        labelled(rows, look),
        Text("\nAfterwards you can", look.palette.dim),
        bullets(lesson.goals, look),
    )


def progress_line(found: LessonEntries) -> str:
    """Return in a sentence how far one has come in all lessons together."""
    begun = [entry.progress for entry in found.entries if entry.progress is not None]
    if not begun:
        return "Begin with the first: enter. Nothing moves on by itself."
    right = sum(progress.predictions_right for progress in begun)
    made = sum(progress.predictions_made for progress in begun)
    finished = f"{found.finished} of {len(found.entries)} finished"
    return f"{finished} · {right} of {counted(made, 'prediction')} right" if made else finished


def _lines(entry: LessonEntry) -> dict[str, str]:
    lesson, progress = entry.lesson, entry.progress
    if progress is None:
        return {
            "takes": f"about {lesson.minutes} min · {counted(len(lesson.pages), 'page')}",
            "tasks": f"{len(lesson.tasks) or 'none'}",
            "enter": "begins",
        }
    made, tasks = progress.predictions_made, progress.tasks
    here = f"{state_of(entry)}: {lesson.page(progress.page).title}"
    return {
        "stands at": state_of(entry) if entry.is_at_end else here,
        "tasks": f"{progress.tasks_passed} of {tasks} passed" if tasks else "none",
        "predictions": f"{progress.predictions_right} of {made} right" if made else "none so far",
        "enter": "opens it as a reference" if entry.is_at_end else "goes on there",
    }


# The list of lessons


_LONGEST_NAME: Final = 255

Entry = LessonEntry | ScenarioError


class LessonList(OptionList):
    """A list of lessons, of which ``current`` is under the cursor."""

    def __init__(self, look: Look) -> None:
        super().__init__(id="lessons", classes="panel")
        self._look = look
        self.border_title = "Lessons"
        self._entries: Sequence[Entry] = ()

    def show(self, entries: Sequence[Entry], start_at: str) -> None:
        """List ``entries``, with the cursor on the lesson of the id ``start_at``, else on the first."""
        self._entries = entries
        self.clear_options()
        self.add_options(self._rows())
        ids = [each.lesson.id if isinstance(each, LessonEntry) else "" for each in entries]
        if entries:
            self.highlighted = ids.index(start_at) if start_at in ids else 0

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, None where there is no cursor."""
        return None if self.highlighted is None else self._entries[self.highlighted]

    def _rows(self) -> Iterator[Option]:
        digits = len(str(len(self._entries)))
        for number, entry in enumerate(self._entries, start=1):
            if isinstance(entry, LessonEntry):
                title = to_ascii(entry.lesson.title, self._look.glyphs)
                minutes = "" if entry.is_at_end else f" · {entry.lesson.minutes} min"
                state = separated(f"{state_of(entry)}{minutes}", self._look.glyphs)
                yield Option(_Row(f"{number:>{digits}}", title, state, self._look))
            else:
                name = one_line(entry.faults[0].file.rsplit("/", 1)[-1], _LONGEST_NAME)
                yield Option(_Row(" " * digits, to_ascii(name, self._look.glyphs), "faulty", self._look))


class _Row(FullWidth):
    """Two lines: ``number`` and ``title``, and below the ``state``. Neither is broken."""

    def __init__(self, number: str, title: str, state: str, look: Look) -> None:
        self._number = number
        self._title = title
        self._state = state
        self._look = look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width, ellipsis = options.max_width, self._look.glyphs.ellipsis
        yield Text(shortened(f"{self._number} {self._title}", width, ellipsis), no_wrap=True)
        indent = " " * (cell_len(self._number) + 1)
        yield Text(shortened(f"{indent}{self._state}", width, ellipsis), no_wrap=True)


# The screen


_NONE: Final = "No lessons are here: they stand beside the scenarios that come with rl-tui. Install it again."


class LessonsScreen(ActionScreen):
    """Left the lessons, right what is known of the one under the cursor.

    They are read in a thread after the first paint; keys typed before wait for them. ``sessions`` is the
    folder of sessions, which say how far one has come, None where none are kept.
    """

    CSS_PATH = "lessons.tcss"
    BINDINGS: ClassVar[list[BindingType]] = bindings_of(actions_of(Place.LESSONS))
    place = Place.LESSONS

    @dataclass
    class LessonChosen(Message):
        """The user wants to begin a lesson, or to go on with it."""

        start: LessonStart | StoredSession

    @dataclass
    class ListClosed(Message):
        """The user goes back to the catalogue."""

    @dataclass
    class EntriesRead(Message):
        """The files of the lessons, and of the sessions, are read."""

        found: LessonEntries

    def __init__(
        self, look: Look, start_at: str = "", fault: UserError | None = None, sessions: Path | None = None
    ) -> None:
        super().__init__(look)
        self._start_at = start_at
        self._comes_from_lesson = bool(start_at)
        self._fault = fault
        self._sessions = sessions
        self._read = asyncio.Event()
        moves = {binding.key for binding in Binding.make_bindings(LessonList.BINDINGS)}
        self._early_keys = EarlyKeys(moves.union(*(action.keys for action in actions_of(Place.LESSONS))))

    def content(self) -> Iterable[Widget]:
        """Yield the list and the details."""
        title = " rl-tui · learn step by step"
        yield Static(separated(f"{title} · kiosk" if self.in_kiosk else title, self.look.glyphs), id="title")
        yield Static(id="progress", markup=False)
        details = VerticalScroll(Static(id="about", markup=False), id="details", classes="panel")
        details.border_subtitle = "tab, arrows: scroll"
        yield Horizontal(LessonList(self.look), details, id="columns")

    def on_mount(self) -> None:
        """Begin to read once the first paint is done."""
        self.query_one(LessonList).focus()
        if self._fault is not None:
            self.notify(str(self._fault), severity="error", timeout=15, markup=False)
        self.run_worker(self._read_when_painted, name="begin", group="begin")  # type: ignore[arg-type]

    async def _read_when_painted(self) -> None:
        if isinstance(self.app, LinkedApp):
            await self.app.painted()
        Thread(target=self._read_lessons, name="read lessons", daemon=True).start()

    def _read_lessons(self) -> None:
        """In the thread: only messages leave it."""
        found = lesson_entries(self._sessions)
        with suppress(RuntimeError):  # the program has ended meanwhile
            self.post_message(self.EntriesRead(found))

    def on_lessons_screen_entries_read(self, event: EntriesRead) -> None:
        """List the lessons."""
        found = event.found
        self.query_one("#progress", Static).update(f" {separated(progress_line(found), self.look.glyphs)}")
        self.query_one(LessonList).show([*found.entries, *found.broken], self._start_at or found.goes_on_at)
        self.show_current()
        self._read.set()
        self._early_keys.release(self.app)

    def on_key(self, event: Key) -> None:
        """Hold back what is for the list until that is there."""
        if self._early_keys.take(event):
            event.stop()

    async def settled(self) -> None:
        """Wait until the lessons are read and listed."""
        await self._read.wait()

    def on_option_list_option_highlighted(self) -> None:
        """Show the details of the lesson under the cursor."""
        self.show_current()

    def on_option_list_option_selected(self) -> None:
        """Open the lesson."""
        self.action_open_lesson()

    def show_current(self) -> None:
        """Show the details of the lesson under the cursor."""
        entry, details = self.query_one(LessonList).current, self.query_one("#details")
        about = self.query_one("#about", Static)
        details.scroll_home(animate=False)
        if isinstance(entry, LessonEntry):
            details.border_title = Content(to_ascii(entry.lesson.title, self.look.glyphs))
            about.update(lesson_details(entry, self.look))
        elif isinstance(entry, ScenarioError):
            details.border_title = "Faults"
            head = "This lesson cannot be taken until its file is mended."
            about.update(faults_text(head, entry.faults, self.look))
        else:
            details.border_title = ""
            about.update(_NONE)

    def action_open_lesson(self) -> None:
        """Begin the lesson under the cursor, go on with it, or open it as a reference."""
        entry = self._entry()
        if entry is not None:
            self.run_worker(self._open(entry), name="open the lesson", exclusive=True, group="open")

    async def _open(self, entry: LessonEntry) -> None:
        try:
            start = await asyncio.to_thread(start_of, entry.lesson, entry.progress)  # may import Gymnasium
        except UserError as fault:
            self.notify(str(fault), severity="error", timeout=15, markup=False)
        else:
            self.post_message(self.LessonChosen(start))

    def action_begin_again(self) -> None:
        """Begin the lesson under the cursor again, once that is confirmed."""
        from rl_tui.screen.dialogs.dialog import Confirm

        entry = self._entry()
        if entry is None:
            return
        if entry.progress is None:
            self.action_open_lesson()
            return

        def begin(answer: bool | None) -> None:
            if answer:
                self.post_message(self.LessonChosen(LessonStart(begun(entry.lesson))))

        question = (
            f"Begin {entry.lesson.title} again, at its first page? What you did in it until now stays among "
            "the sessions of the catalogue."
        )
        self.app.push_screen(Confirm("Begin again", question, "begin again", self.look.glyphs), begin)

    def action_leave_lessons(self) -> None:
        """Go back to the catalogue; who comes out of a lesson is asked for a press of its own."""
        if self._comes_from_lesson:
            self._comes_from_lesson = False
            self.tell("these are the lessons; esc again goes to the catalogue")
            return
        self.post_message(self.ListClosed())

    def _entry(self) -> LessonEntry | None:
        """Return the lesson under the cursor; where there is none, say so."""
        entry = self.query_one(LessonList).current
        if isinstance(entry, LessonEntry):
            return entry
        if entry is not None:
            self.tell("this file has faults; mend them first", severity="warning")
        return None

    def help_screen(self) -> Dialog[str]:
        """Return the help, from its first line on or from the keys on."""
        from rl_tui.screen.frame.help import HelpScreen

        return HelpScreen(self.look)
