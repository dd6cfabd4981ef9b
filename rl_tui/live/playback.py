"""Runs with a play button, one short piece of work at a time: what a player does, without its thread."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

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
from rl_tui.live.snapshot_builder import SnapshotBuilder, as_left, view_of
from rl_tui.live.state import BUSY, ENDED, PASSING, SHOWN_AS_NEXT, UNFINISHED, State, shows_trail
from rl_tui.live.world_editor import WorldEditor
from rl_tui.runs.exact_answers import Answer
from rl_tui.runs.recipe import Beginning, Recipe, begin
from rl_tui.runs.timeline.branches import RunRecord

if TYPE_CHECKING:
    from rl_tui.live.pace.transport import Transport
    from rl_tui.runs.run import Run
    from rl_tui.runs.timeline.run_group import RunGroup


class Playback:
    """Takes commands and works them off in chunks of about 15 ms: a machine of the states in ``state.py``.

    Call :meth:`work` again and again, as soon as it says; between two calls, :meth:`handle` commands that it
    :meth:`takes` and take a :meth:`snapshot` where ``changed``. What each command does, and what
    is done in each state, stands in ``handlers.py``. ``clock`` gives seconds. With ``automatic`` off no step
    passes but those that commands ask for. ``on_exact`` is called, from any thread, when an exact answer has
    come that the last snapshot lacked, or more of what many seeds say. With ``record`` it begins where that
    was written.
    """

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
        """What it is doing."""
        self.phase = Phase.PREPARING
        """What snapshots tell of that."""
        self.changed = False
        """Whether the next snapshot differs from the last one."""
        self.handled = 0
        """How many commands were taken in."""
        self.touched = False
        """Whether anything was done that is worth keeping."""
        self.paused_by = ""
        """Why it paused by itself, or why what was asked for cannot be done."""
        self.condition: StopCondition | None = None
        """What it runs until, if it does."""
        self.breakpoints = Breakpoints()
        """Where else it pauses."""
        self.group: RunGroup
        """The runs; none while it is building."""
        self.transport: Transport
        """What moves them on."""
        self._pins: NamedPins
        self._next = State.PAUSED  # what it does once it has loaded, sought or trained
        self.steps_to_train = 0
        """How many steps it has to take before anything else."""
        self.compilation = Compilation(automatic=automatic)
        """Whether runs are interpreted still."""
        self.waits = False
        """Whether a seek waits for machine code."""
        self._recipe = recipe
        self._record = record or Record((RunRecord(recipe),), speed=speed)
        self.automatic = automatic
        """Whether steps pass by themselves."""
        self.clock = clock
        """What gives seconds."""
        self.questions: Questions = Questions(self._record, on_exact, automatic=automatic)
        """What a person asks beside the runs."""
        self.editor = WorldEditor()
        """What a person draws of the world."""
        self._beginning: Beginning | None = None
        self._builder = SnapshotBuilder()

    @property
    def loaded(self) -> tuple[bool, bool]:
        """Whether the world is there, and whether runs are interpreted: libraries are loaded in between."""
        return self.state is not State.BUILDING, self.compilation.interpreted

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""
        return self.state in UNFINISHED

    @property
    def unanswered(self) -> float:
        """For how many seconds what it waits for has not answered; calls of environments count elsewhere."""
        return 0.0

    def close(self) -> None:
        """End what is worked out in processes of their own. It may be called from any thread."""
        self.compilation.close()
        self.questions.close()

    def takes(self, command: Command) -> bool:
        """Return True if ``command`` need not wait."""
        if self.state in BUSY or (not self.automatic and self.state in UNFINISHED):
            return False
        if self.state is State.REBUILDING:
            return isinstance(command, WHILE_REBUILDING)
        return self.state is not State.SEEKING or is_taken_while_seeking(command, self.group.current.seek)

    @property
    def record(self) -> Record:
        """What is needed to come back to here."""
        if self.state is State.BUILDING:
            return self._record
        group, pins = self.group, self._pinned
        if group.current.seek is not None and pins != NO_PINS:  # it says where that leads
            shown = group.current.record
            pins = self._pins.seen_from(group.world_of(shown), pins, shown.recipe)
        can_come = pins == NO_PINS  # by the numbers of this world they would be of others in the next one
        return Record(
            group.records(self.editor.to_come(group.current.run) if can_come else ()),
            group.shown,
            pins.breakpoints,
            self.transport.speed,
            pins.drawn,
            self.questions.is_hidden,
            self.questions.lesson,
        )

    @property
    def table(self) -> LearnedTable | None:
        """The live table of the run shown, None while it is not where the record says."""
        is_elsewhere = self.state is State.BUILDING or self.group.seeking or self.editor.is_ahead
        return None if is_elsewhere else table_of(self.group.current.run)

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to. Raises UserError where the world of a restart cannot be built.

        Whatever else cannot be done, such as a change that does not fit, is told by the next snapshot.
        """
        kind = type(command)
        self.changed = True
        self.handled += 1
        self.touched = self.touched or kind not in LOOKING
        if self.state is not State.BUILDING:
            self.questions.judge(self.group.current.run)
        is_locked = self.questions.keeps_back("run") and takes_steps(command)
        if is_locked or (self.state in ENDED and kind in MOVES):
            return
        try:
            HANDLERS[kind](self, command)
        except UserError as fault:
            if kind is Restart:
                raise
            if self._next in (State.RUNNING, State.UNTIL):
                self.rest()
            self.end_if_over()
            self.paused_by = str(fault)
        self.keep_pins()

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""
        if self.state is not State.BUILDING and self.compilation.has_changed(self.group):
            self.transport.measure_anew()
            self.changed = True
        if self.compilation.is_being_read and self._takes_all_it_can:
            return LOOK_AGAIN
        wait = WORK[self.state](self)
        self.keep_pins()
        return wait

    def snapshot(self) -> Snapshot:
        """Return the newest picture of the run; raises what made an exact answer fail."""
        self.changed = False
        if self.state is State.BUILDING:
            if self._beginning is None:
                raise RuntimeError("there is no world yet")
            return self._builder.preparing(self._recipe, self._beginning.world, self._record, self.questions)
        has_trail = shows_trail(self.state, self.transport.speed)
        if has_trail and not self.automatic:
            self.group.find_trails(math.inf)  # in pieces it would depend on the time
        view, asked = view_of(self), (self.questions, self.editor, self.pins_beside)
        snapshot = self._builder.build(self.group, view, *asked, has_trail=has_trail)
        returns = self.state is State.SEEKING and self.group.current.seek is not None and not self.touched
        return as_left(snapshot, self._record) if returns else snapshot

    def answer(self) -> Answer:
        """Return the exact answer for the γ in force, as far as it is known."""
        return self.questions.exact.of(self.group.current.run)

    # From one state to another

    def _enter(self, state: State) -> None:
        """Do what ``state`` says: at once, or once it has loaded, sought or trained."""
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
        """Build the world; at the next call, what learns in it."""
        if self._beginning is None:
            self._beginning = begin(self._recipe)
        else:
            self.start(self._record, self._beginning)

    def _return(self) -> None:
        """Leave a state that passes, for what was done before it."""
        self.state, self.phase = self._next, PHASES[self._next]
        self.changed = True

    def go_on(self) -> None:
        """Do again what was done before the runs were sought."""
        self._return()
        if self.phase is Phase.RUNNING:
            self.transport.start(at_once=False)
        else:
            self.transport.meter.clear()
        self.end_if_over()

    def rest(self) -> None:
        """Stand still, whatever was under way."""
        self.paused_by = ""
        self.transport.meter.clear()
        if self.condition is not None:
            self.condition = None
            self.watch()
        if self._next is not State.PAUSED:
            self._enter(State.PAUSED)

    def run(self) -> None:
        """Run on at the wanted speed, once the world is there, unless it runs already."""
        if self._next is State.PAUSED:
            self.paused_by = ""
            self.transport.start(at_once=True)
            self._enter(State.RUNNING)

    def run_until(self, until: Until) -> None:
        """Run as fast as it goes until something happens. Raises UserError where it cannot happen."""
        self.rest()
        self.condition = StopCondition(until, self.group.current.run, self.answer)
        self.watch()
        self.compilation.ask()
        self._enter(State.UNTIL)

    def train(self, steps: int) -> None:
        """Take exactly ``steps`` steps, fewer only where the run ends, before anything else."""
        if self.condition is not None:
            self.rest()
        if steps > 0:
            self.steps_to_train = steps
            self.group.current.watch(None)
            self._enter(State.TRAINING)
            self.changed = False  # no snapshot shows anything before the last of these steps

    def end_training(self) -> None:
        """Go on with what was done before."""
        self._return()
        self.watch()
        self.stop_if_due()

    def seek(self) -> None:
        """Bring all runs to where they have to be: at once as far as no one would notice, then bit by bit."""
        self.transport.start_seek()
        self._enter(State.SEEKING)
        continue_seek(self)

    def rebuild(self) -> None:
        """Take no step until the world is there that the editor waits for."""
        self.paused_by = ""
        self._enter(State.REBUILDING)

    def stop_if_due(self) -> None:
        """Rest where the run shown is over or has met a breakpoint."""
        run = self.group.current.run
        if not self.end_if_over() and run.noticed and (words := breakpoint_in_words(run)):
            self.rest()
            self.paused_by = words

    def end_if_over(self) -> bool:
        """Rest for good where the run shown is over and stays where it is; return whether it is so."""
        run = self.group.current.run
        if not run.over or self.state in PASSING:
            return False
        self.rest()
        self._enter(State.DONE if run.learner.converged else State.SPENT if run.spent else State.STOPPED)
        return True

    def watch(self) -> None:
        """Let the run shown stop by itself where it should, in the world that it has come to."""
        run = self.group.current.run
        if self._pins.edited is not run.edited:
            self._come_to_world_of(run)
        until = None if self.condition is None else self.condition.until
        self.group.current.watch(watching_for(until, self.breakpoints))

    @property
    def _pinned(self) -> Pins:
        """What is pinned where the run shown stands."""
        return Pins(self.breakpoints, self.questions.drawn)

    @property
    def pins_beside(self) -> Pins:
        """The same by the numbers of the world in which the lane beside stands, which may be another one."""
        beside, pins = self.group.beside, self._pinned
        return pins if beside is None else self._pins.seen_from(beside.run.edited, pins, beside.recipe)

    def _come_to_world_of(self, run: Run) -> None:
        pins, questions, condition = self._pins, self.questions, self.condition
        questions.cell = pins.pair_in(run.edited, questions.cell, run.recipe)
        awaited = None if condition is None else pins.pair_in(run.edited, condition.pair, run.recipe)
        self.breakpoints, questions.drawn = pins.come_to(run.edited, self._pinned, run.recipe)
        if condition is not None and not condition.goes_on_with(awaited):
            self.rest()
            self.paused_by = "what it ran until is not in the world any more"

    def keep_pins(self) -> None:
        """Keep what is pinned with its state and action, where the run shown has come to another world."""
        if self.state is State.BUILDING or self._pins.edited is self.group.current.run.edited:
            return
        if self.state is State.TRAINING:  # it stops nowhere on the way
            self._come_to_world_of(self.group.current.run)
        else:
            self.watch()

    def set_breakpoints(self, breakpoints: Breakpoints) -> None:
        """Pause there from now on. Raises UserError where the world has no such state or pair."""
        breakpoints.check(self.group.current.run.world.space)
        self.breakpoints = breakpoints
        self.watch()

    def _pins_left(self, record: Record) -> NamedPins:
        """Return the pins of ``record``, which are those of the world in which it was left.

        Raises UserError where that has no such states or pairs.
        """
        left = (
            self.group.first if self._pinned == NO_PINS else self.group.world_of(record.lanes[record.shown])
        )
        record.breakpoints.check(left.world.space)
        self.questions.fit(left.world.space)
        return NamedPins(left, self._pinned)

    def take_in_change(self) -> None:
        """Take in that an agent has other settings, or that another one is shown."""
        self.paused_by = ""
        self.transport.measure_anew()
        if self._next in ENDED:
            self._enter(State.PAUSED)  # what was changed may give a planner something to do again
            self.end_if_over()

    def start(self, record: Record, beginning: Beginning) -> None:
        """Begin with the runs of ``record`` in the world of ``beginning``, and seek where they were left.

        Raises UserError where they cannot have been left so.
        """
        from rl_tui.live.pace.transport import Transport
        from rl_tui.runs.timeline.run_group import RunGroup

        self.group = RunGroup(record.lanes, beginning.world, shown=record.shown, clock=self.clock)
        self.transport = Transport(self.group, speed=record.speed, automatic=self.automatic, clock=self.clock)
        self.condition, self.paused_by = None, ""
        self._enter(State.PAUSED)
        self.compilation.has_changed(self.group)
        self.answer()  # it may take a while, so that it had better begin at once
        self.breakpoints = record.breakpoints
        self._pins = self._pins_left(record)
        self.group.resume(record.lanes)
        self.watch()
        self.seek()
