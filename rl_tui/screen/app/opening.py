"""The screens of the app, with their players and sessions.

Each is imported when first needed, for a fast first paint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias, TypeVar

from rl_tui.common.errors import UserError
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.app.display import Display
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.playground_keys import DRAW_PATH
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.lessons.file.view import LessonRecord
    from rl_tui.live.player import MakePlayback, Player
    from rl_tui.live.record import Record
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
    """A run that starts with editing its world."""

    recipe: Recipe


Start: TypeAlias = (
    "Recipe | DrawingStart | StoredSession | LessonStart | WatchedProgram | Literal[Place.LESSONS] | None"
)
"""The start of the app: LESSONS for the lessons, None for the start screen."""


OwnScreen = TypeVar("OwnScreen", bound="ActionScreen")


@dataclass
class Opener:
    """Makes screens as ``display`` and the current ``look`` say, by default with a ``Player`` each."""

    look: Callable[[], Look]
    make_player: Callable[..., Player] | None
    display: Display
    sessions: Path | None
    kiosk: bool
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

    def catalogue(self, start_at: str = "", fault: UserError | None = None) -> CatalogueScreen:
        """Make the start screen."""
        from rl_tui.screen.catalogue.catalogue import CatalogueScreen

        return self._placed(CatalogueScreen(self.look(), start_at, fault, self.sessions))

    def lessons(
        self,
        start_at: str = "",
        fault: UserError | None = None,
        *,
        comes_from_lesson: bool = False,
    ) -> LessonsScreen:
        """Make the list of lessons."""
        from rl_tui.screen.catalogue.lessons import LessonsScreen

        return self._placed(
            LessonsScreen(self.look(), start_at, fault, self.sessions, comes_from_lesson=comes_from_lesson)
        )

    @property
    def has_kept_nothing(self) -> bool:
        """True if no session exists yet: a new user."""
        from rl_tui.live.sessions.session import files_in

        return self.sessions is not None and not files_in(self.sessions)

    def playground(self, recipe: Recipe, *, watches: bool = False, is_gradual: bool = False) -> Playground:
        """Make a new run's playground. With ``watches`` it runs automatically.

        If it ``is_gradual`` or watches, panels appear one by one.
        """
        from rl_tui.live.sessions.autosave import Autosave, untouched

        autosave = None if self.sessions is None else Autosave(untouched(recipe), self.sessions)
        return self._playground(recipe, autosave, watches=watches, is_gradual=watches or is_gradual)

    def next_playground(self, recipe: Recipe) -> Playground:
        """Make the playground that replaces the newest one."""
        from rl_tui.live.commands import HideAnswer

        before, playground = self._wanted, self.playground(recipe)
        if before is not None and before.was_hidden_by_person:
            playground.send(HideAnswer(is_hidden=True))
        return playground

    def first_screen(self, start: Start) -> ActionScreen:
        """Make the screen for ``start``. Raises UserError if a lesson's run cannot be made."""
        if start is None:
            return self.catalogue()
        if isinstance(start, Place):
            return self.lessons()
        if isinstance(start, Recipe):
            return self.playground(start)
        if isinstance(start, DrawingStart):
            playground = self.playground(start.recipe)
            for key in DRAW_PATH:
                playground.early_keys.add(key)
            return playground
        from rl_tui.live.sessions.progress import LessonStart
        from rl_tui.live.sessions.session import StoredSession

        if isinstance(start, StoredSession):
            return self.resumed(start, start.record())
        return self.lesson(start) if isinstance(start, LessonStart) else self.watching(start)

    def resumed(self, session: StoredSession, record: Record) -> Playground:
        """Make the playground that resumes ``session``."""
        from rl_tui.live.sessions.autosave import Autosave

        autosave = None if self.sessions is None else Autosave(record, self.sessions, session)
        recipe = record.lanes[record.shown].recipe
        playground = self._playground(recipe, autosave, record, session)
        playground.wanted.was_hidden_by_person = record.answer_is_hidden is True
        return playground

    def lesson(self, start: LessonStart) -> Playground:
        """Make the playground of a lesson's open page. Raises UserError if its run cannot be made."""
        from rl_tui.live.sessions.autosave import Autosave

        record = beginning_of(start.record)
        autosave = None if self.sessions is None else Autosave(record, self.sessions, start.session)
        return self._playground(record.lanes[0].recipe, autosave, record)

    def other_setup(self, record: Record) -> Playground:
        """Make another setup's playground."""
        if self.autosave is not None:
            self.autosave.hand_over(record)
        return self._playground(record.lanes[0].recipe, self.autosave, record)

    def watching(self, program: WatchedProgram) -> Playground:
        """Make a program's playground, without a session."""
        from rl_tui.live.program_playback import ProgramPlayback
        from rl_tui.live.program_run import usual_recipe

        recipe = usual_recipe(program.world, program.request.seed)
        return self._playground(recipe, None, make_playback=partial(ProgramPlayback, program))

    @property
    def kept(self) -> KeptSession | None:
        """The last session on disk, if any."""
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
        recipe: Recipe,
        autosave: Autosave | None,
        record: Record | None = None,
        resumed: StoredSession | None = None,
        *,
        watches: bool = False,
        is_gradual: bool = False,
        make_playback: MakePlayback | None = None,
    ) -> Playground:
        from rl_tui.live.pace.pacing import START_SPEED
        from rl_tui.live.player import Player
        from rl_tui.screen.frame.legend_switch import LegendSwitch
        from rl_tui.screen.frame.shape import Shape
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
        self.player = (self.make_player or Player)(
            recipe,
            record=record,
            record_sink=None if autosave is None else autosave.sink,
            make_playback=make_playback,
        )
        shape = Shape(
            drawing=recipe.scenario.section.sketch(),
            lanes=record is not None and len(record.lanes) > 1,
            is_program=make_playback is not None,
            has_lesson=lesson is not None,
            reads=lesson is not None,
            spotlight=None if lesson is None else lesson.lesson.page(lesson.page).spotlight,
            is_fresh=record is None or not record.lanes[record.shown].step,
            shown=panels_in_view(lesson, so_far, shows_all=self.legends.shows_all_panels),
        )
        playground = Playground(
            self.look(),
            recipe,
            self.player,
            self.display.fps,
            START_SPEED if record is None else record.speed,
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
        return self._placed(playground)

    def _placed(self, screen: OwnScreen) -> OwnScreen:
        if self.kiosk:
            screen.place |= Place.KIOSK
        return screen


def beginning_of(lesson: LessonRecord) -> Record:
    """Return the record of the open page's setup before its first step.

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
