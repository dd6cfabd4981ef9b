"""The playground: one run on screen. It draws what the player publishes and sends it commands."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Sequence
from contextlib import suppress
from typing import ClassVar, Final

from textual.binding import BindingType
from textual.message import Message
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import (
    LOOKING,
    Command,
    LookAt,
    Pause,
    Play,
    Restart,
    RunEpisode,
    SetSpeed,
    Step,
)
from rl_tui.lab.live.player import START_SPEED, Player
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.run.recipe import Recipe
from rl_tui.terminal.linked_app import LinkedApp
from rl_tui.tui.actions.action import Place
from rl_tui.tui.actions.registry import ORDINALS
from rl_tui.tui.panels.catalogue import CONTROLS, PANELS, PanelRow
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.status_line import StatusLine
from rl_tui.tui.screens.dialogs.model import ModelScreen
from rl_tui.tui.screens.help import HelpScreen
from rl_tui.tui.screens.playground.board import Board
from rl_tui.tui.screens.playground.environment_watchdog import EnvironmentWatchdog
from rl_tui.tui.screens.playground.export_actions import ExportActions
from rl_tui.tui.screens.playground.frame_pacing import Pacer
from rl_tui.tui.screens.playground.lane_actions import LaneActions
from rl_tui.tui.screens.playground.manual_actions import MANUAL_BINDINGS, ManualActions
from rl_tui.tui.screens.playground.panel_actions import PanelActions
from rl_tui.tui.screens.playground.session_actions import SessionActions
from rl_tui.tui.screens.playground.speeds import faster, slower
from rl_tui.tui.screens.playground.time_actions import TimeActions
from rl_tui.tui.screens.playground.until_actions import UntilActions
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

_MOST_PICTURES: Final = 100  # until a picture that shows what was asked for
_UNTIL_SEEN = 3600.0
_ASKS_AGAIN: Final = 0.25  # seconds


class Playground(
    TimeActions,
    UntilActions,
    ManualActions,
    LaneActions,
    PanelActions,
    SessionActions,
    ExportActions,
    EnvironmentWatchdog,
):
    """One run: what it looks like and what may be done with it."""

    CSS_PATH = "playground.tcss"
    BINDINGS: ClassVar[list[BindingType]] = MANUAL_BINDINGS
    AUTO_FOCUS = ""
    place = Place.PLAYGROUND

    class Left(Message):
        """The user goes back to the catalogue, or a fault ended the run."""

        def __init__(self, recipe: Recipe, fault: UserError | None = None) -> None:
            super().__init__()
            self.recipe = recipe
            self.fault = fault

    class NeighbourWanted(Message):
        """The user wants the scenario that stands ``offset`` places further in the catalogue."""

        def __init__(self, recipe: Recipe, offset: int) -> None:
            super().__init__()
            self.recipe = recipe
            self.offset = offset

    def __init__(
        self,
        look: Look,
        recipe: Recipe,
        player: Player,
        fps: float,
        speed: float | None = START_SPEED,
        panels: Sequence[PanelRow] = PANELS,
    ) -> None:
        super().__init__(look, recipe, panels)
        self.player = player
        self._speed = speed
        self._revealed = False
        self._asked = 0  # how many had been sent with the last one that is worth keeping
        self._leaves = False  # whether escape has just been pressed, and nothing done since
        self._pacer = Pacer(fps, self._arrived)
        self._model: ModelScreen | None = None
        self._framed = asyncio.Event()
        self._is_over = False  # whether nothing more will be drawn

    def content(self) -> Iterable[Widget]:
        """Yield the status line and the board."""
        yield StatusLine(self.look, id="status")
        yield Board(self.look, self.recipe, self.panels)

    def on_mount(self) -> None:
        """Draw whatever the player publishes; it starts to load once the first paint is done."""
        self.call_after_refresh(self._start_to_follow)

    def on_unmount(self) -> None:
        """Let the player's thread end, without waiting for it."""
        self.player.close()
        self._end()

    def send(self, command: Command) -> None:
        """Ask the player for something; its answer is drawn without waiting for the next frame."""
        self.sent += 1
        if not isinstance(command, LOOKING):
            self._asked = self.sent
            self._leaves = False
        self.note_sent(command)
        self.player.send(command)
        self._pacer.hurry()

    def _start_to_follow(self) -> None:
        self.run_worker(self._follow(), name="follow the player")

    async def _follow(self) -> None:
        try:
            async for snapshot in self.player.snapshots():
                if not self.is_here:
                    return
                self._pacer.begin()
                self._draw(snapshot)
                await self._painted()
                self._pacer.end()
                self._framed.set()
                await self._pacer.wait()
        except UserError as fault:
            self.post_message(self.Left(self.recipe, self.named(fault)))
        finally:
            self._end()

    def _end(self) -> None:
        self._is_over = True
        self._framed.set()

    def _draw(self, snapshot: Snapshot) -> None:
        before, self.snapshot = self.snapshot, snapshot
        self.follow_time(before, snapshot)
        self.follow_last_update()
        self.compare_with_saved(snapshot)
        with self.app.batch_update():
            self.query_one(StatusLine).show(snapshot)
            self.show_manual_control(snapshot)
            self.board.show(snapshot, revealed=self._revealed)
            if self._model is not None:
                self._model.show(snapshot)

    def on_scrolled(self) -> None:
        """Have the parts of a large world copied that are in view now."""
        pair = self._model.pair if self._model else None
        self.send(LookAt(self.board.viewport._replace(pair=pair)))

    async def settled(self) -> None:
        """Wait until all that was asked for is done and on screen, the exact answer included.

        Where it was left, or a fault has ended the run, there is nothing to wait for. What does not come to
        rest in many pictures never will, and is not waited for either.
        """
        for _ in range(_MOST_PICTURES):
            if self._is_over:
                return
            self._framed.clear()
            done = await self._carried_out()
            if self.snapshot is not done:
                await self._framed.wait()  # it comes to be drawn too, or a newer one
            if self.snapshot is done and self._is_complete(done):
                return
            while not self._is_over and self.snapshot and _lacks_exact(self.snapshot):
                self._framed.clear()
                await self._framed.wait()
            if not self.board.is_complete:
                self.on_scrolled()

    def _is_complete(self, drawn: Snapshot) -> bool:
        return not _lacks_exact(drawn) and self.board.is_complete

    async def _carried_out(self) -> Snapshot:
        try:
            return await self.player.carried_out()
        except UserError as fault:
            raise self.named(fault) from fault

    async def _arrived(self) -> None:
        if isinstance(self.app, LinkedApp):
            await self.app.arrived()

    async def _painted(self) -> None:
        painted = asyncio.Event()
        # the screen on top is asked to tell, and a dialog that closes forgets what it was asked
        while not painted.is_set() and self.call_after_refresh(painted.set):
            with suppress(TimeoutError):
                await asyncio.wait_for(painted.wait(), _ASKS_AGAIN)

    @property
    def focus_chain(self) -> list[Widget]:
        """The order of the tab key: that of the panels in view, wherever they stand."""
        panels = [panel.id for panel in self.board.children]
        seen = [each for each in super().focus_chain if self.board.shows(self.board.panel_of(each))]
        return sorted(seen, key=lambda widget: panels.index(self.board.panel_of(widget)))

    # Running

    def action_run(self) -> None:
        """Run, or pause."""
        phase = self.snapshot.playback.phase if self.snapshot else Phase.PREPARING
        if phase is Phase.SPENT:
            self.tell("the budget is spent; r starts again")
        elif phase is Phase.DONE and self.snapshot:
            self.tell(f"{self.snapshot.playback.message}; another γ goes on, r starts again")
        elif phase is Phase.STOPPED and self.snapshot:
            self.notify(f"{self.snapshot.playback.message}; r starts again", severity="error", markup=False)
        else:
            self.send(Pause() if phase in (Phase.RUNNING, Phase.SEEKING) else Play())

    def rest(self) -> None:
        """Pause a run that goes on while no key is pressed."""
        if self.snapshot is not None and self.snapshot.playback.phase in (Phase.RUNNING, Phase.SEEKING):
            self.send(Pause())
            self.notify("paused: nobody has pressed a key for some minutes", timeout=_UNTIL_SEEN)

    def action_step(self) -> None:
        """Take one step."""
        self.send(Step())

    def action_episode(self) -> None:
        """Run to the end of the episode."""
        self.send(RunEpisode())

    def action_faster(self) -> None:
        """Go to the next higher speed."""
        self._set_speed(faster(self._speed))

    def action_slower(self) -> None:
        """Go to the next lower speed."""
        self._set_speed(slower(self._speed))

    def _set_speed(self, speed: float | None) -> None:
        self._speed = speed
        self.send(SetSpeed(speed))

    def action_reset(self) -> None:
        """Start again with the settings in force and the same seed."""
        if self.snapshot is not None and self.snapshot.timeline.current.end:
            kept = "gone: this is a kiosk" if self.in_kiosk else "kept in the catalogue"
            self.tell(f"the run starts again; the one until now is {kept}")
        self.restart(self.recipe)

    def restart(self, recipe: Recipe) -> None:
        """Start again with ``recipe``."""
        self.recipe = recipe
        self._revealed = False
        self.board.controls.forget()
        self.send(Restart(recipe))

    # The agent

    def on_slider_changed(self, event: Slider.Changed) -> None:
        """Set the hyper-parameter of the slider in the running learner."""
        self.set_parameter(event.name, event.value)

    def action_slider(self, number: int) -> None:
        """Put the focus on a slider, counted from 1; say so if there are not so many."""
        sliders = list(self.board.controls.query(Slider))
        if number > len(sliders):
            self.tell(f"there is no {ORDINALS[number - 1]} slider here")
            return
        self.bring_into_view(CONTROLS)
        sliders[number - 1].focus()

    def show_in_force(self) -> None:
        """Set every slider to the value in force."""
        self.board.controls.forget()
        if self.snapshot is not None:
            self.board.controls.show(self.snapshot)

    # What is shown

    def action_layer(self) -> None:
        """Go to the next layer of the table."""
        self.board.table.next_layer()

    def action_zoom(self) -> None:
        """Show one panel alone, or all again."""
        self.board.zoom(None if self.board.zoomed else self.board.panel_of(self.focused))

    def action_reveal(self) -> None:
        """Show or hide what a bandit keeps secret."""
        if self.snapshot is None or not isinstance(self.snapshot.world.drawing, Arms):
            self.tell("nothing is hidden here; h is for bandits, whose true means it shows")
            return
        self._revealed = not self._revealed
        self._draw(self.snapshot)

    def action_model(self) -> None:
        """Show the model until it is closed."""
        if self.snapshot is None:
            return
        pair, last = self.board.table.cursor_pair, self.snapshot.counters.last_step
        if pair is None and last is not None and (last.learned or not last.planned):
            pair = last.updated_pair if last.planned else last.pair
        self._model = ModelScreen(
            self.look, self.snapshot, pair, revealed=self._revealed, on_scrolled=self.on_scrolled
        )
        self.app.push_screen(self._model, self._model_closed)

    def _model_closed(self, _: None) -> None:
        self._model = None

    def action_help(self) -> None:
        """Show the help."""
        self.app.push_screen(HelpScreen(self.look, self.actions, self.panels, self.recipe.scenario.notes))

    # Elsewhere

    def action_previous_scenario(self) -> None:
        """Go to the previous scenario of the catalogue."""
        self.post_message(self.NeighbourWanted(self.recipe, -1))

    def action_next_scenario(self) -> None:
        """Go to the next scenario of the catalogue."""
        self.post_message(self.NeighbourWanted(self.recipe, 1))

    def action_back(self) -> None:
        """Leave the zoom, or go back to the catalogue."""
        if self.board.zoomed:
            self.board.zoom(None)
        elif self.board.opened is not None:
            self.close_panel()
        elif self._was_used() and not self._leaves:
            self._leaves = True
            kept = "run is then gone" if self.in_kiosk else "session is kept there"
            self.tell(f"esc again goes to the catalogue; this {kept}")
        else:
            self.post_message(self.Left(self.recipe))

    def _was_used(self) -> bool:
        """Return whether there is a run to lose; what was asked for last may not be on screen yet."""
        drawn = self.snapshot
        return drawn is not None and (drawn.counters.step > 0 or drawn.playback.handled < self._asked)


def _lacks_exact(snapshot: Snapshot) -> bool:
    """Return whether the exact answer is still being worked out."""
    return snapshot.exact_answer.solution is None and not snapshot.exact_answer.refused
