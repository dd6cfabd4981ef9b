"""The app, which switches between screens."""

from __future__ import annotations

import asyncio
import os
import sys
import time
from collections.abc import Callable
from functools import partial
from inspect import isawaitable
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from rich.console import RenderableType
from textual.app import ScreenStackError
from textual.binding import BindingType
from textual.css.query import NoMatches
from textual.dom import NoScreen
from textual.driver import Driver
from textual.events import Event, InputEvent, Key, MouseDown, Paste
from textual.notifications import Notify
from textual.theme import Theme
from textual.widget import MountError
from textual.worker import WorkerFailed

from rl_tui.common.errors import UserError
from rl_tui.common.findings import command_line, one_line
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.opening import DrawingStart, Opener, Start, beginning_of
from rl_tui.screen.frame.action_screen import ActionScreen
from rl_tui.screen.frame.message_line import Messages, complaining
from rl_tui.screen.keys.bindings import bindings_everywhere, stopping_keys
from rl_tui.screen.terminal.driver_choice import driver_class
from rl_tui.screen.terminal.ending import HUNG_UP, end_on_signal
from rl_tui.screen.terminal.key_queue import KeyQueue, TypeFirst
from rl_tui.screen.terminal.linked_app import LinkedApp, forget_left_screens
from rl_tui.screen.theme.glyphs import ASCII, encoding_of
from rl_tui.screen.theme.look import Depth, Look, choose_look, depth_of, environment_for, is_native
from rl_tui.screen.theme.themes import PICTURE_DARK, PICTURE_LIGHT, themes_for, use_plain_scroll_bars
from rl_tui.worlds.files.catalogue import scenarios
from rl_tui.worlds.files.scenario import Scenario

if TYPE_CHECKING:
    from rl_tui.lessons.file.view import LessonRecord
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.live.player import Player
    from rl_tui.live.record import Record
    from rl_tui.live.sessions.autosave import Autosave, KeptSession
    from rl_tui.live.sessions.session import StoredSession
    from rl_tui.screen.app.find import Findable
    from rl_tui.screen.catalogue.catalogue import CatalogueScreen
    from rl_tui.screen.catalogue.lessons import LessonsScreen
    from rl_tui.screen.playground.actions.next_lesson import LessonWanted
    from rl_tui.screen.playground.playground import Playground


# Time without input


PATIENCE: Final = 600.0
"""Seconds without input until a kiosk pauses."""
LOOKS: Final = 10.0
"""Seconds between two looks at the clock."""


class Idleness:
    """A measure of the time without input. ``clock`` returns seconds."""

    def __init__(self, patience: float = PATIENCE, clock: Callable[[], float] = time.monotonic) -> None:
        self._patience = patience
        self._clock = clock
        self._last = clock()
        self._has_begun = False

    def stir(self) -> None:
        """Note an input."""
        self._last = self._clock()
        self._has_begun = False

    def begins(self) -> bool:
        """Return True once after each ``patience`` seconds without input."""
        begins = not self._has_begun and self._clock() - self._last >= self._patience
        self._has_begun = self._has_begun or begins
        return begins


# The app


_LONGEST_ADDRESS = 300
_OWN_THEMES: Final = ("dark", "light")
# Errors from finding or mounting widgets of a screen that has gone
_GONE = (NoMatches, MountError, NoScreen, ScreenStackError)


