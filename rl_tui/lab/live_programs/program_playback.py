"""A watched program with a play button: what a player plays in place of runs of ours."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import LOOKING, MOVES, Command
from rl_tui.lab.live.player import START_SPEED
from rl_tui.lab.live.record import LearnedTable, Record
from rl_tui.lab.live.snapshot import PHASES, Phase, Snapshot
from rl_tui.lab.live.speed.pacing import CHUNK, Pace, SpeedMeter
from rl_tui.lab.live.state import BUSY, ENDED, UNFINISHED, State, shows_trail
from rl_tui.lab.live.stop_condition import until_in_words
from rl_tui.lab.live.until import Breakpoints, Event, Until
from rl_tui.lab.live_programs.beside import RunsBeside
from rl_tui.lab.live_programs.history_of_program import ProgramHistory
from rl_tui.lab.live_programs.program_file import LOOKS, ProgramFile
from rl_tui.lab.live_programs.program_handlers import HANDLERS, refusal_of
from rl_tui.lab.live_programs.program_questions import ProgramQuestions
from rl_tui.lab.live_programs.program_snapshot import Found, ProgramSnapshots, found_of, usual_recipe
from rl_tui.lab.live_programs.program_stop import ProgramStop, asked_for, met_breakpoint
from rl_tui.lab.live_programs.restarts import Restarts
from rl_tui.lab.live_programs.verdicts import Verdicts
from rl_tui.lab.live_programs.watched_program import WatchedProgram, error_in_words
from rl_tui.lab.programs.messages import NO_LIMIT
from rl_tui.lab.programs.program_process import ProgramRequest
from rl_tui.lab.timeline.branches import RunRecord

ENDED_BY_ITSELF: Final = "your program has ended"
_WHILE_RUNNING: Final = 0.01
_AT_A_STOP: Final = 0.05
"""Seconds for which a pause or a step waits for the program: mostly it is there at once."""
_UNANSWERED: Final = 1.0


class ProgramPlayback:
    """Takes commands and works them off in short pieces, as :class:`Playback` does for runs of ours.

    ``program`` was started and stands before its first step. A program cannot be taken back: what is shown of
    its past was recorded, and it goes on where it is. With ``automatic`` off it takes no step but those that
    commands ask for, and its file is not looked at.
    """

    def __init__(
        self,
        program: WatchedProgram,
        on_exact: Callable[[], None],
        *,
        automatic: bool = True,
        speed: float | None = START_SPEED,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.state = State.BUILDING
        self.phase = Phase.PREPARING
        self.changed = True
        self.handled = 0
        self.touched = False
        self.speed = speed
        """The wanted steps a second, None for as fast as it goes."""
        self.meter = SpeedMeter()
        """What measures the steps a second."""
        self.paused_by = ""
        """Why it paused by itself, or why what was asked for cannot be done."""
        self.message = ""
        """Why it goes no further; empty while it does."""
        self.breakpoints = Breakpoints()
        """Where it pauses."""
        self.stop: ProgramStop | None = None
        """What it runs until, if it does."""
        self.automatic = automatic
        self._clock = clock
        self._on_exact = on_exact
        self._pace = Pace()
        self._goal: int | None = None  # it goes on until that step
        self._until: Until | None = None  # waits for the program to come to rest
        self._owed = 0  # steps that were asked for while it had not come to rest
        self._snapshots = ProgramSnapshots()
        self.restarts = Restarts(ProgramFile(program.request.path, clock), self._go_over_to)
        """Starts it again."""
        self.verdicts = Verdicts(on_exact, automatic=automatic)
        """What the detective says of it."""
        self._is_closed = False
        recipe = usual_recipe(program.world, program.request.seed)
        self.usual: Hyperparameters = recipe.hyperparameters
        """The hyper-parameters that the scenario suggests."""
        self._record = Record((RunRecord(recipe),), speed=speed)
        self.questions: ProgramQuestions = ProgramQuestions(self._record, on_exact, automatic=automatic)
        """What a person asks beside it."""
        self.beside = RunsBeside(program.world.world, automatic=automatic)
        """Runs of ours beside it."""
        self.program = program
        """What is watched."""
        self.history = ProgramHistory(program.log.recording, program.world)
        """What it has done so far."""
        self._take_in()

    @property
    def loaded(self) -> tuple[bool, bool]:
        """Whether the world is there."""
        return self.state is not State.BUILDING, False

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""
        waits = self._is_behind or self.restarts.is_awaited
        return self.state in UNFINISHED or self._goal is not None or self._owed > 0 or waits

    @property
    def is_still(self) -> bool:
        """Whether it takes no step before it is told otherwise."""
        return self.phase not in (Phase.PREPARING, Phase.RUNNING, Phase.SEEKING)

    @property
    def shows_trail(self) -> bool:
        """Whether the way that the agent went is shown."""
        return shows_trail(self.state, self.speed)

    @property
    def found(self) -> Found:
        """What is known of how it learns."""
        return found_of(self.verdicts.newest.update, self.program.log.numbers, self.usual)

    @property
    def record(self) -> Record:
        """What would be needed to come back; a program is kept in no session."""
        return self._record

    @property
    def table(self) -> LearnedTable | None:
        """Nothing: a program is kept in no session."""
        return None

    @property
    def unanswered(self) -> float:
        """For how many seconds it has told nothing although it may go on."""
        program = self.program
        if program.is_settled or (self.state is State.PAUSED and self._goal is None and not self._owed):
            return 0.0
        silent = time.monotonic() - program.heard_at
        return silent if silent > _UNANSWERED else 0.0

    def takes(self, command: Command) -> bool:
        """Return True if ``command`` need not wait."""
        if self.state in BUSY:
            return False
        return self.automatic or not self.on_the_way

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to; what cannot be done is told by the next snapshot."""
        kind = type(command)
        self.changed = True
        self.handled += 1
        self.touched = self.touched or kind not in LOOKING
        if self.state in ENDED and kind in MOVES and not self.history.in_past:
            return
        handler = HANDLERS.get(kind)
        try:
            if handler is None:
                raise UserError(refusal_of(command, self.program.request.path.name))
            handler(self, command)
        except UserError as fault:
            if self.state in (State.RUNNING, State.UNTIL):
                self.rest()
            self.paused_by = str(fault)

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""
        if self._is_closed:
            return None
        if self.automatic:
            self._look_at_file()
        wait: float | None
        match self.state:
            case State.BUILDING:
                self._enter(State.PAUSED)
                self.changed = True
                self._note_end()
                return 0.0
            case State.RUNNING if self.automatic:
                wait = self._continue_running()
            case State.UNTIL | State.TRAINING:
                wait = self._continue_to_goal()
            case _:
                wait = self._stand_still()
        self.verdicts.look(self.program.log, is_still=self.is_still and self.program.is_settled)
        self._bring_beside()
        return wait

    def snapshot(self) -> Snapshot:
        """Return the newest picture."""
        self.changed = False
        if not self.automatic:
            self.verdicts.look(self.program.log, is_still=self.program.is_settled)
        return self._snapshots.build(self)

    def close(self) -> None:
        """End the program, and what is worked out beside it."""
        self._is_closed = True
        self.program.end()
        self.restarts.close()
        self.questions.beside.close()

    # What commands ask for

    def rest(self) -> None:
        """Stand still, whatever was under way."""
        self.paused_by, self.stop, self._goal, self._owed, self._until = "", None, None, 0, None
        self.meter.clear()
        self.program.hold()
        if self.state not in ENDED and self.state is not State.BUILDING:
            self._enter(State.PAUSED)
        self.arm()
        self._listen(_AT_A_STOP if not self.program.is_settled else 0.0)

    def arm(self) -> None:
        """Have the program stop at the breakpoints, and at what is waited for."""
        asked = {} if self.state is State.TRAINING else asked_for(self.breakpoints, self.program.world)
        self.program.stop_at(asked if self.stop is None else asked | self.stop.asked)

    def go_on_here(self) -> None:
        """Show the newest moment again: a program goes on where it is."""
        self.history.shown = self.history.newest

    def run(self) -> None:
        """Run on at the wanted speed, unless it runs already."""
        self.go_on_here()
        if self.state is State.PAUSED:
            self.paused_by, self._owed, self._goal = "", 0, None
            self.meter.clear()
            self.start_pace(at_once=True)
            self._enter(State.RUNNING)

    def start_pace(self, *, at_once: bool) -> None:
        """Aim at the wanted speed from now on."""
        if self.speed is not None:
            self._pace.start(self.speed, self._clock(), at_once)
        elif self.state is State.RUNNING:
            self.meter.clear()

    def take_steps(self, steps: int) -> None:
        """Pause, and take ``steps`` more steps."""
        owed = self._owed
        if self.state is not State.PAUSED or self.history.in_past:
            self.rest()
            owed = 0
        self.go_on_here()
        self.paused_by = ""
        self._owed = owed + steps
        self._work_off(_AT_A_STOP)

    def train(self, steps: int) -> None:
        """Take exactly ``steps`` steps, fewer only where it ends, before anything else."""
        self.rest()
        self.go_on_here()
        if steps > 0 and self.state not in ENDED:
            self._goal = self.program.log.recording.count + steps
            self.state = State.TRAINING
            self.arm()
            self.changed = False

    def run_until(self, until: Until) -> None:
        """Run as fast as it goes until something happens. Raises UserError where it cannot happen."""
        self.rest()
        self.go_on_here()
        if self.state in ENDED:
            return
        self._enter(State.UNTIL)
        self._until = until
        if self.program.is_settled:
            self._wait_for(until)

    def _wait_for(self, until: Until) -> None:
        """Have the program, which has come to rest, run until something happens. Raises UserError."""
        self._until = None
        answer = self.questions.exact(self.history.newest, self.found.hyperparameters.gamma)
        try:
            self.stop = ProgramStop(until, self.history.newest, answer)
        except UserError:
            self.rest()
            raise
        self._goal = self.stop.steps
        self.arm()

    def show(self, step: int) -> None:
        """Pause, and show the moment after ``step`` steps, as far as it is recorded."""
        self.rest()
        self.history.show(step)

    def restart(self, request: ProgramRequest | None = None) -> None:
        """Start the program again from its seed; the one until now is shown until that has begun."""
        self.rest()
        self.restarts.begin(request or self.program.request, self.history)
        if not self.automatic:
            self.restarts.wait()

    # What is done in each state

    def _enter(self, state: State) -> None:
        self.state, self.phase = state, PHASES[state]

    @property
    def _is_behind(self) -> bool:
        return not self.automatic and self.beside.is_behind(self.history.shown.step)

    def _listen(self, seconds: float = 0.0) -> None:
        """Take in what the program tells; waits for at most ``seconds``, until it is settled."""
        until = self._clock() + seconds
        program = self.program
        while True:
            left = until - self._clock()
            if program.listen(max(0.0, min(left, _WHILE_RUNNING))):
                self.changed = True
            if program.is_settled or left <= 0.0:
                break
        self._take_in()

    def _take_in(self) -> None:
        """Bring the newest moment to what is known."""
        newest, known = self.history.newest, self.program.known
        if newest.step < known or (newest.table is None and self.program.log.table is not None):
            self.history.go_on(known)
            self.changed = True

    def _note_end(self) -> bool:
        """Rest for good where the program is over; return whether it is."""
        program = self.program
        if not program.is_over or self.state in ENDED:
            return program.is_over
        self._take_in()
        self.paused_by, self.stop, self._goal, self._owed, self._until = "", None, None, 0, None
        error = program.log.error
        self.message = ENDED_BY_ITSELF if error is None else f"your program stopped: {error_in_words(error)}"
        if program.log.refused:
            self.message = f"your program cannot be watched: {program.log.refused}"
        self._enter(State.SPENT if error is None and not program.log.refused else State.STOPPED)
        self.changed = True
        return True

    def _continue_running(self) -> float:
        """Let it take the steps that are due."""
        program, newest, before = self.program, self.history.newest, self.history.newest.step
        if self.speed is None:
            program.let(NO_LIMIT)
            self._listen(0.0)
        else:
            due = self._pace.due(self._clock())
            if due > 0:
                program.let(program.log.recording.count + due)
            self._listen(CHUNK if due > 0 else 0.0)
            self._pace.took(newest.step - before)
        self.meter.note(self._clock(), newest.step, self.speed)
        if self._note_end() or self._has_stopped():
            return 0.0
        return _WHILE_RUNNING if self.speed is None else self._pace.wait(self._clock())

    def _has_stopped(self) -> bool:
        """Rest where the program has met a breakpoint, or what was waited for; return whether it did.

        What it met may be none of both: a state of ours may be one of several with the same observation.
        """
        program, stop = self.program, self.stop
        met = program.stopped_by
        if met is None:
            return False
        self._take_in()
        words = met_breakpoint(self.breakpoints, self.history.newest)
        is_over = stop is not None and met in stop.asked and stop.is_over
        if not words and not is_over:
            program.go_on()
            return False
        self.rest()
        if words:
            self.paused_by = words
        elif stop is not None and stop.until.event is not Event.EPISODE_END:
            self.paused_by = until_in_words(stop.until, self.history.newest.world.world)
        return True

    def _continue_to_goal(self) -> float:
        """Go on to where it is to stop, or until some milliseconds are over."""
        newest = self.history.newest
        if self._goal is not None:
            self.program.let(self._goal)
        self._listen(CHUNK)
        if self._until is not None and self.program.is_at_rest:
            try:
                self._wait_for(self._until)
            except UserError as fault:
                self.paused_by, self.changed = str(fault), True
            return 0.0
        if not self._has_stopped() and self._goal is not None and newest.step >= self._goal:
            self._arrive()
        self._note_end()
        return 0.0

    def _arrive(self) -> None:
        """Rest after the last of the steps that were asked for."""
        stop = self.stop
        self.rest()
        self.changed = True
        self.paused_by = met_breakpoint(self.breakpoints, self.history.newest)
        if stop is not None:
            self.paused_by = until_in_words(stop.until, self.history.newest.world.world)

    def _stand_still(self) -> float | None:
        self._work_off(0.0)
        if not self._note_end() and not self.program.is_settled:
            return _WHILE_RUNNING
        if self.beside.is_behind(self.history.shown.step):
            return 0.0
        return LOOKS if self.automatic else None

    def _work_off(self, seconds: float) -> None:
        """Take the steps that are owed, waiting for the program for at most ``seconds``."""
        program = self.program
        if self._owed and program.is_at_rest:
            self._goal, self._owed = program.log.recording.count + self._owed, 0
            program.let(self._goal)
        self._listen(seconds)
        if program.stopped_by is not None and self._owed == 0 and self._goal is not None:
            self._has_stopped()
        if self._goal is not None and self.history.newest.step >= self._goal:
            self._goal = None
            self.paused_by = met_breakpoint(self.breakpoints, self.history.newest)
        if program.is_over:
            self._note_end()

    def _bring_beside(self) -> None:
        if self.beside.runs and self.beside.follow(self.history.shown.step, CHUNK):
            self.changed = True

    def _look_at_file(self) -> None:
        """Start again where the file was saved; say then what became better."""
        restarts = self.restarts
        has_news = restarts.look_at_file(self.program.request, self.history)
        has_news |= restarts.look()
        self.changed |= restarts.compare(self.history) or has_news

    def _go_over_to(self, program: WatchedProgram) -> None:
        """Watch ``program`` in place of the one until now; it runs on where that ran."""
        before, world = self.program.world, program.world
        if before.is_same(world):
            program.world = world = before
        else:
            self.breakpoints = Breakpoints()
            self.beside = RunsBeside(world.world, automatic=self.automatic)
            self.usual = usual_recipe(world, program.request.seed).hyperparameters
        was_running, old = self.state is State.RUNNING, self.program
        self.program, self.history = program, ProgramHistory(program.log.recording, world)
        old.end()
        self.verdicts.forget()
        self.message, self.paused_by, self.stop, self.changed = "", "", None, True
        self._goal, self._owed, self._until = None, 0, None
        self._enter(State.PAUSED)
        self._take_in()
        self.arm()
        if not self._note_end() and was_running:
            self.run()
