"""The screens of the app, and the player and session behind each.

Each screen is imported when first needed, for a fast first paint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol, TypeAlias

from rl_tui.common.errors import UserError
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.app.display import Display
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.playground_keys import DRAW_PATH
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.lessons.file.view import LessonRecord
    from rl_tui.live.player import MakePlayback, Player
    from rl_tui.live.record import Record, RecordSink
    from rl_tui.live.sessions.autosave import Autosave, KeptSession
    from rl_tui.live.sessions.progress import LessonStart
    from rl_tui.live.sessions.session import StoredSession
    from rl_tui.programs.watched.watched_program import WatchedProgram
    from rl_tui.screen.board.wanted import Wanted
    from rl_tui.screen.catalogue.catalogue import CatalogueScreen
    from rl_tui.screen.catalogue.lessons import LessonsScreen
    from rl_tui.screen.frame.action_screen import ActionScreen
    from rl_tui.screen.frame.legend_switch import LegendSwitch
    from rl_tui.screen.playground.playground import Playground


@dataclass(frozen=True, slots=True)
class DrawingStart:
    """A run that starts with the editing of its world."""

    recipe: Recipe


Start: TypeAlias = (
    "Recipe | DrawingStart | StoredSession | LessonStart | WatchedProgram | Literal[Place.LESSONS] | None"
)
"""The start of the app: LESSONS for the lessons, None for the start screen."""


class MakePlayer(Protocol):
    """A function that makes the thread behind a playground. ``record`` is a run to resume."""

    def __call__(
        self,
        recipe: Recipe,
        *,
        record_sink: RecordSink | None,
        record: Record | None,
        make_playback: MakePlayback | None = None,
    ) -> Player:
        """Return the player of ``recipe``, or of the result of ``make_playback``."""


def live_player(
    recipe: Recipe,
    *,
    record_sink: RecordSink | None,
    record: Record | None,
    make_playback: MakePlayback | None = None,
) -> Player:
    """Return a player that takes steps as time passes."""
    from rl_tui.live.player import Player

    return Player(recipe, record_sink=record_sink, record=record, make_playback=make_playback)


@dataclass
class Opener:
    """A maker of screens that look and begin as ``display`` says."""

    make_player: MakePlayer
    display: Display
    sessions: Path | None
    kiosk: bool
    panels: Sequence[PanelRow]
    player: Player | None = None
    """The player of the newest playground."""
    legends: LegendSwitch | None = None
    """The choice of legends, shared by all playgrounds."""
    autosave: Autosave | None = None
    """Saves the session of the newest playground, if any."""
    lesson_id: str = ""
    """The id of the lesson in the newest playground, or empty."""
    _wanted: Wanted | None = None
    """The requests of the newest playground."""
    _earlier: Autosave | None = None
    """The one before ``autosave`` that has saved something, if any."""

    def catalogue(self, look: Look, start_at: str = "", fault: UserError | None = None) -> CatalogueScreen:
        """Return the start screen, with the cursor on ``start_at``."""
        from rl_tui.screen.catalogue.catalogue import CatalogueScreen

        catalogue = CatalogueScreen(look, start_at, fault, self.sessions)
        if self.kiosk:
            catalogue.place |= Place.KIOSK
        return catalogue

    def lessons(
        self,
        look: Look,
        start_at: str = "",
        fault: UserError | None = None,
        *,
        comes_from_lesson: bool = False,
    ) -> LessonsScreen:
        """Return the list of lessons, with the cursor on ``start_at``."""
        from rl_tui.screen.catalogue.lessons import LessonsScreen

        lessons = LessonsScreen(look, start_at, fault, self.sessions, comes_from_lesson=comes_from_lesson)
        if self.kiosk:
            lessons.place |= Place.KIOSK
        return lessons

    @property
    def has_kept_nothing(self) -> bool:
        """True if sessions are saved here but none exists yet: a new user."""
        from rl_tui.live.sessions.session import files_in

        return self.sessions is not None and not files_in(self.sessions)

    def playground(
        self, look: Look, recipe: Recipe, *, watches: bool = False, is_gradual: bool = False
    ) -> Playground:
        """Return the playground of a new run. With ``watches`` it runs automatically.

        If it ``is_gradual`` or watches, panels appear one by one.
        """
        from rl_tui.live.pace.pacing import START_SPEED
        from rl_tui.live.sessions.autosave import Autosave, untouched

        autosave = None if self.sessions is None else Autosave(untouched(recipe), self.sessions)
        gradual = watches or is_gradual
        return self._playground(
            look, recipe, autosave, None, START_SPEED, watches=watches, is_gradual=gradual
        )

    def next_playground(self, look: Look, recipe: Recipe) -> Playground:
        """Return the playground of a run that replaces the newest one."""
        from rl_tui.live.commands import HideAnswer

        stays_hidden = self._wanted is not None and self._wanted.was_hidden_by_person
        playground = self.playground(look, recipe)
        if stays_hidden:
            playground.send(HideAnswer(is_hidden=True))
        return playground

    def first_screen(self, look: Look, start: Start) -> ActionScreen:
        """Return the screen for ``start``.

        Raises:
            UserError: The run of a lesson cannot be made.
        """
        if start is None:
            return self.catalogue(look)
        if isinstance(start, Place):
            return self.lessons(look)
        if isinstance(start, Recipe):
            return self.playground(look, start)
        if isinstance(start, DrawingStart):
            playground = self.playground(look, start.recipe)
            for key in DRAW_PATH:
                playground.early_keys.add(key)
            return playground
        from rl_tui.live.sessions.progress import LessonStart
        from rl_tui.live.sessions.session import StoredSession

        if isinstance(start, StoredSession):
            return self.resumed(look, start, start.record())
        return self.lesson(look, start) if isinstance(start, LessonStart) else self.watching(look, start)

    def resumed(self, look: Look, session: StoredSession, record: Record) -> Playground:
        """Return the playground that resumes ``session``, whose contents are ``record``."""
        from rl_tui.live.sessions.autosave import Autosave

        autosave = None if self.sessions is None else Autosave(record, self.sessions, session)
        recipe = record.lanes[record.shown].recipe
        playground = self._playground(look, recipe, autosave, record, record.speed, session)
        playground.wanted.was_hidden_by_person = record.answer_is_hidden is True
        return playground

    def lesson(self, look: Look, start: LessonStart) -> Playground:
        """Return the playground of a lesson, with the run of its open page.

        Raises:
            UserError: That run cannot be made.
        """
        from rl_tui.live.sessions.autosave import Autosave

        record = beginning_of(start.record)
        autosave = None if self.sessions is None else Autosave(record, self.sessions, start.session)
        return self._playground(look, record.lanes[0].recipe, autosave, record, record.speed)

    def other_setup(self, look: Look, record: Record) -> Playground:
        """Return the playground of another setup of the same lesson, begun by ``record``."""
        if self.autosave is not None:
            self.autosave.hand_over(record)
        return self._playground(look, record.lanes[0].recipe, self.autosave, record, record.speed)

    def watching(self, look: Look, program: WatchedProgram) -> Playground:
        """Return the playground in which ``program`` takes the steps, without a session."""
        from rl_tui.live.pace.pacing import START_SPEED
        from rl_tui.live.program_playback import ProgramPlayback
        from rl_tui.live.program_run import usual_recipe

        recipe = usual_recipe(program.world, program.request.seed)
        make_playback = partial(ProgramPlayback, program)
        return self._playground(look, recipe, None, None, START_SPEED, make_playback=make_playback)

    @property
    def kept(self) -> KeptSession | None:
        """The last session on disk, or None."""
        for autosave in (self.autosave, self._earlier):
            if autosave is not None and (kept := autosave.kept) is not None:
                return kept
        return None

    def close(self) -> None:
        """End the newest player, which saves its session."""
        if self.player is not None:
            self.player.close()

    def _playground(
        self,
        look: Look,
        recipe: Recipe,
        autosave: Autosave | None,
        record: Record | None,
        speed: float | None,
        resumed: StoredSession | None = None,
        *,
        watches: bool = False,
        is_gradual: bool = False,
        make_playback: MakePlayback | None = None,
    ) -> Playground:
        from rl_tui.screen.frame.legend_switch import LegendSwitch
        from rl_tui.screen.frame.shape import expected_shape
        from rl_tui.screen.playground.disclosure import FIRST_PANELS, panels_in_view
        from rl_tui.screen.playground.playground import Playground

        if self.autosave is not None and self.autosave is not autosave and self.autosave.has_something:
            self._earlier = self.autosave
        self.autosave = autosave
        lesson = None if record is None else record.lesson
        self.lesson_id = "" if lesson is None else lesson.lesson.id
        wanted = self.display.panels or ("few" if is_gradual else recipe.scenario.panels)
        if self.legends is None:
            self.legends = LegendSwitch(self.sessions)
            self.legends.shows_all_panels &= self.display.panels in (None, "all")
        self.legends.names_all_keys |= not self.has_kept_nothing
        so_far = FIRST_PANELS if wanted == "few" else None if wanted == "all" else wanted
        sink = None if autosave is None else autosave.sink
        self.player = self.make_player(recipe, record_sink=sink, record=record, make_playback=make_playback)
        shape = expected_shape(
            recipe.scenario.section,
            lanes=record is not None and len(record.lanes) > 1,
            is_program=make_playback is not None,
            page=None if lesson is None else lesson.lesson.page(lesson.page),
            is_fresh=record is None or not record.lanes[record.shown].step,
            shown=panels_in_view(lesson, so_far, shows_all=self.legends.shows_all_panels),
        )
        screen = Playground.with_keys_of(self.panels)
        playground = screen(
            look,
            recipe,
            self.player,
            self.display.fps,
            speed,
            self.panels,
            autosave,
            resumed,
            lesson,
            self.legends,
            shape,
            watches=watches,
            so_far=so_far,
            is_gradual=wanted == "few",
            is_big=self.display.is_big and lesson is None,
        )
        self._wanted = playground.wanted
        if self.kiosk:
            playground.place |= Place.KIOSK
        return playground


def beginning_of(lesson: LessonRecord) -> Record:
    """Return the record of the setup of the open page of ``lesson``, before its first step.

    Raises:
        UserError: Its scenario cannot be found or played, or a setting does not fit.
    """
    from rl_tui.lessons.file.setups import recipe_of
    from rl_tui.live.pace.pacing import START_SPEED
    from rl_tui.live.record import Record
    from rl_tui.runs.timeline.branches import RunRecord

    setup = lesson.lesson.setup_of(lesson.page)
    speed = lesson.lesson.setups[setup].speed or START_SPEED
    return Record((RunRecord(recipe_of(lesson.lesson, setup)),), speed=speed, lesson=lesson)
