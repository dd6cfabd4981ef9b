"""The work of a player in short pieces, without its thread."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.common.errors import UserError
from rl_tui.live.commands import (
    LOOKING,
    MOVES,
    WHILE_REBUILDING,
    Command,
    Restart,
    is_taken_while_seeking,
    takes_steps,
)
from rl_tui.live.handlers import HANDLERS, WORK, continue_seek
from rl_tui.live.pace.compilation import LOOK_AGAIN, Compilation
from rl_tui.live.pace.stop_condition import StopCondition, breakpoint_in_words, watching_for
from rl_tui.live.pace.until import Breakpoints, Until
from rl_tui.live.pins import NO_PINS, NamedPins, Pins
from rl_tui.live.questions import Questions
from rl_tui.live.record import LearnedTable, Record, table_of
from rl_tui.live.snapshot import PHASES, Phase, Snapshot
from rl_tui.live.snapshot_builder import SnapshotBuilder, as_left
from rl_tui.live.state import BUSY, ENDED, PASSING, SHOWN_AS_NEXT, UNFINISHED, State, shows_trail
from rl_tui.live.world_editor import WorldEditor
from rl_tui.runs.exact_answers import Answer
from rl_tui.runs.recipe import Beginning, Recipe, begin
from rl_tui.runs.timeline.branches import RunRecord

if TYPE_CHECKING:
    from rl_tui.live.pace.transport import Transport
    from rl_tui.runs.played_run import PlayedRun
    from rl_tui.runs.timeline.run_group import RunGroup
    from rl_tui.worlds.world import World


class Playback:
    """A state machine that handles commands and works in chunks of about 15 ms.

    States are in `state.py`, functions in `handlers.py`. Call `work` repeatedly, as soon as its result says.
    In between, pass commands for which `takes` is true to `handle`, and take a `snapshot` if `changed`.

    Args:
        recipe: Start of the run.
        speed: Steps per second, or None for full speed.
        automatic: False if only commands take steps.
        on_exact: Called from any thread for a background answer.
    """

    handlers: Mapping[type, Callable[[Any, Any], None]] = HANDLERS
    """Handler for each type of command."""

    def __init__(
        self,
        recipe: Recipe,
        *,
        speed: float | None,
        automatic: bool,
        clock: Callable[[], float],
        on_exact: Callable[[], None],
        record: Record | None = None,
    ) -> None:
        self.state = State.BUILDING
        """Current state."""
        self.phase = Phase.PREPARING
        """State as snapshots report it."""
        self.changed = False
        """True if the next snapshot differs from the last."""
        self.handled = 0
        """Number of commands handled."""
        self.touched = False
        """True if something worth saving was done."""
        self.paused_by = ""
        """Reason for an automatic pause, or for a refused command."""
        self.condition: StopCondition | None = None
        """The event to run until, or None."""
        self.breakpoints = Breakpoints()
        """Breakpoints."""
        self.group: RunGroup
        """The runs, unset while building."""
        self.transport: Transport
        """Advances the runs."""
        self._pins: NamedPins
        self._next = State.PAUSED  # state after building, seeking or training
        self.steps_to_train = 0
        """Steps to take before anything else."""
        self.compilation = Compilation(automatic=automatic)
        """State of the compilation."""
        self.waits = False
        """True if a seek waits for machine code."""
        self._recipe = recipe
        self._record = record or Record((RunRecord(recipe),), speed=speed)
        self.automatic = automatic
        """True if steps happen without commands."""
        self.clock = clock
        """Returns seconds."""
        self.questions: Questions = Questions(self._record, on_exact, automatic=automatic)
        """Background questions about the runs."""
        self.editor = WorldEditor()
        """Editor of the world."""
        self._beginning: Beginning | None = None
        self._builder = SnapshotBuilder()

    @property
    def loaded(self) -> tuple[bool, bool]:
        """True once the world is built, and while interpreted. Libraries are loaded in between."""
        return self.state is not State.BUILDING, self.compilation.interpreted

    @property
    def on_the_way(self) -> bool:
        """True while an operation is unfinished."""
        is_pacing = self.state is State.RUNNING and not self.automatic and self.transport.is_behind
        return self.state in UNFINISHED or is_pacing

    @property
    def unanswered(self) -> float:
        """Seconds without a program's response."""
        return 0.0

    def close(self) -> None:
        """Stop background processes, from any thread."""
        self.compilation.close()
        self.questions.close()

    def takes(self, command: Command) -> bool:
        """Return True if `command` need not wait."""
        if self.state in BUSY or (not self.automatic and self.on_the_way):
            return False
        if self.state is State.REBUILDING:
            return isinstance(command, WHILE_REBUILDING)
        return self.state is not State.SEEKING or is_taken_while_seeking(command, self.group.current.seek)

    @property
    def record(self) -> Record:
        """Record of the current position."""
        if self.state is State.BUILDING:
            return self._record
        group, pins = self.group, self._pinned
        if group.current.seek is not None and pins != NO_PINS:  # the record refers to the target
            shown = group.current.record
            pins = self._pins.seen_from(group.world_of(shown), pins, shown.recipe)
        can_come = pins == NO_PINS  # in the next world their numbers would mean other states
        return Record(
            group.records(self.editor.to_come(group.built_in.run) if can_come else ()),
            group.shown,
            pins.breakpoints,
            self.transport.speed,
            pins.drawn,
            self.questions.is_hidden,
            self.questions.lesson,
        )

    @property
    def table(self) -> LearnedTable | None:
        """Live table at the recorded position."""
        is_elsewhere = self.state is State.BUILDING or self.group.seeking or self.editor.is_ahead
        return None if is_elsewhere else table_of(self.group.built_in.run)

    def handle(self, command: Command) -> None:
        """Carry out or start `command`. The next snapshot reports its errors.

        Raises UserError if a restart's world cannot be built.
        """
        kind = type(command)
        self.changed = True
        self.handled += 1
        self.touched = self.touched or kind not in LOOKING
        if self.state is not State.BUILDING and self.questions.lesson is not None:
            self.questions.judge(self.group.built_in.run)
        is_locked = "run" in self.questions.kept_back and takes_steps(command)
        if is_locked or (self.state in ENDED and kind in MOVES):
            return
        try:
            self.handlers[kind](self, command)
        except UserError as fault:
            if kind is Restart:
                raise
            if self._next in (State.RUNNING, State.UNTIL):
                self.rest()
            self.end_if_over()
            self.paused_by = str(fault)
        self.keep_pins()

    def work(self) -> float | None:
        """Work for some milliseconds, and return the seconds until the next call, None for never."""
        if self.state is not State.BUILDING and self.compilation.has_changed(self.group):
            self.transport.measure_anew()
            self.changed = True
        if self.compilation.interpreted and BACKGROUND.is_loading and self._takes_all_it_can:
            return LOOK_AGAIN
        wait = WORK[self.state](self)
        self.keep_pins()
        return wait

    def snapshot(self) -> Snapshot:
        """Return the newest snapshot. Raises a failed answer's exception."""
        self.changed = False
        if self.state is State.BUILDING:
            if self._beginning is None:
                raise RuntimeError("there is no world yet")
            return self._builder.preparing(self._recipe, self._beginning.world, self._record, self.questions)
        has_trail = shows_trail(self.state, self.transport.speed)
        if has_trail and not self.automatic:
            self.group.find_trails(math.inf)  # a replay in pieces would depend on timing
        snapshot = self._builder.build(self, has_trail=has_trail)
        returns = self.state is State.SEEKING and self.group.current.seek is not None and not self.touched
        return as_left(snapshot, self._record) if returns else snapshot

    def answer(self) -> Answer:
        """Return the solution for the current γ, if known."""
        return self.questions.exact.of(self.group.current.run)

    # From one state to another

    def _enter(self, state: State) -> None:
        if state not in PASSING:
            self._next = state
        if state in PASSING or self.state not in PASSING:
            self.state = state
        self.phase = PHASES[self._next if self.state in SHOWN_AS_NEXT else self.state]

    @property
    def _takes_all_it_can(self) -> bool:
        is_running = self.state is State.RUNNING and self.transport.speed is None
        return is_running or self.state in (State.SEEKING, State.TRAINING, State.UNTIL)

    def build(self) -> None:
        """Build the world, then the learner."""
        if self._beginning is None:
            self._beginning = begin(self._recipe)
        else:
            self.start(self._record, self._beginning.world)

    def _return(self) -> None:
        self.state, self.phase = self._next, PHASES[self._next]
        self.changed = True

    def go_on(self) -> None:
        """Resume after a seek."""
        self._return()
        if self.phase is Phase.RUNNING:
            self.transport.start(at_once=False)
        else:
            self.transport.meter.clear()
        self.end_if_over()

    def rest(self) -> None:
        """Pause."""
        self.paused_by = ""
        self.transport.meter.clear()
        if self.condition is not None:
            self.condition = None
            self.watch()
        if self._next is not State.PAUSED:
            self._enter(State.PAUSED)

    def take_step(self) -> None:
        """Pause, and take one step."""
        self.rest()
        self.group.advance(steps=1)
        self.stop_if_due()

    def run(self) -> None:
        """Run at the chosen speed."""
        if self._next is State.PAUSED:
            self.paused_by = ""
            self.transport.start(at_once=True)
            self._enter(State.RUNNING)

    def run_until(self, until: Until) -> None:
        """Run at full speed until an event. Raises UserError if impossible."""
        self.rest()
        self.condition = StopCondition(until, self.group.current.run, self.answer)
        self.watch()
        self.compilation.ask()
        self._enter(State.UNTIL)

    def train(self, steps: int) -> None:
        """Take exactly `steps` steps (fewer if the run ends) first."""
        if self.condition is not None:
            self.rest()
        if steps > 0:
            self.steps_to_train = steps
            self.group.current.watch(None)
            self._enter(State.TRAINING)
            self.changed = False  # no snapshot before the last of these steps

    def end_training(self) -> None:
        """Resume after training."""
        self._return()
        self.transport.look()
        self.watch()
        self.stop_if_due()

    def seek(self) -> None:
        """Move all runs to their targets, perhaps bit by bit."""
        self.transport.measure_anew()
        self._enter(State.SEEKING)
        continue_seek(self)

    def rebuild(self) -> None:
        """Pause until the editor's world is ready."""
        self.paused_by = ""
        self._enter(State.REBUILDING)

    def stop_if_due(self) -> None:
        """Pause at the end or at a breakpoint."""
        run = self.group.current.run
        if not self.end_if_over() and run.noticed and (words := breakpoint_in_words(run)):
            self.rest()
            self.paused_by = words

    def end_if_over(self) -> bool:
        """Stop if the visible run is over. Return True then."""
        run = self.group.current.run
        if not run.over or self.state in PASSING:
            return False
        self.rest()
        self._enter(State.DONE if run.learner.converged else State.SPENT if run.spent else State.STOPPED)
        return True

    def watch(self) -> None:
        """Tell the learner what to watch for."""
        run = self.group.current.run
        if self._pins.edited is not run.edited:
            self._come_to_world_of(run)
        until = None if self.condition is None else self.condition.until
        self.group.current.watch(watching_for(until, self.breakpoints))

    @property
    def _pinned(self) -> Pins:
        return Pins(self.breakpoints, self.questions.drawn)

    @property
    def pins_beside(self) -> Pins:
        """Pins in the second world's numbers."""
        beside, pins = self.group.beside, self._pinned
        return pins if beside is None else self._pins.seen_from(beside.run.edited, pins, beside.recipe)

    def _come_to_world_of(self, run: PlayedRun) -> None:
        pins, questions, condition = self._pins, self.questions, self.condition
        questions.cell = pins.pair_in(run.edited, questions.cell, run.recipe)
        awaited = None if condition is None else pins.pair_in(run.edited, condition.pair, run.recipe)
        self.breakpoints, questions.drawn = pins.come_to(run.edited, self._pinned, run.recipe)
        if condition is not None and not condition.goes_on_with(awaited):
            self.rest()
            self.paused_by = "the stop condition is no longer in the world"

    def keep_pins(self) -> None:
        """Move the pins to the current world."""
        if self.state is State.BUILDING or self._pins.edited is self.group.current.run.edited:
            return
        if self.state is State.TRAINING:  # training stops at no breakpoint
            self._come_to_world_of(self.group.current.run)
        else:
            self.watch()

    def set_breakpoints(self, breakpoints: Breakpoints) -> None:
        """Set breakpoints. Raises UserError if the world lacks them."""
        breakpoints.check(self.group.current.run.world.space)
        self.breakpoints = breakpoints
        self.watch()

    def _pins_left(self, record: Record) -> NamedPins:
        """Return the pins of `record`. Raises UserError if its world lacks them."""
        left = (
            self.group.first if self._pinned == NO_PINS else self.group.world_of(record.lanes[record.shown])
        )
        record.breakpoints.check(left.world.space)
        self.questions.fit(left.world.space)
        return NamedPins(left, self._pinned)

    def take_in_change(self) -> None:
        """Update the state after another run or other settings."""
        self.paused_by = ""
        self.transport.measure_anew()
        if self._next in ENDED:
            self._enter(State.PAUSED)  # a change may give a converged planner new work
            self.end_if_over()

    def start(self, record: Record, world: World) -> None:
        """Begin with the runs of `record`, and seek. Raises UserError if impossible."""
        from rl_tui.live.pace.transport import Transport

        self.group = self.group_of(record, world)
        self.transport = Transport(self.group, speed=record.speed, automatic=self.automatic, clock=self.clock)
        self.condition, self.paused_by = None, ""
        self._enter(State.PAUSED)
        self.compilation.has_changed(self.group)
        self.answer()  # start a slow computation early
        self.breakpoints = record.breakpoints
        self._pins = self._pins_left(record)
        self.group.resume(record.lanes)
        self.watch()
        self.seek()

    def group_of(self, record: Record, world: World) -> RunGroup:
        """Return the runs of `record` at their start."""
        from rl_tui.runs.timeline.run_group import RunGroup

        return RunGroup(record.lanes, world, shown=record.shown, clock=self.clock)
