"""The start screen: scenarios, lessons and recent sessions, with details of the current row."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, ClassVar

from rich.console import RenderableType
from textual.binding import BindingType
from textual.containers import Container, Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.events import DescendantFocus
from textual.message import Message
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.worker import WorkerCancelled

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.streams import streams
from rl_tui.live.sessions.session import SessionError, StoredSession, files_in, remove, sessions_in
from rl_tui.runs.library import read_catalogue, recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.catalogue.facts import (
    LEARN,
    WATCH,
    Course,
    Demonstration,
    ScenarioList,
    about,
    about_learning,
    about_watching,
    facts,
    faults_text,
    keys_while_watching,
)
from rl_tui.screen.catalogue.session_text import SessionList, session_facts
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.frame.action_screen import ActionScreen
from rl_tui.screen.frame.notes import Notes
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.live.record import Record
    from rl_tui.live.sessions.progress import LessonEntries
    from rl_tui.screen.dialogs.dialog import Dialog


_SEED = 0
_DETAILS = "details"
_GREETING = "New here? Begin with the first row: enter."
_NEEDED_TO_PLAY = ("rl_tui.screen.playground.playground", "rl_tui.agents.learner")


Entry = Course | Demonstration | Scenario | ScenarioError | StoredSession | SessionError


class CatalogueScreen(ActionScreen):
    """Left the scenarios and the sessions, right what is known of the one under the cursor.

    Sessions and lessons are read in threads after the first paint, and worlds built: that of the row that is
    watched, and then, once all that is needed to play it is there, the others, those of Gymnasium last.
    ``sessions`` is the folder of sessions, None where none are kept.
    """

    CSS_PATH = "catalogue.tcss"
    BINDINGS: ClassVar[list[BindingType]] = bindings_of(actions_of(Place.CATALOGUE))
    place = Place.CATALOGUE

    @dataclass
    class Opened(Message):
        """The user wants to play, or to watch it learn by itself."""

        recipe: Recipe
        watches: bool = False

    @dataclass
    class Resumed(Message):
        """The user wants to go on with a session; ``record`` is what it says."""

        session: StoredSession
        record: Record

    @dataclass
    class SessionsRead(Message):
        """The files of the sessions are read."""

        entries: list[StoredSession | SessionError]

    @dataclass
    class LessonsWanted(Message):
        """The user wants the list of lessons."""

    @dataclass
    class LessonsRead(Message):
        """The files of the lessons are read."""

        found: LessonEntries

    @dataclass
    class WorldBuilt(Message):
        """A world is ready, or could not be built."""

        scenario: Scenario
        world: World | UserError

    @dataclass
    class NotImported(Message):
        """What the playground needs cannot be imported."""

        reason: str

    def __init__(
        self, look: Look, start_at: str = "", fault: UserError | None = None, sessions: Path | None = None
    ) -> None:
        super().__init__(look)
        self._sessions = sessions
        self._sessions_read = asyncio.Event()
        self._catalogue = read_catalogue()
        self._start_at = start_at
        self._fault = fault
        self._worlds: dict[str, World | UserError] = {}
        self._shown: Entry | None = None
        self._all_built = asyncio.Event()
        self._lessons: LessonEntries | None = None
        self._lessons_read = asyncio.Event()
        self._in_sessions = False

    def content(self) -> Iterable[Widget]:
        """Yield the list and the details."""
        title = " rl-tui · an agent learns from rewards, step by step"
        yield Static(separated(f"{title} · kiosk" if self.in_kiosk else title, self.look.glyphs), id="title")
        yield Static(f" {_GREETING}", id="greeting")
        details = VerticalScroll(
            Static(id="about", markup=False),
            Container(id="preview"),
            Static(id="facts", markup=False),
            Notes(self.look.glyphs, id="notes"),
            id="details",
            classes="panel",
        )
        details.border_subtitle = "tab, arrows: scroll"
        scenarios = ScenarioList(self.look, self._catalogue)
        sessions = SessionList(self.look, 0 if self._sessions is None else len(files_in(self._sessions)))
        lists = Vertical(scenarios, sessions, id="lists")
        yield Horizontal(lists, details, id="columns")

    def on_mount(self) -> None:
        """Put the cursor where the user came from, and begin what is slow once the first paint is done."""
        scenarios = self.query_one(ScenarioList)
        scenarios.start_at(self._start_at)
        scenarios.focus()
        if self._fault is not None:
            self.notify(str(self._fault), severity="error", timeout=15, markup=False)
        self.run_worker(self._begin_when_painted, name="begin", group="begin")  # type: ignore[arg-type]

    async def _begin_when_painted(self) -> None:
        if isinstance(self.app, LinkedApp):
            await self.app.painted()
        self._read_sessions()
        Thread(target=self._read_and_build, name="read and build", daemon=True).start()

    def _read_sessions(self) -> None:
        if self._sessions is None:
            self._sessions_read.set()
            return
        self._sessions_read.clear()
        Thread(target=self._list_sessions, args=(self._sessions,), name="read sessions", daemon=True).start()

    # In the threads: only messages leave them

    def _list_sessions(self, folder: Path) -> None:
        sound, broken = sessions_in(folder)
        with suppress(RuntimeError):  # the program has ended meanwhile
            self.post_message(self.SessionsRead([*sound, *broken]))

    def _read_and_build(self) -> None:
        with suppress(RuntimeError):  # the program has ended meanwhile
            self._read_lessons()
            scenarios = self._catalogue.scenarios
            for scenario in scenarios[:1]:
                self._build(scenario)
            self._import_what_is_needed_to_play()
            for scenario in sorted(scenarios[1:], key=lambda each: each.kind == "gymnasium"):
                self._build(scenario)

    def _read_lessons(self) -> None:
        from rl_tui.live.sessions.progress import lesson_entries

        self.post_message(self.LessonsRead(lesson_entries(self._sessions)))

    def _build(self, scenario: Scenario) -> None:
        try:
            world: World | UserError = scenario.build(streams(_SEED).world)
        except UserError as error:
            world = error
        except ImportError as error:
            world = UserError(f"{error}")
        self.post_message(self.WorldBuilt(scenario, world))

    def _import_what_is_needed_to_play(self) -> None:
        try:
            for module in _NEEDED_TO_PLAY:
                import_module(module)
        except ImportError as error:
            self.post_message(self.NotImported(str(error)))

    def on_catalogue_screen_sessions_read(self, event: SessionsRead) -> None:
        """List the sessions."""
        sessions = self.query_one(SessionList)
        had_focus = sessions.has_focus
        sessions.show(event.entries, datetime.now(UTC))
        if had_focus and not event.entries:
            self.query_one("#scenarios").focus()
        self._sessions_read.set()
        if had_focus:
            self.show_current()

    def on_catalogue_screen_lessons_read(self, event: LessonsRead) -> None:
        """Say how far one has come."""
        self._lessons = event.found
        self._lessons_read.set()
        self.query_one(ScenarioList).show_finished(event.found.finished, len(event.found.entries))
        if isinstance(self._current, Course):
            self.show_current()

    def on_catalogue_screen_world_built(self, event: WorldBuilt) -> None:
        """Fill in what was missing."""
        self._worlds[event.scenario.id] = event.world
        if len(self._worlds) == len(self._catalogue.scenarios):
            self._all_built.set()
        entry = self._current
        if event.scenario is (entry.scenario if isinstance(entry, Demonstration) else entry):
            self.show_current()

    def on_catalogue_screen_not_imported(self, event: NotImported) -> None:
        """Show why the scenario cannot be opened."""
        self.notify(event.reason, title="cannot load", severity="error", timeout=30, markup=False)

    async def sessions_read(self) -> None:
        """Wait until the files of the sessions are read and listed."""
        await self._sessions_read.wait()

    async def settled(self) -> None:
        """Wait until every world is built, lessons and sessions are read and the details are drawn."""
        await self._all_built.wait()
        await self._lessons_read.wait()
        await self.sessions_read()
        while under_way := [each for each in self.workers if each.group == _DETAILS and not each.is_finished]:
            with suppress(WorkerCancelled):
                await self.workers.wait_for_complete(under_way)

    # The cursor

    @property
    def _current(self) -> Entry | None:
        if self._in_sessions:
            return self.query_one(SessionList).current
        return self.query_one(ScenarioList).current

    @property
    def focus_chain(self) -> list[Widget]:
        """The order of the tab key: after each list the details, which are of what is under its cursor."""
        lists: list[Widget] = [self.query_one(ScenarioList), self.query_one(SessionList)]
        at = 2 if self._in_sessions else 1
        order = [*lists[:at], self.query_one(f"#{_DETAILS}"), *lists[at:]]
        chain = super().focus_chain
        return [widget for widget in order if widget in chain]

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Follow the focus from one list to the other; the details belong to the one it was last in."""
        to_sessions = isinstance(event.widget, SessionList)
        if isinstance(event.widget, OptionList) and to_sessions is not self._in_sessions:
            self._in_sessions = to_sessions
            self.show_current()

    def on_option_list_option_highlighted(self) -> None:
        """Show the details of the entry under the cursor."""
        self.show_current()

    def on_option_list_option_selected(self) -> None:
        """Open the entry."""
        self.action_open()

    def show_current(self) -> None:
        """Show the details of the entry under the cursor."""
        # not the coroutine itself: of several in a row only the last one begins
        self.run_worker(self._show, exclusive=True, group=_DETAILS)  # type: ignore[arg-type]

    async def _show(self) -> None:
        entry, details = self._current, self.query_one("#details")
        if entry is not self._shown:
            self._shown = entry
            details.scroll_home(animate=False)
            self._hide_picture_and_notes()
        if isinstance(entry, Demonstration):
            self._show_text(WATCH, keys_while_watching(self.look), about_watching(self.look))
            await self._draw(entry.scenario)
            await self._show_notes("")
            return
        if isinstance(entry, Scenario):
            world = self._worlds.get(entry.id)
            self._show_text(entry.title, facts(entry, world, self.look), about(entry, self.look))
            await self._draw(entry)
            # they wait for the world: to say how large it is may take more lines than that it is loading
            await self._show_notes("" if world is None else entry.notes)
            return
        if isinstance(entry, Course):
            self._show_text(LEARN, about_learning(self._lessons, self.look))
        elif isinstance(entry, ScenarioError):
            head = "This file cannot be played until it is mended."
            self._show_text("Faults", faults_text(head, entry.faults, self.look))
        elif isinstance(entry, SessionError):
            head = "This file cannot be resumed. It is left as it is."
            self._show_text("Faults", faults_text(head, [entry], self.look))
        elif entry is not None:
            self._show_text(f"Session: {entry.title}", session_facts(entry, datetime.now(UTC), self.look))
        drawing = self.query_one("#preview")
        drawing.display = False
        await drawing.remove_children()
        await self._show_notes("")

    def _hide_picture_and_notes(self) -> None:
        """Hide what belongs to the entry before, in the frame in which the title changes."""
        for picture in self.query_one("#preview").children:
            picture.display = False
        self.query_one(Notes).hide()

    async def _show_notes(self, text: str) -> None:
        for notes in self.query(Notes):  # none where the screen was left meanwhile
            await notes.show(text)

    def _show_text(self, title: str, text: RenderableType, above: RenderableType | None = None) -> None:
        """Show ``text`` below the drawing, and ``above`` it what it is about, if it has a drawing."""
        self.query_one("#details").border_title = Content(to_ascii(title, self.look.glyphs))
        self.query_one("#facts", Static).update(text)
        top = self.query_one("#about", Static)
        top.display = above is not None
        top.update(above or "")

    async def _draw(self, scenario: Scenario) -> None:
        world, drawing = self._worlds.get(scenario.id), self.query_one("#preview")
        drawing.display = not isinstance(world, UserError)
        await drawing.remove_children()
        if not drawing.is_attached:
            return  # the app ended meanwhile
        if isinstance(world, World):
            from rl_tui.live.snapshot import PlaybackView
            from rl_tui.live.snapshot_builder import SnapshotBuilder
            from rl_tui.screen.panels.world_views import make_world_view

            view = make_world_view(world, self.look)
            view.can_focus = False
            await drawing.mount(view)
            recipe = recipe_for(scenario, {}, _SEED)
            is_hidden = scenario.hides_answer
            view.show(SnapshotBuilder().before(recipe, world, PlaybackView(), is_hidden=is_hidden))
        elif world is None:
            await drawing.mount(Static(f"preparing {self.look.glyphs.ellipsis}", classes="hint"))

    # Verbs

    def action_open(self) -> None:
        """Play the scenario under the cursor, go on with the session, or go to the lessons."""
        entry = self._current
        if isinstance(entry, Course):
            self.post_message(self.LessonsWanted())
        elif isinstance(entry, StoredSession):
            self.run_worker(self._resume(entry), name="resume the session", exclusive=True, group="resume")
        elif isinstance(entry, SessionError):
            self.notify("this file cannot be resumed", severity="warning")
        elif isinstance(entry, ScenarioError):
            self.notify("this file has faults; mend them first", severity="warning")
        elif entry is not None:
            watches = isinstance(entry, Demonstration)
            scenario = entry.scenario if isinstance(entry, Demonstration) else entry
            try:
                self.post_message(self.Opened(recipe_for(scenario, {}, _SEED), watches))
            except UserError as fault:
                self.notify(str(fault), severity="error", markup=False)

    async def _resume(self, session: StoredSession) -> None:
        try:
            record = await asyncio.to_thread(session.record)  # may import Gymnasium
        except UserError as fault:
            self.notify(str(fault), severity="error", timeout=15, markup=False)
        else:
            self.post_message(self.Resumed(session, record))

    def action_delete_session(self) -> None:
        """Delete the session under the cursor, once that is confirmed."""
        entry = self._current
        if self.in_kiosk:
            self.tell("no sessions are kept here: this is a kiosk")
            return
        if not isinstance(entry, StoredSession):
            is_faulty = isinstance(entry, SessionError)
            faulty = "a faulty file is left alone; remove it yourself"
            self.notify(faulty if is_faulty else "only sessions can be deleted")
            return
        from rl_tui.screen.dialogs.dialog import Confirm

        def delete(answer: bool | None) -> None:
            if not answer:
                return
            try:
                remove(entry)
            except UserError as fault:
                self.notify(str(fault), severity="error", markup=False)
            self._read_sessions()

        question = f"Delete the session {entry.title}, at step {entry.step:,}? It cannot be brought back."
        self.app.push_screen(Confirm("Delete", question, "delete", self.look.glyphs), delete)

    def help_screen(self) -> Dialog[str]:
        """Return the help, from its first line on or from the keys on."""
        from rl_tui.screen.frame.help import HelpScreen

        entry = self._current
        notes = entry.notes if isinstance(entry, Scenario) else ""
        return HelpScreen(self.look, notes=notes)
