"""How the lanes of a playground move on: at a wanted speed, by the step, until something happens."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rl_tui.lab.live.commands import Pause, Play, RunEpisode, RunUntil, Step, Take, Train
from rl_tui.lab.live.pacing import CHUNK, ChunkSize, Pace, SpeedMeter
from rl_tui.lab.live.snapshot import Phase
from rl_tui.lab.live.stop_condition import StopCondition, breakpoint_in_words, watching_for
from rl_tui.lab.live.until import Breakpoints, Event, Until
from rl_tui.lab.run.recipe import TakeAction

if TYPE_CHECKING:
    from rl_tui.lab.run.exact_answers import Answer
    from rl_tui.lab.run.run import Run
    from rl_tui.lab.timeline.run_group import RunGroup

Move = Play | Pause | Step | RunEpisode | RunUntil | Take | Train


class Transport:
    """Moves ``lanes`` on, in chunks of about 15 ms.

    ``speed`` is the wanted steps a second, None for as fast as it goes. ``clock`` gives seconds. With
    ``automatic`` off no step passes but those that commands ask for, and no speed is measured. ``answer``
    returns the exact answer as far as it is known.
    """

    def __init__(
        self,
        lanes: RunGroup,
        *,
        speed: float | None,
        automatic: bool,
        clock: Callable[[], float],
        answer: Callable[[], Answer],
    ) -> None:
        self.lanes = lanes
        self.phase = Phase.PAUSED
        self.paused_by = ""
        """Why it paused by itself, or why what was asked for cannot be done."""
        self.changed = True
        self.steps_to_train = 0
        self.waiting: StopCondition | None = None
        self.breakpoints = Breakpoints()
        self._speed = speed
        self._automatic = automatic
        self._clock = clock
        self._answer = answer
        self._pace = Pace()
        self._chunk = ChunkSize()
        self._meter = SpeedMeter()

    @property
    def speed(self) -> float | None:
        """The wanted steps a second."""
        return self._speed

    @property
    def steps_per_second(self) -> float | None:
        """The measured speed; None until there is enough to measure."""
        return self._meter.steps_per_second

    @property
    def has_an_end(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""
        return self.steps_to_train > 0 or self.waiting is not None

    @property
    def _run(self) -> Run:
        return self.lanes.current.run

    def begin(self, command: Move) -> None:
        """Begin what ``command`` asks for. Raises UserError where it cannot happen."""
        if isinstance(command, Play):
            self._play()
        elif isinstance(command, Train):
            if self.waiting is not None:
                self.rest()
            self.steps_to_train = max(0, command.steps)
            self.watch()
        elif isinstance(command, RunEpisode | RunUntil):
            self._wait_for(command.until if isinstance(command, RunUntil) else Until(Event.EPISODE_END))
        else:
            self.rest()
            if isinstance(command, Step):
                self.lanes.advance(steps=1)
            elif isinstance(command, Take):
                self.lanes.current.apply(TakeAction(command.action))
                self.lanes.follow()
            self.check_end()

    def work(self) -> float | None:
        """Move on for some milliseconds; return in how many seconds to call again, None for never."""
        if self.steps_to_train:
            self._train()
            return 0.0
        if self.waiting is not None:
            self._wait(self.waiting)
            return 0.0
        if self.phase is not Phase.RUNNING or not self._automatic:
            return None
        if self._speed is None:
            self._advance(self._chunk.steps)
            return 0.0
        return self._keep_pace()

    def rest(self) -> None:
        """Stand still, whatever was under way."""
        self.phase, self.paused_by = Phase.PAUSED, ""
        self.steps_to_train = 0
        self.waiting = None
        self.watch()
        self._meter.clear()

    def go_on(self, phase: Phase) -> None:
        """Take ``phase`` up again after something else."""
        self.phase = phase
        if phase is Phase.RUNNING and self._speed is not None:
            self._pace.start(self._speed, self._clock(), at_once=False)
        self._meter.clear()
        self.changed = True
        self._end_if_over()

    def measure_anew(self) -> None:
        """Forget how long a step takes: it may now take a thousand times as long."""
        self._chunk = ChunkSize()

    def set_speed(self, speed: float | None) -> None:
        """Aim at another speed."""
        self._speed = speed
        self._meter.clear()
        if speed is not None:
            self._pace.start(speed, self._clock(), at_once=False)

    def watch(self) -> None:
        """Let the run shown stop by itself where it should."""
        until = None if self.waiting is None else self.waiting.until
        self.lanes.current.watch(None if self.steps_to_train else watching_for(until, self.breakpoints))

    def check_end(self) -> None:
        """Rest where the run is over or has met a breakpoint."""
        run = self._run
        if not self._end_if_over() and run.noticed and (words := breakpoint_in_words(run)):
            self.rest()
            self.paused_by = words

    def _end_if_over(self) -> bool:
        run = self._run
        if run.over:
            self.rest()
            self.phase = Phase.DONE if run.converged else Phase.SPENT if run.spent else Phase.STOPPED
        return run.over

    def _play(self) -> None:
        if self.phase is Phase.RUNNING:
            return
        self.phase, self.paused_by = Phase.RUNNING, ""
        self._meter.clear()
        if self._speed is not None:
            self._pace.start(self._speed, self._clock(), at_once=True)

    def _train(self) -> None:
        self.steps_to_train -= self._advance(min(self.steps_to_train, self._chunk.steps))
        if self._run.over:
            self.steps_to_train = 0
        if self.steps_to_train == 0:
            self.watch()
        self.changed = self.steps_to_train == 0

    def _wait_for(self, until: Until) -> None:
        self.rest()
        self.waiting = StopCondition(until, self._run, self._answer())
        self.watch()
        self.phase = Phase.RUNNING

    def _wait(self, waiting: StopCondition) -> None:
        """Go on until what is waited for has happened, or some milliseconds are over."""
        run, until = self._run, self._clock() + CHUNK
        while self.waiting is waiting:
            before = run.step
            steps = min(waiting.stride or self._chunk.steps, waiting.steps - before)
            self._advance(steps, waiting.episodes - run.learner.episodes)
            if run.step > before and waiting.is_over(run) and not run.over:
                self.rest()
                if waiting.until.event is not Event.EPISODE_END:
                    self.paused_by = waiting.describe(run.world)
            if self._clock() >= until:
                return

    def _keep_pace(self) -> float:
        now = self._clock()
        due = self._pace.due(now)
        if due > 0:
            self._pace.took(self._advance(min(due, self._chunk.steps)))
        return self._pace.wait(self._clock())

    def _advance(self, steps: int, episodes: int | None = None) -> int:
        """Take at most so many steps, learn how long they take, and return how many they were."""
        run, before, start = self._run, self._run.step, self._clock()
        if self._automatic:
            run.learner.set_time_budget(CHUNK)
        if episodes is None:
            self.lanes.advance(steps)
        else:
            self.lanes.advance(steps, episodes)
        now = self._clock()
        taken = run.step - before
        if taken == self._chunk.steps:
            self._chunk.measured(taken, now - start)
        if self._automatic:
            self._meter.note(now, run.step, self._speed)
        self.changed = True
        self.check_end()
        return taken
