"""The start screen."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import IntEnum
from functools import partial
from importlib import import_module
from itertools import count
from pathlib import Path
from queue import PriorityQueue
from threading import Thread
from typing import TYPE_CHECKING, ClassVar, Final

from textual import on
from textual.binding import BindingType
from textual.containers import Horizontal, Vertical
from textual.events import DescendantFocus
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Input, OptionList

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.streams import streams
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import SessionError, StoredSession
from rl_tui.runs.library import read_catalogue, recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.catalogue.details import Details, Entry
from rl_tui.screen.catalogue.doors import (
    GO_ON,
    LEARN,
    OWN_CODE,
    WATCH,
    Doors,
    go_on_door,
    learn_door,
    new_world_choice,
    own_code_door,
    own_code_page,
    scripts_here,
    watch_door,
)
from rl_tui.screen.catalogue.facts import Prose
from rl_tui.screen.catalogue.scenario_list import (
    MEANINGS,
    Filter,
    Hit,
    Mark,
    ScenarioList,
    has_words,
    marks_of,
)
from rl_tui.screen.catalogue.session_text import SavedSessions, SessionList
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.message_line import complaining
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.terminal.linked_app import is_open
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.live.sessions.progress import LessonEntries
    from rl_tui.screen.dialogs.dialog import Dialog

AT_LESSONS: Final = "/learn"
"""Where the cursor starts after the lessons. No scenario has this id."""
_SEED: Final = 0
_DETAILS: Final = "details"
_WIDE, _HIGH = 160, 50  # size from which the sessions are always listed
_NEEDED_TO_PLAY: Final = ("rl_tui.screen.playground.playground", "rl_tui.agents.learner")
_WORDS, _LESSONS, _SESSIONS = "Words", "Lessons", "Sessions"
_MOST_WORDS: Final = 5
_Turn = IntEnum("_Turn", ["END", "PICTURE", "WORLD", "OPTIMUM", "REST"])  # most urgent first


class CatalogueScreen(SavedSessions):
    """Doors above, scenarios or sessions at the left, details at the right.

    A thread reads lessons, builds worlds (Gymnasium last) and makes the runs of the picture.
    """

    CSS_PATH = "catalogue.tcss"
    BINDINGS: ClassVar[list[BindingType]] = bindings_of(actions_of(Place.CATALOGUE))
    place = Place.CATALOGUE

    @dataclass
    class Opened(Message):
        """The user wants to open a scenario."""

        recipe: Recipe
        watches: bool = False
        draws: bool = False

    @dataclass
    class LessonsWanted(Message):
        """The user wants the list of lessons."""

        start_at: str = ""

    def __init__(
        self,
        look: Look,
        start_at: str = "",
        fault: UserError | None = None,
        sessions: Path | None = None,
    ) -> None:
        super().__init__(look, start_at, fault, sessions)
        self._catalogue = read_catalogue()
        self._by_id = {scenario.id: scenario for scenario in self._catalogue.scenarios}
        self._scripts: Sequence[Path] = ()
        self._wanted: Scenario | None = None  # its run is made at the next pause
        self._worlds: dict[str, World | UserError] = {}
        self._jobs = PriorityQueue[tuple[_Turn, int, Callable[[], object] | None]]()
        self._numbers = count()  # keeps jobs of one kind in order
        self._all_built = asyncio.Event()
        self._lessons: LessonEntries | None = None
        self._lessons_read = asyncio.Event()
        self._in_sessions = False
        self._details = Details(look)

    def content(self) -> Iterable[Widget]:
        """Yield doors, lists and details."""
        yield self.first_row("An agent learns from rewards. See how.")
        unread = None if self.has_files else ()
        go_on = go_on_door(unread, datetime.now(UTC), in_kiosk=self.in_kiosk)
        doors = [learn_door(None), watch_door(), go_on]
        if not self.in_kiosk:
            doors.append(own_code_door(()))
        yield Doors(self.look, doors)
        yield Filter(self.look)
        lists = Vertical(ScenarioList(self.look, self._catalogue), SessionList(self.look), id="lists")
        yield Horizontal(lists, self._details, id="columns")

    def on_mount(self) -> None:
        """Put the cursor where the user was."""
        scenarios, doors = self.query_one(ScenarioList), self.query_one(Doors)
        scenarios.start_at(self._start_at)
        doors.current = LEARN if self._start_at == AT_LESSONS else GO_ON if self.has_files else WATCH
        if self._start_at in self._by_id:
            scenarios.focus()
        else:
            doors.focus()

    def on_resize(self) -> None:
        """Rearrange texts and lists."""
        self.query_one(Prose).set_class(self.has_class("-broad"), "-beside")
        self.set_class(self.size.width >= _WIDE and self.size.height >= _HIGH, "-wide")
        self.show_current()

    def begin(self) -> None:
        """Read sessions and lessons, and build worlds."""
        super().begin()
        Thread(target=self._work, name="read and build", daemon=True).start()

    def on_unmount(self) -> None:
        """End the thread."""
        self._put(_Turn.END, None)

    def _put(self, turn: _Turn, job: Callable[[], object] | None) -> None:
        self._jobs.put((turn, next(self._numbers), job))

    # In the thread: only calls scheduled on the screen leave it

    def _work(self) -> None:
        with suppress(RuntimeError):  # the program has ended meanwhile
            if not self.in_kiosk:
                self.deliver(self._show_scripts, scripts_here())
            self._read_lessons()
            scenarios = self._catalogue.scenarios
            for scenario in scenarios[:1]:
                self._build(scenario)
            try:
                for module in _NEEDED_TO_PLAY:
                    import_module(module)
            except ImportError as error:
                say = partial(self.notify, title="cannot load", severity="error", markup=False)
                self.deliver(say, str(error))
            for scenario in sorted(scenarios[1:], key=lambda each: each.kind == "gymnasium"):
                self._put(_Turn.WORLD, partial(self._build, scenario))
            while (job := self._jobs.get()[-1]) is not None:
                job()

    def _read_lessons(self) -> None:
        from rl_tui.live.sessions.progress import lesson_entries

        self.deliver(self._show_lessons, lesson_entries(self._sessions))

    def _build(self, scenario: Scenario) -> None:
        try:
            world: World | UserError = scenario.build(streams(_SEED).world)
        except UserError as error:
            world = error
        except ImportError as error:
            world = UserError(f"{error}")
        self.deliver(self._take_world, scenario, world)

    def _make_moments(self, scenario: Scenario, world: World) -> None:
        from rl_tui.screen.catalogue.preview import moments_of

        if self._wanted is scenario:  # else the cursor has moved on
            self.deliver(self._details.take_moments, scenario, moments_of(scenario, world))

    def _repeat_last_run(self, session: StoredSession) -> None:
        from rl_tui.screen.catalogue.preview import last_run

        self.deliver(self._details.take_last_run, session, last_run(session))

    def _find_optima(self, marks: Mapping[str, Mark], sessions: Sequence[StoredSession]) -> None:
        if not sessions:
            self.deliver(self._show_marks, marks)
            return
        from rl_tui.screen.catalogue.preview import has_found_optimum

        scenario = self._by_id.get(sessions[0].document.scenario.id)
        if scenario and marks[scenario.id] < Mark.OPTIMAL and has_found_optimum(sessions[0], scenario):
            marks = {**marks, scenario.id: Mark.OPTIMAL}
        self._put(_Turn.OPTIMUM, partial(self._find_optima, marks, sessions[1:]))

    # Results of the thread

    def _show_lessons(self, found: LessonEntries) -> None:
        self._lessons = found
        self._lessons_read.set()
        self.query_one(Doors).show(LEARN, learn_door(found))
        self.show_current()

    def _take_world(self, scenario: Scenario, world: World | UserError) -> None:
        self._worlds[scenario.id] = world
        if len(self._worlds) == len(self._catalogue.scenarios):
            self._all_built.set()
        if scenario is self._current:
            self.show_current()

    def on_details_moments_wanted(self, event: Details.MomentsWanted) -> None:
        """Queue the run of a scenario."""
        self._wanted = event.scenario
        self._put(_Turn.PICTURE, partial(self._make_moments, event.scenario, event.world))

    def on_details_last_run_wanted(self, event: Details.LastRunWanted) -> None:
        """Queue the repetition of a session's run."""
        self._put(_Turn.PICTURE, partial(self._repeat_last_run, event.session))

    def _show_marks(self, marks: Mapping[str, Mark]) -> None:
        self.query_one(ScenarioList).show_marks(marks)

    def _show_scripts(self, scripts: Sequence[Path]) -> None:
        self._scripts = scripts
        self.query_one(Doors).show(OWN_CODE, own_code_door(scripts))

    def show_sessions(self, sessions: Sequence[StoredSession]) -> None:
        """Mark opened worlds, and update the door."""
        self.query_one("#lists").set_class(bool(self.query_one(SessionList).entries), "-kept")
        doors = self.query_one(Doors)
        doors.show(GO_ON, go_on_door(sessions, datetime.now(UTC), in_kiosk=self.in_kiosk))
        if not sessions and doors.current == GO_ON:
            doors.current = WATCH
        self._show_marks(marks := marks_of(sessions))
        own = [each for each in sessions if each.document.lesson is None]
        self._put(_Turn.OPTIMUM, partial(self._find_optima, marks, own))

    async def settled(self) -> None:
        """Wait until everything is built, and the picture shows its last moment."""
        await self._all_built.wait()
        await self._lessons_read.wait()
        await self.sessions_read()
        await self.finished(_DETAILS)
        self._details.ask_for_moments()
        for _ in range(2):  # a request of the details is queued only after a message was handled
            done = asyncio.Event()
            self._put(_Turn.REST, partial(self.call_later, done.set))
            await done.wait()
        await self.finished(_DETAILS)

    # The cursor

    @property
    def _current(self) -> Entry | None:
        if self._in_sessions:
            return self.query_one(SessionList).current
        entry = self.query_one(ScenarioList).current
        if isinstance(entry, Hit) and entry.group == _SESSIONS:
            sessions = self.query_one(SessionList).sound
            return next((each for each in sessions if str(each.path) == entry.id), None)
        return entry

    @property
    def focus_chain(self) -> list[Widget]:
        """The tab order, or only the filter."""
        if self.query_one(Filter).display:
            return [self.query_one(Filter).line]
        order: list[Widget] = [self.query_one(Doors), self.query_one(ScenarioList)]
        sessions = self.query_one(SessionList)
        if sessions.entries:
            order.append(sessions)
        if self._details.max_scroll_y:
            order.insert(order.index(sessions) + 1 if self._in_sessions else 2, self._details)
        return order

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Show the list in focus, and details."""
        self.set_class(isinstance(event.widget, Doors), "-in-doors")
        to_sessions = isinstance(event.widget, SessionList)
        if to_sessions is not self._in_sessions and not isinstance(event.widget, Details):
            self._in_sessions = to_sessions
            self.query_one("#lists").set_class(to_sessions, "-sessions")
            self.show_current()

    def show_current(self) -> None:
        """Show the row's details."""
        # A function, not a coroutine: of several in a row only the last one starts
        self.run_worker(self._show, exclusive=True, group=_DETAILS)  # type: ignore[arg-type]

    async def _show(self) -> None:
        if not is_open(self):
            return
        entry = self._current
        id_ = entry.id if isinstance(entry, Scenario) else ""
        sessions = [each for each in self.query_one(SessionList).sound if each.document.scenario.id == id_]
        own = [each for each in sessions if each.document.lesson is None]
        lessons = [] if self._lessons is None else [each.lesson for each in self._lessons.entries]
        here = [each.title for each in lessons if any(of.scenario == id_ for of in each.setups.values())]
        self._details.show(entry, self._worlds.get(id_), here, own)

    # The filter

    def action_filter(self) -> None:
        """Open the filter of the list."""
        self.query_one(Doors).display = False
        self.query_one(KeyLine).hints = (("↑ ↓", "choose"), ("enter", "open"), ("esc", "all of them"))
        self.query_one(Filter).open()
        self._show_filtered(self.query_one(Filter).line.value)

    def action_show_all(self) -> None:
        """Close the filter and show all rows."""
        self.query_one(Filter).close()
        self.query_one(KeyLine).hints = ()
        self.query_one(Doors).display = True
        self.query_one(ScenarioList).show()
        self.query_one(ScenarioList).focus()

    def on_input_changed(self, event: Input.Changed) -> None:
        """List the matches."""
        if self.query_one(Filter).display:
            self._show_filtered(event.value)

    def _show_filtered(self, words: str) -> None:
        hits = self._hits(words) if words.strip() else []
        worlds = self.query_one(ScenarioList).show(words.strip(), hits)
        found = [f"{worlds} of {counted(len(self._by_id), 'world')}"]
        for group, singular in ((_SESSIONS, "session"), (_LESSONS, "lesson"), (_WORDS, "word")):
            if number := sum(hit.group == group for hit in hits):
                found.append(counted(number, singular))
        self.query_one(Filter).tell(" · ".join(found))
        self.show_current()  # an empty list has no cursor to report

    def _hits(self, words: str) -> list[Hit]:
        from rl_tui.screen.glossary.glossary import glossary, search

        entries = [] if self._lessons is None else self._lessons.entries
        lessons = [each.lesson for each in entries if has_words(each.lesson.title, words)]
        terms = [glossary()[id_] for id_ in search(words)]
        named = [each for each in terms if has_words(" ".join(each.names), words)]
        sessions = [each for each in self.query_one(SessionList).sound if has_words(each.title, words)]
        return [
            *(Hit(_SESSIONS, str(each.path), each.title) for each in sessions),
            *(Hit(_LESSONS, each.id, each.title) for each in lessons),
            *(Hit(_WORDS, each.id, each.word) for each in named[:_MOST_WORDS]),
        ]

    # Verbs

    def action_door(self, number: int) -> None:
        """Open the door of that number."""
        if number == LEARN:
            self.post_message(self.LessonsWanted())
        elif number == WATCH:
            self._open(self._catalogue.scenarios[0], watches=True)
        elif number == OWN_CODE and self.in_kiosk:
            self.tell("Not here: a kiosk opens no files.")
        elif number == OWN_CODE:

            def say(command: str | None) -> None:
                if command is not None:
                    self.tell(f"In a shell: {command}", timeout=15)

            self.app.push_screen(own_code_page(self._scripts, self.look.glyphs), say)
        elif sessions := self.query_one(SessionList).sound:
            self.resume(sessions[0])
        else:
            self.tell("Nothing to continue yet. 2 watches an agent learn.")

    @on(OptionList.OptionSelected)
    @on(Input.Submitted)
    def action_open(self) -> None:
        """Open the focused door, else the row."""
        doors, entry = self.query_one(Doors), self._current
        if doors.has_focus:
            self.action_door(doors.current)
        elif isinstance(entry, StoredSession):
            self.resume(entry)
        elif isinstance(entry, SessionError):
            self.notify("This file cannot be resumed.", severity="warning")
        elif isinstance(entry, ScenarioError):
            self.notify("This file has errors. Fix them first.", severity="warning")
        elif isinstance(entry, Scenario):
            self._open(entry)
        elif isinstance(entry, Hit) and entry.group == _WORDS:
            self.pages.show_words((entry.id,))
        elif isinstance(entry, Hit):
            self.post_message(self.LessonsWanted(entry.id))

    def _open(self, scenario: Scenario, *, watches: bool = False) -> None:
        with complaining(self.app):
            self.post_message(self.Opened(recipe_for(scenario, {}, _SEED), watches))

    def action_new_world(self) -> None:
        """Ask for a kind of world, then edit it."""
        if self.in_kiosk:
            self.tell("Not here: a kiosk writes no files.")
            return

        def begin(kind: str | None) -> None:
            from rl_tui.runs.export.scenario_file import new_world

            if kind is not None:
                self.post_message(self.Opened(recipe_for(new_world(kind), {}, _SEED), draws=True))

        self.app.push_screen(new_world_choice(self.look.glyphs), begin)

    def action_delete_session(self) -> None:
        """Delete the session after a confirmation."""
        entry = self._current
        if self.in_kiosk:
            self.tell("Not here: a kiosk keeps no sessions.")
        elif isinstance(entry, StoredSession):
            self.ask_to_delete(entry)
        elif isinstance(entry, SessionError):
            self.notify("Not here: the file has errors. Remove it yourself.")
        else:
            self.notify("Only sessions can be deleted.")

    def help_screen(self) -> Dialog[str]:
        """Return the help pages, with scenario notes."""
        from rl_tui.screen.frame.help import HelpScreen

        entry = self._current
        marks = zip(self.look.glyphs.progress, MEANINGS, strict=True)
        topic = ("Marks", f"Before a world: {', '.join(f'{mark} {meaning}' for mark, meaning in marks)}.")
        notes = entry.notes if isinstance(entry, Scenario) else ""
        return HelpScreen(self.look, notes=notes, topics=(topic,))
