"""The playground, which draws snapshots and sends commands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Final

from textual import on
from textual.binding import BindingType
from textual.events import DescendantBlur, DescendantFocus, Key
from textual.message import Message
from textual.widget import Widget

from rl_tui.agents.catalogue import parameters_of
from rl_tui.common.errors import UserError
from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.commands import Command
from rl_tui.live.player import Player
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.session import StoredSession
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.board.board import Board
from rl_tui.screen.board.frames import Frames
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.board.wanted import PlayerLink, Wanted
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.frame.action_screen import ActionScreen, Ask, Put
from rl_tui.screen.frame.help import HelpScreen
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.legend_switch import LegendSwitch
from rl_tui.screen.frame.shape import Shape
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.pointing import Pointed, Touched
from rl_tui.screen.kit.row import CAPTION, MICROSCOPE, WORLD
from rl_tui.screen.kit.snapshot_facts import why_over
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.controls.slider import Slider, key_hints
from rl_tui.screen.panels.discount import DiscountPanel
from rl_tui.screen.panels.lesson.lesson import LessonPanel
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.status_line import StatusLine
from rl_tui.screen.panels.timeline import TimelineBar
from rl_tui.screen.playground.actions.agent import AgentActions, WhyActions
from rl_tui.screen.playground.actions.export import ExportActions
from rl_tui.screen.playground.actions.kept_back import KeptBack
from rl_tui.screen.playground.actions.lanes import LaneActions
from rl_tui.screen.playground.actions.lesson import LessonActions
from rl_tui.screen.playground.actions.menus import MenuActions
from rl_tui.screen.playground.actions.opened_panels import MicroscopeActions, PolicyActions, SeedActions
from rl_tui.screen.playground.actions.program import ProgramActions
from rl_tui.screen.playground.actions.run import RunActions, ScenarioActions
from rl_tui.screen.playground.actions.session import LEAVING_KEYS, Leaving, SessionActions
from rl_tui.screen.playground.actions.time import TimeActions
from rl_tui.screen.playground.actions.until import UntilActions
from rl_tui.screen.playground.actions.view import ViewActions
from rl_tui.screen.playground.disclosure import Disclosure
from rl_tui.screen.playground.modes.drawing import PolicyDrawing
from rl_tui.screen.playground.modes.editing import WorldEditing
from rl_tui.screen.playground.modes.manual import ManualControl
from rl_tui.screen.playground.modes.mode import LEAVE, Modes, mode_bindings
from rl_tui.screen.terminal.key_queue import EarlyKeys
from rl_tui.screen.theme.look import Look

_CHECKS_ENVIRONMENT: Final = 0.5  # seconds


class Playground(ActionScreen):
    """The screen of one run.

    Actions are methods of one object per subject. All state besides the newest snapshot is in ``wanted``.
    With ``watches`` the run starts automatically. ``so_far``: first panels. With ``is_gradual`` others appear
    as they get a meaning.
    """

    CSS_PATH = "playground.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [
        *bindings_of(actions_of(Place.PLAYGROUND)),
        *mode_bindings(ManualControl, PolicyDrawing, WorldEditing),
    ]
    AUTO_FOCUS = ""
    ALLOW_SELECT = False  # panels have no text to copy: after a drag ctrl+c would do nothing
    place = Place.PLAYGROUND

    @dataclass
    class Left(Message):
        """The user leaves, or an error ended the run."""

        recipe: Recipe
        fault: UserError | None = None

    @dataclass
    class NeighbourWanted(Message):
        """The user wants the scenario ``offset`` places further."""

        recipe: Recipe
        offset: int

    @dataclass
    class Reopened(Message):
        """The user wants another scenario at the same speed."""

        recipe: Recipe
        speed: float | None

    @dataclass
    class SetupWanted(Message):
        """The learner turns to a page with another setup."""

        record: LessonRecord

    def __init__(
        self,
        look: Look,
        recipe: Recipe,
        player: Player,
        fps: float,
        speed: float | None,
        autosave: Autosave | None,
        resumed: StoredSession | None,
        lesson: LessonRecord | None,
        legends: LegendSwitch,
        shape: Shape,
        *,
        watches: bool,
        so_far: frozenset[str] | None,
        is_gradual: bool,
        is_big: bool,
    ) -> None:
        super().__init__(look)
        self.legends = legends
        self.player = player
        self.wanted = Wanted(recipe, speed, lesson)
        self.status = StatusLine(look, id="status")
        self.status.title = recipe.scenario.title if lesson is None else lesson.lesson.title
        self.board = Board(look, self.wanted, self.legends, shape)
        self.board.caption.title = self.status.title
        self.link = PlayerLink(player, self.wanted, self._note_sent)
        of = self, self.board, self.link
        self.scenario = ScenarioActions(*of, resumed is None, self._reopen, self._go_by)
        self.run = RunActions(*of, self.scenario)
        self.time = TimeActions(*of)
        self.until = UntilActions(*of)
        self.agent = AgentActions(*of)
        self.why = WhyActions(*of, self.agent)
        self.modes = Modes()
        self.manual = ManualControl(*of, self.modes)
        self.drawing = PolicyDrawing(*of, self.modes)
        self.editing = WorldEditing(*of, self.modes)
        self.lanes = LaneActions(*of)
        self.view = ViewActions(*of)
        self.microscope = MicroscopeActions(*of)
        self.seeds = SeedActions(*of)
        self.policies = PolicyActions(*of)
        self.session = SessionActions(*of, self.status, autosave, resumed)
        self.export = ExportActions(*of)
        self.program = ProgramActions(*of)
        self.menus = MenuActions(*of)
        self.panels = Disclosure(*of, so_far, is_gradual)
        self.kept_back = KeptBack(*of)
        self.lesson = LessonActions(
            *of,
            self.kept_back,
            lambda record: self.post_message(self.SetupWanted(record)),
            self.manual.resume,
        )
        self._by_command = {each.command or each.id: each for each in self.known_actions}
        self._told_keys = set[str]()  # ids of actions whose old key was pressed
        self._moment: object = None
        self.leaving = Leaving(*of, self.session, self.modes, lambda: self.lesson.is_over, self._leave)
        self._watches, self._is_big = watches, is_big
        self.frames = Frames(self, fps, self.link, self.board, self.session.named)
        needing_world = (action for action in self.known_actions if action.needs_world)
        self.early_keys = EarlyKeys(key for action in needing_world for key in action.keys)

    @property
    def snapshot(self) -> Snapshot | None:
        """The newest snapshot, None before the first."""
        return self.link.snapshot

    def listed(self, menu: str = "") -> tuple[Action, ...]:
        """Return the available actions, a mode's first."""
        lesson, program, own = self.wanted.lesson, self.program.program, self.modes.actions
        taken = {key for each in own for key in (each.menu or each.key).split(",")}
        usual = (
            replace(each, refused=self.why_not(each))
            for each in super().listed(menu)
            if (lesson or not each.of_lesson) and (program or not each.of_program)
            if (each.menu or each.key.partition(",")[0]) not in taken
        )
        own = tuple(each for each in own if not menu or each.menu == menu)
        return *(replace(each, refused=each.refused or self.why_not(each)) for each in own), *usual

    def why_not(self, action: Action) -> str:
        """Return why ``action`` can do nothing now."""
        target, _, deed = (action.command or action.id).partition(".")
        subject = getattr(self, target, None)
        ends_mode = deed == "toggle" and subject is self.modes.current
        return (
            self.program.why_not_to_it(action)
            or ("" if ends_mode else self.kept_back.why_not_yet(action))
            or (subject.why_not(deed) if isinstance(subject, Subject | Board) else "")
        )

    @property
    def settings(self) -> Mapping[str, tuple[Ask, Put]]:
        """The agent's settings, none for a program."""
        if self.program.program is not None:
            return {}
        names = parameters_of(self.recipe.algorithm, self.recipe.hyperparameters.policy)
        ask, put = self.agent.ask_parameter, self.agent.set_parameter
        return {name: (partial(ask, name), partial(put, name)) for name in names}

    @property
    def recipe(self) -> Recipe:
        """The recipe of a restart."""
        return self.wanted.recipe

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave arrows, digits and others to panels, unless a mode takes them."""
        if action == "do_unfocused":
            return self.focused is None
        if action == "do" and str(parameters[0]).startswith("lesson.") and self.wanted.lesson is None:
            return False
        if action == "mode_key":
            return self.modes.takes(str(parameters[0])) and not (LEAVE in parameters and self.lesson.is_over)
        return super().check_action(action, parameters)

    def action_do(self, command: str) -> None:
        """Run ``command``, or show why not."""
        action = self._by_command.get(command)
        refused = "" if action is None else self.why_not(action)
        if refused:
            self.refuse(refused)
        else:
            if self.wanted.lesson is not None:
                self.kept_back.show_world_for(action)
            self.panels.note(command)
            super().action_do(command)

    action_do_unfocused = action_do  # for moving keys, while no panel has the focus

    async def action_old_key(self, id_: str) -> None:
        """Name the action's new key once, and run it."""
        action = next((each for each in self.actions if each.id == id_), None)
        if action is None:
            return  # of a lesson, a program, or a file in a kiosk
        if not action.refused and (action.old_only_tells or id_ not in self._told_keys):
            self._told_keys.add(id_)
            self.refuse(f"{action.label.rstrip('…')}: {action.shown}")
        if action.refused or not action.old_only_tells:
            await self.run_action(action.textual_action)

    def action_mode_key(self, key: str) -> None:
        """Press ``key`` in the active mode."""
        if self.modes.current is not self.manual or key == LEAVE or not self.kept_back.refuses_to_act():
            self.modes.press(key)

    @on(Touched)
    def _tell_mode(self, event: Touched) -> None:
        self.modes.point(event, self.snapshot)

    @on(Slider.Changed)
    def set_parameter(self, event: Slider.Changed) -> None:
        """Set a slider's number."""
        if not self.editing.set_number(event.name, event.value):
            self.agent.set_parameter(event.name, event.value)

    @on(DiscountPanel.GammaWanted)
    def _set_gamma(self, event: DiscountPanel.GammaWanted) -> None:
        if not self.program.sets_itself():
            self.agent.set_parameter("gamma", event.gamma)

    @on(Slider.Refused)
    def _tell_refusal(self, event: Slider.Refused) -> None:
        self.tell(event.reason, severity="warning")

    @on(Slider.Released)
    def leave_slider(self) -> None:
        """Return the focus to the board."""
        self.board.leave_slider()

    @on(Slider.TypingChanged)
    @on(DescendantFocus)
    @on(DescendantBlur)
    @on(Board.Toggled)
    @on(LessonPanel.Offered)
    def show_key_hints(self) -> None:
        """Show the current keys."""
        snapshot = self.snapshot
        if snapshot is not None:
            self.modes.show(snapshot)
        keys = self.query_one(KeyLine)
        offered = self.lesson.offers or self.editing.offered
        keys.first = key_hints(self.focused) or self.view.with_way_back(offered)
        keys.is_running = self.run.is_under_way
        keys.names_all = self.legends.names_all_keys
        ranked = (each for each in self.known_actions if each.rank is not None and not each.stays)
        refused = (each.id for each in ranked if self.why_not(each))
        hidden = () if self.panels.hides_some else ("panels.turn",)
        keys.idle = self.lesson.idle_keys.union(refused, hidden)

    def _moment_of(self, snapshot: Snapshot) -> object:
        answers, wanted = snapshot.answers, self.wanted
        return (
            *(snapshot.playback.phase, snapshot.world, snapshot.program is None, snapshot.agent.algorithm),
            *(answers.flips, answers.is_hidden, answers.kept_back, bool(snapshot.run_group.lanes)),
            *(self.modes.current, self.board.opened, wanted.recipe.algorithm, wanted.lesson and snapshot),
            *(self.board.shown, self.legends.names_all_keys),
        )

    @on(DescendantFocus)
    def _ask_for_flips(self) -> None:
        self.view.follow_flips()

    @on(TimelineBar.Sought)
    def seek(self, event: TimelineBar.Sought) -> None:
        """Go to the chosen step."""
        self.time.seek(event.step)

    @on(QTable.CursorMoved)
    @on(Pointed)
    def follow_cursor(self, event: QTable.CursorMoved | Pointed) -> None:
        """Show the cursor's cell in the microscope."""
        if isinstance(event, QTable.CursorMoved) or event.panel is self.board.world:
            self.microscope.follow_cursor(of_world=isinstance(event, Pointed))

    def content(self) -> Iterable[Widget]:
        """Yield status line and board."""
        yield from (self.status, self.board)

    def _go_by(self, offset: int) -> None:
        self.post_message(self.NeighbourWanted(self.recipe, offset))

    def _leave(self) -> None:
        self.post_message(self.Left(self.recipe))

    def _reopen(self, recipe: Recipe) -> None:
        self.post_message(self.Reopened(recipe, self.wanted.speed))

    def on_mount(self) -> None:
        """Draw snapshots after the first paint."""
        self.show_key_hints()
        self.call_after_refresh(self._start_to_follow)
        self.set_interval(_CHECKS_ENVIRONMENT, self._show_unanswered)
        self.session.listen()
        if self._is_big:
            self.board.zoom(WORLD)

    def _show_unanswered(self) -> None:
        for line in (self.status, self.board.caption, self.board.lesson.panel):
            line.show_unanswered(self.player.unanswered)

    def on_unmount(self) -> None:
        """End the player's thread without waiting for it."""
        self.player.close()
        self.frames.end()

    def send(self, command: Command) -> None:
        """Send ``command``. Its result is drawn without waiting for the next frame."""
        self.link.send(command)

    def _note_sent(self, command: Command) -> None:
        self.modes.note(command)
        self.frames.pacer.hurry()

    def _start_to_follow(self) -> None:
        if self._watches:
            self.run.watch()
        self.run_worker(self._follow(), name="follow the player")

    async def _follow(self) -> None:
        try:
            await self.frames.follow(self._draw)
        except UserError as fault:
            self.post_message(self.Left(self.recipe, self.session.named(fault)))
        finally:
            self.frames.end()

    def _draw(self, snapshot: Snapshot) -> None:
        before = self.snapshot
        self.link.receive(snapshot)
        if before is None:
            self.agent.set_what_waits()
            self._follow_panels()
        self.run.announce(snapshot)
        self.time.announce(before, snapshot)
        if snapshot.program is not None:
            self.program.announce(before, snapshot)
        if snapshot.lesson is not None:
            self.lesson.announce(before, snapshot)
        self.session.compare_with_saved(snapshot)
        self.redraw()
        if snapshot.playback.phase is not Phase.PREPARING:
            self.early_keys.release(self.app)

    @on(Board.Toggled)
    def _follow_panels(self) -> None:
        if self.snapshot is not None:
            self.microscope.follow_update()
            self.seeds.follow_panel()
            self.view.follow_panel()
            self.policies.follow_panel()

    @on(Board.Toggled)
    def redraw(self) -> None:
        """Draw the newest snapshot on every panel."""
        snapshot = self.snapshot
        if snapshot is None:
            return
        if self.board.opened == MICROSCOPE:
            self.microscope.follow_update()
        if why_over(snapshot) or (snapshot.counters.episodes and snapshot.playback.phase is Phase.PAUSED):
            self.legends.names_all_keys = True
        with self.app.batch_update():
            self.session.show_name()
            self.status.is_captioned = CAPTION in (self.board.shown or ())
            self.status.show(snapshot)
            self.modes.show(snapshot)
            if self.panels.is_gradual or self.wanted.lesson is not None:
                self.panels.follow(snapshot)
            self.board.show(snapshot)
            before, self._moment = self._moment, self._moment_of(snapshot)
            if self._moment != before:
                self.show_key_hints()
                self.view.follow_flips()
            for dialog in self.app.screen_stack:
                if isinstance(dialog, Dialog):
                    dialog.show(snapshot)

    def on_scrolled(self) -> None:
        """Ask for the visible parts of a large world."""
        self.view.look_at()

    async def settled(self) -> None:
        """Wait until everything asked for is on screen, with exact values."""
        await self.frames.settled()

    @property
    def focus_chain(self) -> list[Widget]:
        """The panels in view, in tab order."""
        panels = [panel.id for panel in self.board.children]
        seen = [each for each in super().focus_chain if self.board.shows(self.board.panel_of(each))]
        return sorted(seen, key=lambda widget: panels.index(self.board.panel_of(widget)))

    def on_key(self, event: Key) -> None:
        """Hold early keys that need a world, and reset the question."""
        if self.early_keys.take(event):
            event.stop()
        if event.key not in LEAVING_KEYS:
            self.leaving.asked = None

    def on_mouse_down(self) -> None:
        """Reset the question before leaving."""
        self.leaving.asked = None

    def help_screen(self) -> HelpScreen:
        """Return the help pages."""
        panels = self.lesson.rows(tuple(self.program.in_order_of_help(PANELS)))
        notes = self.kept_back.notes or self.recipe.scenario.notes
        return HelpScreen(self.look, panels, notes)

    def action_quit(self) -> None:
        """Close what is open, or quit."""
        self.leaving.quit()
