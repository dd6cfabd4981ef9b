"""The pace of a watched program: at a speed, by steps, or until an event."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.live.pace.pacing import CHUNK, Pace, SpeedMeter
from rl_tui.live.pace.stop_condition import is_optimal, until_in_words
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.live.programs.progress import ProgramHistory, ProgramState, steps_between
from rl_tui.live.programs.watched_program import WatchedProgram, error_in_words
from rl_tui.live.snapshot import PHASES, Phase
from rl_tui.live.state import ENDED, UNFINISHED, State
from rl_tui.programs.watched.messages import NO_LIMIT

if TYPE_CHECKING:
    from rl_tui.programs.watched.program_world import ProgramWorld
    from rl_tui.runs.exact_answers import Answer


# Conditions to stop at


class ProgramStop:
    """Waits for `until` in a program at `progress`.

    Raises:
        UserError: The event is in the past, or the pair or the exact answer does not exist.
    """

    def __init__(self, until: Until, progress: ProgramState, answer: Answer) -> None:
        self.until = until
        self.steps = NO_LIMIT
        """Step at which it is over in any case."""
        self._asked: dict[str, Any] = {}
        self._episodes: int | None = None  # number of episodes to finish
        self._progress = progress
        self._optimum = answer.solution
        world = progress.world
        match until.event:
            case Event.STEP:
                self.steps = until.number
                here = f"step {progress.step:,}"
                _check_ahead(until.number > progress.step, f"step {until.number:,}", here)
            case Event.EPISODE:
                left, here = until.number - 1 - progress.episodes, f"episode {progress.episodes + 1:,}"
                _check_ahead(left > 0, f"the start of episode {until.number:,}", here)
                self._episodes = until.number - 1
            case Event.EPISODE_END:
                self._episodes = progress.episodes + 1 + until.number
            case Event.REWARD:
                self._asked = {"reward": True}
            case Event.POLICY_CHANGE:
                self._asked = {"policy": True}
            case Event.VALUE:
                if not 0 <= until.pair < world.world.space.pairs:
                    raise UserError(f"there is no state–action pair {until.pair}")
                self._asked = {"value": [int(world.cell_of_pair[until.pair]), until.threshold]}
            case Event.OPTIMAL:
                self._check_optimal(answer)
                self._asked = {"policy": True}

    @property
    def asked(self) -> dict[str, Any]:
        """The event that the resting program is asked to stop at, as in messages.py."""
        if self._episodes is None:
            return self._asked
        return {"episode_ends": max(1, self._episodes - self._progress.episodes)}

    @property
    def is_over(self) -> bool:
        """True if the stop of the program is the awaited event."""
        return self.until.event is not Event.OPTIMAL or self._is_optimal()

    def _check_optimal(self, answer: Answer) -> None:
        if self._progress.world.world.mdp is None or answer.refused:
            raise UserError(f"the optimal policy is unknown: {answer.refused}")
        if answer.solution is None:
            raise UserError("the exact values are still being computed: try again in a moment")
        if self._is_optimal():
            raise UserError("the greedy policy is optimal already")

    def _is_optimal(self) -> bool:
        mdp = self._progress.world.world.mdp
        if mdp is None or self._optimum is None or self._progress.table is None:
            return False
        return is_optimal(mdp, self._progress.q, "random", self._optimum)


def asked_for(breakpoints: Breakpoints, world: ProgramWorld) -> dict[str, Any]:
    """Translate `breakpoints` to a request to the program, as in messages.py."""
    asked: dict[str, Any] = {}
    if breakpoints.states:
        states = np.array(sorted(breakpoints.states))
        seen = np.isin(world.state_of, states) | np.isin(world.first_state_of, states)
        asked["states"] = np.flatnonzero(seen).tolist()
    if breakpoints.pairs:
        asked["cells"] = sorted({int(world.cell_of_pair[pair]) for pair in breakpoints.pairs})
    return asked


def met_breakpoint(breakpoints: Breakpoints, progress: ProgramState) -> str:
    """Describe the breakpoint met by the last step of `progress`, or "" if none."""
    if not breakpoints or not progress.step:
        return ""
    world, space = progress.world, progress.world.world.space
    last = steps_between(progress.recording, progress.step - 1, progress.step)
    if not len(last.state):
        return ""
    pair = world.pair(int(last.state[0]), int(last.action[0]), int(last.episode_step[0]))
    if pair in breakpoints.pairs:
        return f"breakpoint: {space.pair_name(pair)}"
    state = world.landing(int(last.next_state[0]), float(last.reward[0]), terminated=bool(last.terminated[0]))
    return f"breakpoint: state {space.state_names[state]}" if state in breakpoints.states else ""


def _check_ahead(is_ahead: bool, wanted: str, here: str) -> None:
    if not is_ahead:
        raise UserError(f"{wanted} is in the past: this is {here}; b and m g go back")


# Events in the recording


def recorded_step(until: Until, history: ProgramHistory) -> int | None:
    """Return the first recorded step after the shown moment at which `until` happened. None if there is
    none, or if it does not depend on steps only.
    """
    shown, newest = history.shown, history.newest
    match until.event:
        case Event.STEP if shown.step < until.number <= newest.step:
            return until.number
        case Event.EPISODE if shown.episodes < until.number - 1 <= newest.episodes:
            return history.begin_of_episode(until.number)
        case Event.EPISODE_END if shown.episodes + until.number < newest.episodes:
            return history.begin_of_episode(shown.episodes + until.number + 2)
        case Event.REWARD:
            rewards = steps_between(history.recording, shown.step, newest.step).reward
            rewarded = np.flatnonzero(rewards)
            return shown.step + int(rewarded[0]) + 1 if len(rewarded) else None
    return None


# Running and stopping


ENDED_BY_ITSELF: Final = "your program has ended"
_WHILE_RUNNING: Final = 0.01
_AT_A_STOP: Final = 0.05
"""Seconds that a pause or a step waits for the program. It usually responds at once."""
_UNANSWERED: Final = 1.0


class ProgramTransport:
    """Lets `program`, ready for its first step, run as far as requested.

    Args:
        program: The watched program.
        answer: Returns the solution for the current γ.
        clock: Returns seconds.
        automatic: False if it runs only as far as commands say.
        speed: Steps per second, or None for full speed.
    """

    def __init__(
        self,
        program: WatchedProgram,
        answer: Callable[[], Answer],
        clock: Callable[[], float],
        *,
        automatic: bool,
        speed: float | None,
    ) -> None:
        self.program = program
        """The watched program."""
        self.history = ProgramHistory(program.log.recording, program.world)
        """Its recorded history."""
        self.state = State.BUILDING
        self.phase = Phase.PREPARING
        self.changed = True
        self.speed = speed
        """Chosen speed in steps per second, or None for full speed."""
        self.meter = SpeedMeter()
        """Measures the speed."""
        self.paused_by = ""
        """Reason for an automatic pause, or for a refused command."""
        self.message = ""
        """Why it has ended, else empty."""
        self.breakpoints = Breakpoints()
        """Where it pauses."""
        self.stop: ProgramStop | None = None
        """The event to run until, or None."""
        self._automatic = automatic
        self._answer = answer
        self._clock = clock
        self._pace = Pace()
        self._goal: int | None = None  # it continues to this step
        self._until: Until | None = None  # waits until the program rests
        self._owed = 0  # steps requested while it was not at rest
        self._is_to_arm = False  # new events to stop at, once it rests
        self.take_in()

    @property
    def on_the_way(self) -> bool:
        """True while a requested operation with an end is unfinished."""
        return self.state in UNFINISHED or self._goal is not None or self._owed > 0

    @property
    def is_still(self) -> bool:
        """True if it takes no step without a command."""
        return self.phase not in (Phase.PREPARING, Phase.RUNNING, Phase.SEEKING)

    @property
    def unanswered(self) -> float:
        """Seconds without a message although the program may continue."""
        program = self.program
        if program.is_settled or (self.state is State.PAUSED and self._goal is None and not self._owed):
            return 0.0
        silent = time.monotonic() - program.heard_at
        return silent if silent > _UNANSWERED else 0.0

    def work(self) -> float | None:
        """Let it continue as far as due and return the seconds until the next call, None for never."""
        match self.state:
            case State.BUILDING:
                self._enter(State.PAUSED)
                self.changed = True
                self.note_end()
                return 0.0
            case State.RUNNING if self._automatic:
                return self._continue_running()
            case State.UNTIL | State.TRAINING:
                return self._continue_to_goal()
        return self._stand_still()

    def rest(self) -> None:
        """Pause."""
        self._forget_goal()
        self.meter.clear()
        self.program.hold()
        if self.state not in ENDED and self.state is not State.BUILDING:
            self._enter(State.PAUSED)
        self._arm()
        self._listen(_AT_A_STOP if not self.program.is_settled else 0.0)

    def pause_at(self, breakpoints: Breakpoints) -> None:
        """Pause at `breakpoints` from now on."""
        self.breakpoints = breakpoints
        if self.stop is not None and not self.program.is_settled:  # its episode count is known only at rest
            self._is_to_arm = True
            self.program.hold()
        else:
            self._arm()

    def _arm(self) -> None:
        self._is_to_arm = False
        asked = {} if self.state is State.TRAINING else asked_for(self.breakpoints, self.program.world)
        self.program.stop_at(asked if self.stop is None else asked | self.stop.asked)

    def go_on_here(self) -> None:
        """Show the newest moment again, where the program continues."""
        self.history.shown = self.history.newest

    def run(self) -> None:
        """Run at the chosen speed, unless running."""
        self.go_on_here()
        if self.state is State.PAUSED:
            self.paused_by, self._owed, self._goal = "", 0, None
            self.meter.clear()
            self.start_pace(at_once=True)
            self._enter(State.RUNNING)

    def start_pace(self, *, at_once: bool) -> None:
        """Aim at the chosen speed from now on."""
        if self.speed is not None:
            self._pace.start(self.speed, self._clock(), at_once)
        elif self.state is State.RUNNING:
            self.meter.clear()

    def take_steps(self, steps: int) -> None:
        """Pause, and take `steps` more steps, in the past, show a later moment."""
        if self.history.in_past:
            self.show(self.history.shown.step + steps)
            return
        owed = self._owed
        if self.state is not State.PAUSED:
            self.rest()
            owed = 0
        if self.state in ENDED:
            return
        self.paused_by = ""
        self._owed = owed + steps
        self._work_off(_AT_A_STOP)

    def train(self, steps: int) -> None:
        """Take exactly `steps` steps (fewer if it ends) before anything else."""
        self.rest()
        self.go_on_here()
        if steps > 0 and self.state not in ENDED:
            self._goal = self.program.log.recording.count + steps
            self.state = State.TRAINING
            self._arm()
            self.changed = False

    def show(self, step: int) -> None:
        """Pause, and show the moment after `step` steps, as far as recorded."""
        self.rest()
        self.history.show(step)

    def run_until(self, until: Until) -> None:
        """Run at full speed until an event, in the past, show it if it was recorded.

        Raises:
            UserError: The event cannot happen.
        """
        self.rest()
        recorded = recorded_step(until, self.history) if self.history.in_past else None
        if recorded is not None:
            self.history.show(recorded)
            self._note_beginning(until)
            return
        self.go_on_here()
        if self.state in ENDED:
            return
        self._enter(State.UNTIL)
        self._until = until
        if self.program.is_settled:
            self._wait_for(until)

    def _wait_for(self, until: Until) -> None:
        """Let the resting program run until an event. Raises UserError if it cannot happen."""
        self._until = None
        try:
            self.stop = ProgramStop(until, self.history.newest, self._answer())
        except UserError:
            self.rest()
            raise
        self._goal = self.stop.steps
        self._arm()

    def go_over_to(self, program: WatchedProgram) -> None:
        """Replace the program by `program`, and run if the old one was running."""
        was_running, old = self.state is State.RUNNING, self.program
        self.program, self.history = program, ProgramHistory(program.log.recording, program.world)
        old.end()
        self.message, self.changed = "", True
        self._forget_goal()
        self.meter.clear()
        self._enter(State.PAUSED)
        self.take_in()
        self._arm()
        if not self.note_end() and was_running:
            self.run()

    def _enter(self, state: State) -> None:
        self.state, self.phase = state, PHASES[state]

    def _forget_goal(self) -> None:
        self._is_to_arm = False
        self.paused_by, self.stop, self._goal, self._owed, self._until = "", None, None, 0, None

    def note_end(self) -> bool:
        """Stop if the program is over and return True in this case."""
        program = self.program
        if not program.is_over or self.state in ENDED:
            return program.is_over
        self.take_in()
        self._forget_goal()
        error = program.log.error
        self.message = ENDED_BY_ITSELF if error is None else f"your program stopped: {error_in_words(error)}"
        if program.log.refused:
            self.message = f"your program cannot be watched: {program.log.refused}"
        self._enter(State.SPENT if error is None and not program.log.refused else State.STOPPED)
        self.changed = True
        return True

    def _listen(self, seconds: float = 0.0) -> None:
        """Read the program's messages for at most `seconds`, until it rests or ends."""
        until = self._clock() + seconds
        program = self.program
        while True:
            left = until - self._clock()
            if program.listen(max(0.0, min(left, _WHILE_RUNNING))):
                self.changed = True
            if program.is_settled or left <= 0.0:
                break
        self.take_in()

    def take_in(self) -> None:
        """Advance the newest moment to the known steps."""
        newest, known = self.history.newest, self.program.known
        if newest.step < known or (newest.table is None and self.program.log.table is not None):
            self.history.go_on(known)
            self.changed = True

    def _continue_running(self) -> float:
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
        if self.note_end() or self._has_stopped():
            return 0.0
        return _WHILE_RUNNING if self.speed is None else self._pace.wait(self._clock())

    def _has_stopped(self) -> bool:
        """Pause at a breakpoint or at the awaited event and return True in this case. The program's stop
        may be neither, because several of our states may share an observation.
        """
        program, stop = self.program, self.stop
        met = program.stopped_by
        if met is None:
            return False
        self.take_in()
        words = met_breakpoint(self.breakpoints, self.history.newest)
        is_over = stop is not None and met in stop.asked and stop.is_over
        if not words and not is_over:
            self._arm()
            program.go_on()
            return False
        self.rest()
        if words:
            self.paused_by = words
        elif stop is not None and stop.until.event is not Event.EPISODE_END:
            self._note_beginning(stop.until)
            self.paused_by = until_in_words(stop.until, self.history.newest.world.world)
        return True

    def _note_beginning(self, until: Until) -> None:
        if until.event is Event.EPISODE:
            self.history.begun_at = self.history.shown.step

    def _continue_to_goal(self) -> float:
        """Continue to the goal, or for some milliseconds."""
        newest = self.history.newest
        if self._is_to_arm and self.program.is_at_rest and self.program.stopped_by is None:
            self._arm()
        elif self._goal is not None and not self._is_to_arm:
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
        self.note_end()
        return 0.0

    def _arrive(self) -> None:
        stop = self.stop
        self.rest()
        self.changed = True
        self.paused_by = met_breakpoint(self.breakpoints, self.history.newest)
        if stop is not None:
            self.paused_by = until_in_words(stop.until, self.history.newest.world.world)

    def _stand_still(self) -> float | None:
        self._work_off(0.0)
        return None if self.note_end() or self.program.is_settled else _WHILE_RUNNING

    def _work_off(self, seconds: float) -> None:
        """Take the pending steps, waiting for at most `seconds`."""
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
            self.note_end()