class RlTuiApp(LinkedApp[UserError]):
    """The start screen, and everything it opens.

    ``picture`` draws without asking a terminal. ``sessions``: a folder, None to save none. A ``kiosk`` offers
    nothing about files. The result of the app is the error that ended it, or None.

    Raises:
        UserError: The theme is unknown.
    """

    TITLE = "rl-tui"
    CSS_PATH = "app.tcss"
    NOTIFICATION_TIMEOUT: ClassVar[float] = 3
    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar[list[BindingType]] = bindings_everywhere()

    def __init__(
        self,
        display: Display | None = None,
        start: Start = None,
        make_player: Callable[..., Player] | None = None,
        *,
        picture: bool = False,
        sessions: Path | None = None,
        kiosk: bool = False,
    ) -> None:
        options = display or Display()
        depth = "truecolor" if picture and options.colors == "auto" else depth_of(options.colors, os.environ)
        with environment_for(depth):
            super().__init__(driver_class(), ansi_color=is_native(depth) and not picture)
        if picture:
            self.ansi_theme_dark, self.ansi_theme_light = PICTURE_DARK, PICTURE_LIGHT
        for theme in themes_for(depth, picture=picture):
            self.register_theme(theme)
        if options.theme not in self.available_themes:
            known = ", ".join(sorted(self.available_themes))
            raise UserError(f"theme {options.theme!r} is not known; choose one of {known}")
        self.theme = options.theme
        self.options = options
        self.ticks = 0.0 if picture else options.ticks
        self._depth: Depth = depth
        ours = getattr(sys.stdout, "encoding", None)  # stdout is None if it is closed
        named = encoding_of(os.environ, ours, utf8_mode=bool(sys.flags.utf8_mode))
        self._encoding = "utf-8" if picture else named
        self._start = start
        self._opener = Opener(lambda: self.look, make_player, options, sessions, kiosk)
        self._kiosk = kiosk
        self._idleness = Idleness()
        self.bug: Exception | None = None
        """The unexpected error that ended the program, or None."""
        self.messages = Messages(self, lambda: self.look)
        """The messages on screen."""
        self.stops = stopping_keys()
        self._key_queue = KeyQueue(self, self._type, tell_of_loss=self._tell_of_lost_keys, stops=self.stops)
        has_ascii_only = self.look.glyphs is ASCII
        self.set_class(has_ascii_only, "-ascii")
        use_plain_scroll_bars()

    @property
    def look(self) -> Look:
        """The current characters and colours."""
        return choose_look(
            self._depth, self.options.ascii, self.current_theme.dark, os.environ, self._encoding
        )

    @property
    def kept(self) -> KeptSession | None:
        """The last session on disk, if any."""
        return self._opener.kept

    def _build_driver(
        self, headless: bool, inline: bool, mouse: bool, size: tuple[int, int] | None
    ) -> Driver:
        driver = super()._build_driver(headless, inline, mouse, size)
        if not driver.is_headless:
            # before the terminal is taken, so that it is always given back
            end_on_signal(self._end, self.give_back_terminal)
        return driver

    @property
    def _is_ending(self) -> bool:
        """True if the app is ending. Other versions of Textual may not know."""
        return getattr(self, "_exit", False)

    async def on_event(self, event: Event) -> None:
        """Queue keys, and handle everything else at once."""
        if isinstance(event, InputEvent):
            if self._is_ending:
                return  # the end does not wait for earlier keys
            self._idleness.stir()
            await asyncio.sleep(0)  # lets other events in, even an end, during a flood of input
        if isinstance(event, (Key, Paste)) and not event.is_forwarded:
            await self._key_queue.take(event)
        else:
            if isinstance(event, MouseDown) and not event.is_forwarded:
                self.messages.end_moment()
            await super().on_event(event)

    async def _type(self, event: Event) -> None:
        self.messages.end_moment()
        if isinstance(event, Key) and event.key == "escape" and self.messages.end_fault():
            return
        await super().on_event(event)

    def on_type_first(self, message: TypeFirst) -> None:
        """Put early keys before all that wait."""
        if not self._is_ending:
            self._key_queue.take_first(message.keys)

    def on_notify(self, event: Notify) -> None:
        """Show a notification in the message line."""
        event.prevent_default()  # Textual would draw it over the screen
        event.notification.message = self.look.glyphs.spelled(event.notification.message)
        self.messages.note(event.notification)

    def clear_notifications(self) -> None:
        """Remove all messages except errors."""
        self.messages.clear()

    def _tell_of_lost_keys(self) -> None:
        self.notify("Too many keys at once. The rest were ignored.", severity="warning")

    async def typed(self) -> None:
        """Wait until all keys are handled and their screens are ready."""
        await self._key_queue.rest()

    def on_mount(self) -> None:
        """Open the first screen."""
        self.theme_changed_signal.subscribe(self, self._follow_theme)
        self.screen_change_signal.subscribe(self, forget_left_screens)
        self.screen_change_signal.subscribe(self, self.messages.follow)
        if not self.is_headless:
            # again: the driver for browsers has installed its own handlers
            end_on_signal(self._end, self.give_back_terminal)
        if self._kiosk:
            self.set_interval(LOOKS, self._pause_when_idle)
        self.push_screen(self._opener.first_screen(self._start))

    def _go_to(self, screen: ActionScreen) -> None:
        self._start = None  # later errors lead back to the start screen
        self.switch_screen(screen)

    def on_catalogue_screen_opened(self, event: CatalogueScreen.Opened) -> None:
        """Go to the playground."""
        if event.draws:
            self._go_to(self._opener.first_screen(DrawingStart(event.recipe)))
        else:
            is_new = self._opener.has_kept_nothing
            self._go_to(self._opener.playground(event.recipe, watches=event.watches, is_gradual=is_new))

    def on_saved_sessions_resumed(self, event: CatalogueScreen.Resumed) -> None:
        """Go on with a session."""
        self._go_to(self._opener.resumed(event.session, event.record))

    def on_catalogue_screen_lessons_wanted(self, event: CatalogueScreen.LessonsWanted) -> None:
        """Go to the list of lessons."""
        self._go_to(self._opener.lessons(event.start_at))

    def on_lessons_screen_list_closed(self) -> None:
        """Go back to the start screen."""
        from rl_tui.screen.catalogue.catalogue import AT_LESSONS

        self._go_to(self._opener.catalogue(AT_LESSONS))

    def on_lessons_screen_lesson_chosen(self, event: LessonsScreen.LessonChosen) -> None:
        """Go to a lesson's playground."""
        with complaining(self):
            self._go_to(self._opener.first_screen(event.start))

    async def on_playground_setup_wanted(self, event: Playground.SetupWanted) -> None:
        """Go to another lesson page's setup."""
        with complaining(self):
            record = await asyncio.to_thread(_built, event.record)
            self._go_to(self._opener.other_setup(record))

    async def on_lesson_wanted(self, event: LessonWanted) -> None:
        """Go to another lesson."""
        from rl_tui.live.sessions.progress import StoredProgress, start_of

        self._opener.close()  # saves the session before the next one is looked for
        try:
            progress = await asyncio.to_thread(lambda: StoredProgress(self._opener.sessions).of(event.lesson))
            start = await asyncio.to_thread(start_of, event.lesson, progress)  # may import Gymnasium
            self._go_to(self._opener.first_screen(start))
        except UserError as fault:
            self.switch_screen(self._opener.lessons(event.lesson.id, fault, comes_from_lesson=True))

    def on_playground_left(self, event: Playground.Left) -> None:
        """Go back, or end with the error."""
        if event.fault is not None and self._start is not None:
            self.exit(event.fault, return_code=1)
            return
        self._opener.close()  # saves the session before it is listed
        if id_ := self._opener.lesson_id:
            self._go_to(self._opener.lessons(id_, event.fault, comes_from_lesson=True))
        else:
            self._go_to(self._opener.catalogue(event.recipe.scenario.id, event.fault))

    def on_playground_neighbour_wanted(self, event: Playground.NeighbourWanted) -> None:
        """Go to the next or previous scenario."""
        known = scenarios()
        ids = [scenario.id for scenario in known]
        unlisted = min(0, -event.offset)
        here = ids.index(event.recipe.scenario.id) if event.recipe.scenario.id in ids else unlisted
        with complaining(self):
            recipe = recipe_for(known[(here + event.offset) % len(known)], {}, event.recipe.seed)
            self._go_to(self._opener.next_playground(recipe))

    def on_playground_reopened(self, event: Playground.Reopened) -> None:
        """Go to a new run."""
        from rl_tui.live.commands import SetSpeed

        self._opener.close()
        playground = self._opener.next_playground(event.recipe)
        playground.send(SetSpeed(event.speed))
        self.switch_screen(playground)

    def _pause_when_idle(self) -> None:
        from rl_tui.screen.playground.playground import Playground

        if self._idleness.begins():
            for screen in self.screen_stack:
                if isinstance(screen, Playground):
                    screen.run.rest()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Forbid a kiosk to suspend its process: there may be no shell."""
        if self._kiosk and action == "suspend_process":
            return False
        return super().check_action(action, parameters)

    def open_url(self, url: str, *, new_tab: bool = True) -> None:
        """Show ``url``: a browser would open where the program runs."""
        self.notify(one_line(url, _LONGEST_ADDRESS), title="address", timeout=15, markup=False)

    def action_ask_to_quit(self) -> None:
        """Copy the selection, else ask or quit."""
        from rl_tui.screen.dialogs.dialog import QuitQuestion

        selected = self.screen.get_selected_text()
        if selected:
            self.copy_to_clipboard(selected)
        elif isinstance(self.screen, QuitQuestion):
            self.exit()
        else:
            self.push_screen(QuitQuestion(self.look.glyphs), lambda quits: self.exit() if quits else None)

    def action_find(self) -> None:
        """Open the search by name."""
        from rl_tui.screen.app.find import FindScreen, entries_in_files, entries_on, new_values

        screen = self.screen
        if isinstance(screen, ActionScreen):
            more = partial(entries_in_files, self._open_found, self._opener.sessions)
            find = FindScreen(self.look, entries_on(screen), partial(new_values, screen), more)
            self.push_screen(find, self._do_found)

    async def _do_found(self, entry: Findable | None) -> None:
        done = None if entry is None else entry.do()
        if isawaitable(done):
            await done

    async def _open_found(self, found: Scenario | Lesson | StoredSession) -> None:
        from rl_tui.live.sessions.session import StoredSession
        from rl_tui.screen.catalogue.catalogue import CatalogueScreen
        from rl_tui.screen.playground.actions.next_lesson import LessonWanted

        with complaining(self):
            if isinstance(found, Scenario):
                self._opener.close()
                self._go_to(self._opener.next_playground(recipe_for(found, {}, 0)))
            elif isinstance(found, StoredSession):
                record = await asyncio.to_thread(found.record)  # may import Gymnasium
                self._opener.close()
                self.post_message(CatalogueScreen.Resumed(found, record))
            else:
                self.post_message(LessonWanted(found))

    async def action_suspend_process(self) -> None:  # type: ignore[override]
        """Suspend if a shell can resume."""
        if not await self.go_to_shell():
            self.notify("Not here: there is no shell. q: quit.", markup=False)

    def on_terminal_driver_lost(self) -> None:
        """End as if the terminal had hung up."""
        self._end(HUNG_UP)

    def exit(
        self, result: UserError | None = None, return_code: int = 0, message: RenderableType | None = None
    ) -> None:
        """End the app and its workers, which could mount widgets late."""
        self.workers.cancel_all()
        super().exit(result, return_code, message)

    def search_themes(self) -> None:
        """Ask for a theme."""
        from rl_tui.screen.dialogs.form import Candidate, Choice

        names = sorted(self.available_themes, key=lambda name: (name not in _OWN_THEMES, name))
        rows = [Candidate(each, each) for each in names]
        self.push_screen(Choice("Colours", rows, self.theme, self.look.glyphs), self._take_theme)

    def _take_theme(self, name: str | None) -> None:
        if name is not None:
            self.theme = name

    def _end(self, status: int) -> None:
        self._opener.close()  # first of all: there may be little time
        self.exit(return_code=status)

    def _handle_exception(self, error: Exception) -> None:
        fault = error.error if isinstance(error, WorkerFailed) else error
        if self._is_ending and isinstance(fault, _GONE):
            return  # widgets of a screen that opens during the end may be gone already
        super()._handle_exception(error)

    def _fatal_error(self) -> None:
        # Textual would print pages here; the command line prints one line
        if self.bug is None:
            self._opener.close()
            self.bug = bug_of(getattr(self, "_exception", None), self._opener.autosave)
        super().exit(return_code=1)

    def _follow_theme(self, _: Theme) -> None:
        look = self.look
        for screen in self.screen_stack:
            for widget in screen.walk_children(with_self=True):
                if hasattr(widget, "look"):
                    widget.look = look
                    getattr(widget, "redraw", widget.refresh)()
                    widget.refresh()


def _built(lesson: LessonRecord) -> Record:
    record = beginning_of(lesson)
    begin(record.lanes[0].recipe)
    return record


def bug_of(fault: Exception | None, autosave: Autosave | None) -> Exception:
    """Add a note on resuming to the error."""
    if isinstance(fault, WorkerFailed) and isinstance(fault.error, Exception):
        fault = fault.error
    if fault is None:
        fault = RuntimeError("no reason is known")
    if autosave is not None and autosave.path is not None:
        fault.add_note(f"your run is saved: rl-tui play {command_line([str(autosave.path)])}")
    return fault
