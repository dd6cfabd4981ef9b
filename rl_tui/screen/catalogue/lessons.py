"""The lesson list, with details and progress."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, ClassVar, Final

from rich.console import Group, RenderableType
from rich.text import Text
from textual import on
from textual.binding import Binding, BindingType
from textual.containers import Container, Horizontal, VerticalScroll
from textual.events import Key
from textual.message import Message
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.words import counted
from rl_tui.lessons.file.view import begun
from rl_tui.lessons.lesson import Lesson
from rl_tui.live.sessions.progress import (
    LessonEntries,
    LessonEntry,
    LessonProgress,
    LessonStart,
    lesson_entries,
    start_of,
)
from rl_tui.live.sessions.session import StoredSession
from rl_tui.runs.recipe import begin
from rl_tui.screen.catalogue.facts import faults_text, labelled, minutes_of_page
from rl_tui.screen.catalogue.scenario_list import Heading, ListRow, ListScreen, faulty_row
from rl_tui.screen.frame.message_line import complaining
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.bindings import RowList
from rl_tui.screen.terminal.key_queue import EarlyKeys
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.dialogs.dialog import Dialog

# Texts about a lesson


DONE: Final = "✓"


def state_of(entry: LessonEntry, progress: LessonProgress) -> str:
    """Describe the progress in a begun lesson."""
    if entry.is_at_end:
        done = progress.finished or progress.tasks_passed == progress.tasks
        passed = f"{progress.tasks_passed} of {counted(progress.tasks, 'task')}"
        return f"{DONE} finished" if done else f"at its end · {passed}"
    here = f"page {entry.lesson.number_of(progress.page) + 1} of {len(entry.lesson.pages)}"
    return f"{DONE} {here}" if progress.finished else here


def _lesson_details(entry: LessonEntry, following: str, look: Look) -> Group:
    lesson, palette = entry.lesson, look.palette
    lines = {"then": following} if following else {}
    rows = [(label, Text(look.glyphs.separated(line))) for label, line in (_lines(entry) | lines).items()]
    goals = [f"{goal[0].lower()}{goal[1:]}" for goal in lesson.goals]
    dash = Text(look.glyphs.spelled("–"))
    return Group(
        Text(look.glyphs.spelled(lesson.summary), palette.text),
        Text("\nYou will be able to", palette.strong),
        labelled([(dash, Text(look.glyphs.spelled(goal))) for goal in goals], look),
        Text(""),
        Text(_pages(entry, look), palette.text),
        labelled(rows, look),
    )


def mark_of(entry: LessonEntry, look: Look) -> str:
    """Return a symbol of the progress."""
    if entry.progress is None:
        return ""
    if entry.is_finished:
        return look.glyphs.spelled(DONE)
    return look.glyphs.progress[entry.is_at_end]


def _pages_done(entry: LessonEntry) -> int:
    if entry.progress is None:
        return 0
    return len(entry.lesson.pages) if entry.is_at_end else entry.lesson.number_of(entry.progress.page)


def _pages(entry: LessonEntry, look: Look) -> str:
    done, glyphs = _pages_done(entry), look.glyphs
    here = glyphs.progress[0] if entry.progress is not None and not entry.is_at_end else ""
    to_come = glyphs.untried * (len(entry.lesson.pages) - done - len(here))
    return f"{glyphs.spelled(DONE) * done}{here}{to_come}"


def _progress_line(found: LessonEntries) -> str:
    numbers = [str(number) for number, each in enumerate(found.entries, start=1) if each.lesson.is_core]
    core = f" · core course: {' '.join(numbers)}" if numbers else ""
    begun = [entry.progress for entry in found.entries if entry.progress is not None]
    if not begun:
        return f"Begin with the first: enter{core}"
    right = sum(progress.predictions_right for progress in begun)
    made = sum(progress.predictions_made for progress in begun)
    finished = f"{found.finished} of {len(found.entries)} finished"
    predictions = f" · {right} of {counted(made, 'prediction')} right" if made else ""
    return f"{finished}{predictions}{core}"


def _lines(entry: LessonEntry) -> dict[str, str]:
    lesson, progress = entry.lesson, entry.progress
    takes = f"about {lesson.minutes} min{' · core course' if lesson.is_core else ''}"
    if progress is None:
        return {
            "takes": takes,
            "pages": f"{len(lesson.pages)} · the next takes about {minutes_of_page(lesson)} min",
            "tasks": f"{len(lesson.tasks) or 'none'}",
        }
    made, tasks = progress.predictions_made, progress.tasks
    state = state_of(entry, progress)
    return {
        "takes": takes,
        "position": state if entry.is_at_end else f"{state}: {lesson.page(progress.page).title}",
        "tasks": f"{progress.tasks_passed} of {tasks} passed" if tasks else "none",
        "predictions": f"{progress.predictions_right} of {made} right" if made else "none so far",
    }


# The list of lessons


Entry = LessonEntry | ScenarioError


class LessonList(RowList):
    """A list of lessons."""

    def __init__(self, look: Look) -> None:
        super().__init__(id="lessons")
        self._look = look
        self._entries: Sequence[Entry] = ()

    def show(self, entries: Sequence[Entry], start_at: str) -> None:
        """List ``entries``, with the cursor on ``start_at``, else the first."""
        self._entries = entries
        self.clear_options()
        self.add_options(self._rows())
        ids = [each.lesson.id if isinstance(each, LessonEntry) else "" for each in entries]
        if entries:
            self.highlighted = ids.index(start_at) if start_at in ids else 0

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, if any."""
        return None if self.highlighted is None else self._entries[self.highlighted]

    @property
    def following(self) -> str:
        """Number and title of the next lesson."""
        after = len(self._entries) if self.highlighted is None else self.highlighted + 1
        titles = (each.lesson.title for each in self._entries[after:][:1] if isinstance(each, LessonEntry))
        return next((f"{after + 1} {title}" for title in titles), "")

    def _rows(self) -> Iterator[Option]:
        for number, entry in enumerate(self._entries, start=1):
            if isinstance(entry, LessonEntry):
                lesson, done = entry.lesson, _pages_done(entry)
                mark, pages = mark_of(entry, self._look), f"{done}/{len(lesson.pages)}"
                yield Option(ListRow(mark, f"{number} {lesson.title}", pages, self._look))
            else:
                yield Option(faulty_row(entry, self._look))


