"""The lessons: all of them in their order, with what one learns in each and how far one has come."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import ClassVar, Final

from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.events import Key
from textual.message import Message
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.lab.course.entries import LessonEntries, LessonEntry, LessonStart, lesson_entries, start_of
from rl_tui.lab.lessons.record import begun
from rl_tui.lab.sessions.session import StoredSession
from rl_tui.terminal.linked_app import LinkedApp
from rl_tui.tui.actions.action import Place
from rl_tui.tui.actions.bindings import bindings_of
from rl_tui.tui.actions.registry import actions_of
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.screens.action_screen import ActionScreen
from rl_tui.tui.screens.early_keys import EarlyKeys
from rl_tui.tui.screens.lessons.lesson_list import LessonList
from rl_tui.tui.screens.lessons.lesson_text import lesson_details, lesson_faults, progress_line
from rl_tui.tui.theme.look import Look

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
        self,
        look: Look,
        start_at: str = "",
        fault: UserError | None = None,
        sessions: Path | None = None,
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
            about.update(lesson_faults(entry, self.look))
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
        from rl_tui.tui.screens.dialogs.confirm import Confirm

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

    def help_screen(self, *, at_keys: bool = False) -> Screen[None]:
        """Return the help, from its first line on or from the keys on."""
        from rl_tui.tui.screens.help import HelpScreen

        return HelpScreen(self.look, self.actions, at_keys=at_keys)
