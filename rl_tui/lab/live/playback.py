"""Runs with a play button, one short piece of work at a time: what a player does, without its thread."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import (
    LOOKING,
    AddLane,
    Apply,
    ChooseBranch,
    ChooseLane,
    ClearBreakpoints,
    Command,
    DropLane,
    EpisodeBack,
    FollowCell,
    GoTo,
    LookAt,
    Pause,
    Restart,
    SetSpeed,
    StepBack,
    ToggleBreakpoint,
)
from rl_tui.lab.live.preparing import preparing
from rl_tui.lab.live.record import Record
from rl_tui.lab.live.snapshot import CellHistory, Phase, Snapshot
from rl_tui.lab.live.travel import AT_ONCE, Travel
from rl_tui.lab.live.until import Breakpoints
from rl_tui.lab.live.viewport import Sight
from rl_tui.lab.run.exact_answers import AT_ONCE_STATES, Answer, ExactAnswers, exact_now
from rl_tui.lab.run.recipe import Beginning, Change, Recipe, begin
from rl_tui.lab.timeline.run_record import RunRecord

if TYPE_CHECKING:
    from rl_tui.lab.live.transport import Transport
    from rl_tui.lab.run.run import Run
    from rl_tui.lab.timeline.run_group import RunGroup
    from rl_tui.worlds.mdp.space import FloatArray

PREPARING: Final = "loading the learner, which on first use takes some seconds"

_ENDED: Final = (Phase.SPENT, Phase.DONE, Phase.STOPPED)
# What replaces a journey that is under way, or does not mind it
_MEANWHILE: Final = (StepBack, GoTo, Pause, SetSpeed, LookAt, FollowCell, DropLane)
# What needs to know where the run shown is to stand
_FROM_HERE: Final = (StepBack, EpisodeBack, ChooseBranch)


class Playback:
    """Takes commands and works them off in chunks of about 15 ms.

    Call :meth:`work` again and again, as soon as it says; between two calls, :meth:`handle` commands that it
    :meth:`takes` and take a :meth:`snapshot` where ``changed``. ``clock`` gives seconds. With ``automatic``
    off no step passes but those that commands ask for. ``on_exact`` is called, from any thread, when an exact
    answer has come that the last snapshot lacked. With ``record`` it begins where that was written.
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
        self.handled = 0
        """How many commands were taken in."""
        self.touched = False
        """Whether anything was done that is worth keeping."""
        self._recipe = recipe
        self._record = record or Record((RunRecord(recipe, ()),), speed=speed)
        self._automatic = automatic
        self._clock = clock
        self._on_exact = on_exact
        self._beginning: Beginning | None = None
        self._motion: Transport | None = None
        self._exact: ExactAnswers | None = None
        self._sight: Sight | None = None  # None: nobody has said what is shown, so everything may be
        self._cell: int | None = None
        self._travel: Travel | None = None
        self._loads = True
        self._announced = False
        self._news = False

    @property
    def phase(self) -> Phase:
        """What is going on."""
        if self._motion is None or self._loads:
            return Phase.PREPARING
        return self._motion.phase if self._travel is None else Phase.SEEKING

    @property
    def changed(self) -> bool:
        """Whether the next snapshot differs from the last one."""
        if self.trains_unseen:
            return False
        return self._news or (self._motion is not None and self._motion.changed)

    @property
    def trains_unseen(self) -> bool:
        """Whether steps pass of which no snapshot is to show anything before the last one is done."""
        return self._motion is not None and self._motion.steps_to_train > 0

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""
        return self._motion is None or self._loads or self._motion.has_an_end or self._travel is not None

    @property
    def _is_occupied(self) -> bool:
        """Whether no command at all can be taken."""
        if self._motion is None or self._loads or self.trains_unseen:
            return True
        return not self._automatic and self.on_the_way

    def takes(self, command: Command) -> bool:
        """Tell whether ``command`` need not wait."""
        if self._is_occupied or self._travel is None:
            return not self._is_occupied
        goal = self._lanes.current.goal
        if goal is None and isinstance(command, _FROM_HERE):
            return True  # it is there; others have to catch up
        knows_where = goal is not None and goal.step is not None
        return isinstance(command, _MEANWHILE) and (knows_where or not isinstance(command, StepBack))

    @property
    def record(self) -> Record:
        """What is needed to come back to here."""
        if self._motion is None:
            return self._record
        motion, lanes = self._motion, self._lanes
        return Record(lanes.records, lanes.shown, motion.breakpoints, motion.speed)

    @property
    def q(self) -> FloatArray | None:
        """The live estimates of the run shown, [P], None while it is not where the record says."""
        return None if self._motion is None or self._travel is not None else self._run.learner.q

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to. Raises UserError where the world of a restart cannot be built.

        Whatever else cannot be done, such as a change that does not fit, is told by the next snapshot.
        """
        self._news = True
        self.handled += 1
        self.touched = self.touched or not isinstance(command, LOOKING)
        if isinstance(command, Restart):
            self._restart(command.recipe)
        else:
            try:
                self._begin(command)
            except UserError as fault:
                if self._ready.phase is Phase.RUNNING:
                    self._ready.rest()
                self._ready.paused_by = str(fault)

    def _begin(self, command: Command) -> None:
        motion = self._ready
        if isinstance(command, Apply):
            self._change(command.change)
        elif isinstance(command, SetSpeed):
            motion.set_speed(command.speed)
        elif isinstance(command, LookAt):
            self._sight = command.sight
        elif isinstance(command, FollowCell):
            self._cell = command.pair
        elif isinstance(command, ToggleBreakpoint):
            self._set_breakpoints(motion.breakpoints.toggled(state=command.state, pair=command.pair))
        elif isinstance(command, ClearBreakpoints):
            self._set_breakpoints(Breakpoints())
        elif isinstance(command, AddLane | ChooseLane | DropLane):
            self._change_lanes(command)
        elif isinstance(command, StepBack | EpisodeBack | GoTo | ChooseBranch):
            self._set_out(command)
        elif self._travel is not None and isinstance(command, Pause):
            motion.rest()
            self._lanes.stay()
            self._start_travel()
        elif not isinstance(command, Restart) and motion.phase not in _ENDED:
            motion.begin(command)

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""
        if self._motion is None:
            self._prepare()
        elif self._loads:
            self._load()
        elif self._travel is not None:
            self._go_on_travelling(self._travel)
        else:
            return self._motion.work()
        return 0.0

    def snapshot(self) -> Snapshot:
        """Return the newest picture of the run; raises what made an exact answer fail."""
        self._news = False
        motion = self._motion
        if motion is None:
            if self._beginning is None:
                raise RuntimeError("there is no world yet")
            return preparing(self._recipe, self._beginning.world, self._record.speed, PREPARING)
        motion.changed = False
        lane, run = self._lanes.current, self._run
        picture = run.snapshot(
            self.phase,
            message=self._message or run.message,
            speed=motion.speed,
            steps_per_second=motion.steps_per_second,
            answer=self._answer(),
            sight=self._sight,
        )
        return replace(
            picture,
            timeline=lane.timeline,
            breakpoints=motion.breakpoints,
            until="" if motion.waiting is None else motion.waiting.describe(run.world),
            paused_by=motion.paused_by,
            lanes=self._lanes.views(),
            lane=self._lanes.shown,
            cell=self._cell_history(),
            handled=self.handled,
        )

    def _cell_history(self) -> CellHistory | None:
        """Return how the cell asked for went; what was asked may be of the world before this one."""
        if self._cell is None or self._cell >= self._run.world.space.pairs:
            return None
        return self._lanes.current.cell_history(self._cell)

    @property
    def _message(self) -> str:
        if self._loads:
            return PREPARING
        return "" if self._travel is None else self._travel.message

    @property
    def _ready(self) -> Transport:
        if self._motion is None:
            raise RuntimeError("commands have to wait while playback is busy")
        return self._motion

    @property
    def _lanes(self) -> RunGroup:
        return self._ready.lanes

    @property
    def _run(self) -> Run:
        return self._lanes.current.run

    def _answer(self) -> Answer:
        """Return the exact answer for the γ in force, as far as it is known."""
        learner, mdp = self._run.learner, self._run.world.mdp
        gamma = learner.hyperparameters.gamma
        if learner.drifted:
            return exact_now(learner.mdp, gamma)
        if self._exact is None or self._exact.mdp is not mdp:
            self._exact = ExactAnswers(mdp, self._on_exact, at_once_states=AT_ONCE_STATES)
        return self._exact.answer(gamma)

    # Beginning

    def _prepare(self) -> None:
        """Build the world; at the next call, load what learns in it."""
        if self._beginning is None:
            self._beginning = begin(self._recipe)
        else:
            self._start(self._record, self._beginning)
        self._news = True

    def _start(self, record: Record, beginning: Beginning) -> None:
        from rl_tui.lab.live.transport import Transport
        from rl_tui.lab.timeline.run_group import RunGroup

        lanes = RunGroup(record.lanes, beginning.world, clock=self._clock)
        lanes.shown = record.shown
        lanes.current.run.warm_up()
        self._motion = Transport(
            lanes, speed=record.speed, automatic=self._automatic, clock=self._clock, answer=self._answer
        )
        self._loads = False
        self._answer()  # it may take a while, so that it had better begin at once
        lanes.resume(record)
        self._set_breakpoints(record.breakpoints)
        self._start_travel()

    def _restart(self, recipe: Recipe) -> None:
        old, motion = self._run, self._ready
        known = old.world if recipe.scenario == old.recipe.scenario else None
        beginning = begin(recipe, known)
        same = beginning.world is old.world
        self._recipe = recipe
        breakpoints = motion.breakpoints if same else Breakpoints()
        self._start(
            Record(self._lanes.restarted(recipe), self._lanes.shown, breakpoints, motion.speed), beginning
        )

    def _load(self) -> None:
        """Say that another algorithm is being loaded, which may take seconds; at the next call, load it."""
        if not self._announced:
            self._announced = True
            return
        for run in self._lanes.cold_runs:
            run.warm_up()
        self._loads = False
        self._ready.go_on(self._ready.phase)

    # Changes

    def _change(self, change: Change) -> None:
        lanes = self._lanes
        lanes.current.apply(change)
        lanes.gather()
        self._take_in_change()
        if lanes.travel:
            self._start_travel()

    def _take_in_change(self) -> None:
        """Take in that an agent was told something, or that another one is shown."""
        motion = self._ready
        motion.paused_by = ""
        motion.measure_anew()
        if motion.phase in _ENDED:
            motion.go_on(Phase.PAUSED)  # what was changed may give a planner something to do again
        self._load_what_is_cold()

    def _load_what_is_cold(self) -> None:
        if any(True for _ in self._lanes.cold_runs):
            self._loads, self._announced = True, False

    def _set_breakpoints(self, breakpoints: Breakpoints) -> None:
        breakpoints.check(self._run.world.space)
        self._ready.breakpoints = breakpoints
        self._ready.watch()

    def _change_lanes(self, command: AddLane | ChooseLane | DropLane) -> None:
        lanes, motion = self._lanes, self._ready
        if isinstance(command, AddLane):
            lanes.add(command.changes)
        else:
            if motion.waiting is not None:
                motion.rest()  # what was waited for was of the lane shown until now
            if isinstance(command, ChooseLane):
                lanes.show(command.lane)
            else:
                lanes.drop(command.lane)
            motion.watch()
        self._take_in_change()
        self._start_travel()

    # Going elsewhere

    def _set_out(self, command: StepBack | EpisodeBack | GoTo | ChooseBranch) -> None:
        lanes, run = self._lanes, self._run
        goal = lanes.current.goal
        here = run.step if goal is None or goal.step is None else goal.step
        self._ready.rest()
        if isinstance(command, StepBack):
            lanes.go_to(step=here - 1)
        elif isinstance(command, EpisodeBack):
            lanes.go_to(episode=max(1, run.learner.episodes + (not run.begins_episode)))
        elif isinstance(command, ChooseBranch):
            lanes.go_to(branch=command.branch)
        else:
            lanes.go_to(step=command.step, episode=command.episode)
        self._start_travel()

    def _start_travel(self) -> None:
        """Go at once as far as no one would notice, and on from there bit by bit."""
        self._travel = Travel(self._lanes, self._clock)
        if not self._loads:
            self._go_on_travelling(self._travel)

    def _go_on_travelling(self, travel: Travel) -> None:
        travel.go_on(AT_ONCE)
        if travel.done:
            self._travel = None
            self._ready.measure_anew()
            self._ready.go_on(self._ready.phase)
            self._load_what_is_cold()
        elif self._automatic and travel.has_news():
            self._news = True