# The screen


_DRAWING: Final = "drawing"
_REST: Final = 0.15  # seconds on a row before its world is built
_NONE: Final = "No lessons found. They come with rl-tui: install it again."


def _world_of_page(lesson: Lesson, page: str) -> Snapshot:
    from rl_tui.lessons.file.setups import recipe_of
    from rl_tui.live.snapshot import PlaybackView
    from rl_tui.live.snapshot_builder import SnapshotBuilder

    recipe = recipe_of(lesson, lesson.setup_of(page))
    is_hidden = recipe.scenario.hides_answer
    return SnapshotBuilder().before(recipe, begin(recipe).world, PlaybackView(), is_hidden=is_hidden)


class LessonsScreen(ListScreen):
    """Lessons at the left, details at the right."""

    CSS_PATH = "lessons.tcss"
    BINDINGS: ClassVar[list[BindingType]] = bindings_of(actions_of(Place.LESSONS))
    place = Place.LESSONS

    @dataclass
    class LessonChosen(Message):
        """The user wants to open a lesson."""

        start: LessonStart | StoredSession

    @dataclass
    class ListClosed(Message):
        """The user goes back."""

    def __init__(
        self,
        look: Look,
        start_at: str = "",
        fault: UserError | None = None,
        sessions: Path | None = None,
        *,
        comes_from_lesson: bool = False,
    ) -> None:
        super().__init__(look, start_at, fault, sessions)
        self._comes_from_lesson = comes_from_lesson
        self._read = asyncio.Event()
        moves = {
            binding.key for binding in Binding.make_bindings([*OptionList.BINDINGS, *LessonList.BINDINGS])
        }
        self._early_keys = EarlyKeys(moves.union(*(action.keys for action in actions_of(Place.LESSONS))))

    def content(self) -> Iterable[Widget]:
        """Yield list and details."""
        yield self.first_row("Learn step by step")
        yield Static(id="progress", markup=False)
        details = VerticalScroll(
            Static(id="heading"), Static(id="about", markup=False), Container(id="preview"), id="details"
        )
        yield Horizontal(LessonList(self.look), details, id="columns")

    def on_mount(self) -> None:
        """Focus the list."""
        self.query_one(LessonList).focus()

    def begin(self) -> None:
        """Read the lessons."""
        Thread(target=self._read_lessons, name="read lessons", daemon=True).start()

    def _read_lessons(self) -> None:
        found = lesson_entries(self._sessions)  # in the thread: only scheduled calls leave it
        with suppress(RuntimeError):  # the program has ended meanwhile
            self.deliver(self._list_lessons, found)

    def _list_lessons(self, found: LessonEntries) -> None:
        self.query_one("#progress", Static).update(f" {self.look.glyphs.separated(_progress_line(found))}")
        self.query_one(LessonList).show([*found.entries, *found.broken], self._start_at or found.goes_on_at)
        self.show_current()
        self._read.set()
        self._early_keys.release(self.app)

    def on_key(self, event: Key) -> None:
        """Hold keys until the list exists."""
        if self._early_keys.take(event):
            event.stop()

    async def settled(self) -> None:
        """Wait for the list and one world."""
        await self._read.wait()
        await self.finished(_DRAWING)

    def show_current(self) -> None:
        """Show the lesson's details."""
        entry = self.query_one(LessonList).current
        self.query_one("#details").scroll_home(animate=False)
        title = ""
        text: RenderableType = Text(_NONE, self.look.palette.text)
        if isinstance(entry, LessonEntry):
            title = entry.lesson.title
            text = _lesson_details(entry, self.query_one(LessonList).following, self.look)
        elif isinstance(entry, ScenarioError):
            what = "This lesson cannot be taken until its file is fixed."
            title, text = "Errors", faults_text(what, entry.faults, self.look)
        self.query_one("#heading", Static).update(Heading(title, self.look))
        self.query_one("#about", Static).update(text)
        draw = partial(self._draw, entry)  # a function: of several in a row only the last one starts
        self.run_worker(draw, name="draw", exclusive=True, group=_DRAWING)  # type: ignore[arg-type]

    async def _draw(self, entry: Entry | None) -> None:
        drawing = self.query_one("#preview")
        drawing.remove_children()  # no await here: if cancelled, it would leave half behind
        if not isinstance(entry, LessonEntry):
            return
        await asyncio.sleep(0 if self.app.is_headless else _REST)  # a row merely passed builds nothing
        page = entry.lesson.pages[0].id if entry.progress is None else entry.progress.page
        with suppress(UserError):  # opening the lesson reports the reason
            picture = await asyncio.to_thread(_world_of_page, entry.lesson, page)
            from rl_tui.screen.panels.world_views import make_world_view

            view = make_world_view(picture.world, self.look)
            view.can_focus = False
            drawing.mount(view)
            view.show(picture)

    @on(OptionList.OptionSelected)
    def action_open_lesson(self) -> None:
        """Begin, resume or reopen the lesson."""
        entry = self._entry()
        if entry is not None:
            self.run_worker(self._open(entry), name="open the lesson", exclusive=True, group="open")

    async def _open(self, entry: LessonEntry) -> None:
        with complaining(self.app):
            start = await asyncio.to_thread(start_of, entry.lesson, entry.progress)  # may import Gymnasium
            self.post_message(self.LessonChosen(start))

    def action_begin_again(self) -> None:
        """Begin the lesson again after a confirmation."""
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
            f"Begin {entry.lesson.title} again, at its first page? Your earlier session "
            "stays on the start screen."
        )
        self.app.push_screen(Confirm("Begin again", question, "begin again", self.look.glyphs), begin)

    def action_leave_lessons(self) -> None:
        """Go back, after a lesson with a second press."""
        if self._comes_from_lesson:
            self._comes_from_lesson = False
            self.tell("Press esc again for the start screen.")
            return
        self.post_message(self.ListClosed())

    def _entry(self) -> LessonEntry | None:
        entry = self.query_one(LessonList).current
        if isinstance(entry, LessonEntry):
            return entry
        if entry is not None:
            self.tell("This file has errors. Fix them first.", severity="warning")
        return None

    def help_screen(self) -> Dialog[str]:
        """Return the help pages."""
        from rl_tui.screen.frame.help import HelpScreen

        return HelpScreen(self.look)
