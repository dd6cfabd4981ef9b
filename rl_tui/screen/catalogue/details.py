"""The right side of the start screen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rich.console import Group, RenderableType
from textual.containers import Container, Vertical, VerticalScroll
from textual.message import Message
from textual.timer import Timer
from textual.widgets import Static

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.live.sessions.session import SessionError, StoredSession
from rl_tui.screen.catalogue.facts import Prose, blocks_of, faults_text, size_line
from rl_tui.screen.catalogue.scenario_list import Heading, Hit
from rl_tui.screen.catalogue.session_text import kept_line, own_sessions_text, session_facts
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.catalogue.preview import LastRun
    from rl_tui.screen.panels.world.view import WorldView

Entry = Scenario | ScenarioError | Hit | StoredSession | SessionError  # a row of one of the lists

REST: Final = 0.15  # seconds on a row before its run is made
PACE: Final = 0.5  # seconds between two moments of the run


class Details(VerticalScroll):
    """Details of the row under the cursor."""

    @dataclass
    class MomentsWanted(Message):
        """The cursor rests on a scenario without run."""

        scenario: Scenario
        world: World

    @dataclass
    class LastRunWanted(Message):
        """The newest session of the scenario was not repeated yet."""

        session: StoredSession

    def __init__(self, look: Look) -> None:
        # Kept, not looked up: a timer can still run when they are already removed
        self._heading, self._facts = Static(id="heading"), Static(id="facts", markup=False)
        self._moment = Static(id="moment", markup=False)
        self._preview = Container(id="preview")
        self._last_run = Static(id="last-run", markup=False)
        self._own_sessions = Static(id="own-sessions", markup=False)
        self._left = Vertical(self._moment, self._preview, self._last_run, self._own_sessions, id="left")
        self._prose = Prose(look)
        self._stage = Container(self._left, self._prose, id="stage")
        super().__init__(self._heading, self._facts, self._stage, id="details")
        self._look = look
        self.shown: Entry | None = None
        self._newest: StoredSession | None = None  # of the scenario on display
        self._view: WorldView | None = None
        self._moments: dict[str, Sequence[Snapshot]] = {}
        self._last_runs: dict[Path, LastRun | None] = {}
        self._rest: Timer | None = None  # until the cursor rests
        self._pace: Timer | None = None  # from one moment of the picture to the next

    def show(
        self,
        entry: Entry | None,
        world: World | UserError | None,
        lessons: Sequence[str],
        sessions: Sequence[StoredSession],
    ) -> None:
        """Show ``entry``. The rest belongs to a scenario."""
        if entry is not self.shown:
            self.shown = entry
            self.scroll_home(animate=False)
            self._stop_picture()
        self._stage.display = isinstance(entry, Scenario)
        now = datetime.now(UTC)
        if isinstance(entry, Scenario):
            size, kept = size_line(world, self._look), kept_line(len(sessions), self._look)
            self._tell(entry.title, Group(size, kept) if sessions else size)
            self._prose.show(blocks_of(entry, lessons))
            self._own_sessions.display = bool(sessions) and self._has_room
            self._own_sessions.update(own_sessions_text(sessions, now, self._look))
            self._newest = sessions[0] if sessions else None
            self._show_last_run()
            self._draw(entry, world)
        elif isinstance(entry, Hit):
            self._tell(entry.title, "")
        elif isinstance(entry, ScenarioError):
            what = "This file cannot be played until it is fixed."
            self._tell("Errors", faults_text(what, entry.faults, self._look))
        elif isinstance(entry, SessionError):
            what = "This file cannot be resumed. It is not changed."
            self._tell("Errors", faults_text(what, [entry], self._look))
        elif isinstance(entry, StoredSession):
            self._tell(f"Session: {entry.title}", session_facts(entry, now, self._look))
        else:
            self._tell("", "")

    def _tell(self, title: str, text: RenderableType) -> None:
        self._heading.update(Heading(title, self._look) if title else "")
        self._facts.update(text)

    # The picture

    def _draw(self, scenario: Scenario, world: World | UserError | None) -> None:
        if self._view is not None and self._view.world is world:
            return
        if not self._preview.is_attached:
            return  # the app has ended
        self._preview.remove_children()  # no await here: if cancelled, it would leave half behind
        if isinstance(world, World):
            from rl_tui.screen.catalogue.preview import beginning_of
            from rl_tui.screen.panels.world_views import make_world_view

            self._view = view = make_world_view(world, self._look)
            view.can_focus = False
            self._preview.mount(view)
            view.show(beginning_of(scenario, world))
            self._rest = self.set_timer(REST, self.ask_for_moments)
        elif world is None:
            self._preview.mount(Static(f"preparing {self._look.glyphs.ellipsis}", classes="hint"))

    def on_unmount(self) -> None:
        """Stop the picture's timer."""
        if self._pace is not None:
            self._pace.stop()

    def _stop_picture(self) -> None:
        for timer in (self._rest, self._pace):
            if timer is not None:
                timer.stop()
        self._rest = self._pace = self._view = None
        self._moment.update("")
        for picture in self._preview.children:
            picture.display = False

    def take_last_run(self, session: StoredSession, run: LastRun | None) -> None:
        """Save and show a session's result."""
        self._last_runs[session.path] = run
        self._show_last_run()

    def _show_last_run(self) -> None:
        run = None if self._newest is None else self._last_runs.get(self._newest.path)
        self._last_run.display = run is not None and self._has_room
        if run is not None:
            from rl_tui.screen.catalogue.preview import last_run_text

            self._last_run.update(last_run_text(run, self._left.size.width, self._look))

    def ask_for_moments(self) -> None:
        """Ask for a run, unless made."""
        if self._rest is None or self._view is None or not isinstance(self.shown, Scenario):
            return
        self._rest.stop()
        self._rest = None
        if self._newest is not None and self._newest.path not in self._last_runs:
            self.post_message(self.LastRunWanted(self._newest))
        if self.shown.id in self._moments:
            self._play(self._view, self._moments[self.shown.id])
        else:
            self.post_message(self.MomentsWanted(self.shown, self._view.world))

    def take_moments(self, scenario: Scenario, moments: Sequence[Snapshot]) -> None:
        """Save and play ``moments`` of a run."""
        if scenario.id in self._moments:
            return
        self._moments[scenario.id] = moments
        if scenario is self.shown and self._view is not None:
            self._play(self._view, moments)

    def _play(self, view: WorldView, moments: Sequence[Snapshot]) -> None:
        if self._pace is not None:
            self._pace.stop()
        app = self._moving_app
        self._show_moment(view, moments[-1 if app is None else 0])
        if app is None:
            return
        coming = iter(moments[1:])

        def show_next() -> None:
            moment = next(coming, None)
            if moment is None or view is not self._view:  # late ticks can follow a stop
                pace.stop()
            else:
                self._show_moment(view, moment)

        self._pace = pace = app.start_timer(PACE, show_next, repeats=True)

    def _show_moment(self, view: WorldView, moment: Snapshot) -> None:
        from rl_tui.screen.catalogue.preview import moment_line

        view.show(moment)
        self._moment.update(moment_line(moment, self._look))

    @property
    def _has_room(self) -> bool:
        return self.screen.has_class("-tall")

    @property
    def _moving_app(self) -> LinkedApp[Any] | None:
        app = self.app
        if not isinstance(app, LinkedApp) or self._look.glyphs.name == "ascii":
            return None
        return app if app.ticks > 0 and not app.has_slow_link else None
