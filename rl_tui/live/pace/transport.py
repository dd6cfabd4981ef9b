"""The number and time of steps, in seconds. The pace never changes which steps are taken."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.common.words import lasting
from rl_tui.live.pace.pacing import CHUNK, TICK, ChunkSize, Pace, SpeedMeter
from rl_tui.live.pace.stop_condition import is_optimal
from rl_tui.runs.large_worlds import is_large
from rl_tui.runs.recipe import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.agents.kernels.machine_code import Loop
    from rl_tui.runs.exact_answers import Answer
    from rl_tui.runs.run import Run
    from rl_tui.runs.timeline.run_group import RunGroup
    from rl_tui.worlds.mdp.space import IntArray
    from rl_tui.worlds.world import World


# Speed that follows learning


QUIET: Final = 1.5
"""Time without news before the speed rises."""
REST: Final = 0.3
"""Pause when a state gets its first value."""
_LONG_RESTS: Final = 10
_SHORTER: Final = 0.9  # factor between further pauses
_LOOKS_A_SECOND: Final = 1_000
_JUDGED_EVERY: Final = 0.1


class Stage(Enum):
    """The phase of learning that sets the speed."""

    FIRST_REWARD = auto()
    """No estimate has changed yet."""
    SPREADING = auto()
    """States get their first values."""
    OPTIMAL = auto()
    """The greedy policy has become optimal."""
    PULLS = auto()
    """Pulls of a bandit."""


SPEEDS: Final = {
    Stage.FIRST_REWARD: (1_000.0, 3_000.0, 10_000.0, 30_000.0, 100_000.0),
    Stage.SPREADING: (1_000.0, 3_000.0, 10_000.0, 30_000.0),
    Stage.OPTIMAL: (100.0, 300.0, 1_000.0, 30.0),
    Stage.PULLS: (3.0, 10.0, 30.0, 100.0, 300.0),
}
"""Successive speeds while there is no news."""
_ENDING: Final = (Stage.OPTIMAL, Stage.PULLS)


class LearningPace:
    """Adapts the speed to learning.

    It is fast until the first reward changes an estimate, pauses whenever V of a state first differs from the
    initial value, and is slow once the greedy policy is optimal.
    """

    def __init__(self, answer: Callable[[], Answer]) -> None:
        self._answer = answer
        self._world: World | None = None
        self._first_pairs: IntArray
        self._has_choices = True
        self._with_value = self._rests = 0
        self._judged_at = self._since = 0.0
        self._stage, self._rise = Stage.PULLS, 0

    def start(self, run: Run, now: float) -> None:
        """Begin with the current estimates."""
        self._rests = 0
        self._judged_at = now
        self._count(run)
        if run.world.is_bandit:
            self._enter(Stage.PULLS, now)
        elif self._has_optimal_policy(run):
            self._enter(Stage.OPTIMAL, now)
        else:
            self._enter(Stage.FIRST_REWARD if self._is_blank(run) else Stage.SPREADING, now)

    @property
    def speed(self) -> float:
        """Chosen speed."""
        return SPEEDS[self._stage][self._rise]

    @property
    def is_over(self) -> bool:
        """True if no news is expected."""
        if self._rise < len(SPEEDS[self._stage]) - 1:
            return False
        if self._stage is Stage.SPREADING:
            return not self._has_choices or self._answer().solution is None
        return self._stage in _ENDING

    def stride(self, run: Run, due: int) -> int:
        """Return the steps to take before the next check."""
        if self._stage in _ENDING or is_large(run.world):
            return due
        return min(due, max(1, int(self.speed) // _LOOKS_A_SECOND))

    def look(self, run: Run, now: float) -> float | None:
        """Check what changed, and return the length of a pause."""
        if self._stage in _ENDING:
            return None
        before = self._with_value
        self._count(run)
        if self._stage is Stage.FIRST_REWARD and not self._is_blank(run):
            self._enter(Stage.SPREADING, now)
        is_new = self._with_value > before
        if is_new or now - self._judged_at >= _JUDGED_EVERY:
            self._judged_at = now
            if self._has_optimal_policy(run):
                self._enter(Stage.OPTIMAL, now)
        if not is_new:
            return None
        if self._stage is Stage.SPREADING:
            self._enter(Stage.SPREADING, now)
        self._rests += 1
        return REST * _SHORTER ** max(0, self._rests - _LONG_RESTS)

    def hasten(self, now: float) -> None:
        """Accelerate after a while without news."""
        if now - self._since >= QUIET and self._rise < len(SPEEDS[self._stage]) - 1:
            self._rise, self._since = self._rise + 1, now

    def in_words(self, *, hides_answer: bool) -> str:
        """Describe the awaited event, without optimality if `hides_answer`."""
        match self._stage:
            case Stage.FIRST_REWARD:
                return "until the first reward"
            case Stage.SPREADING:
                return f"values in {self._with_value:,} of {len(self._first_pairs):,} states"
            case Stage.OPTIMAL:
                return "nothing new" if hides_answer else "optimal policy found"
        return "faster and faster"

    def _enter(self, stage: Stage, now: float) -> None:
        self._stage, self._rise, self._since = stage, 0, now

    def _count(self, run: Run) -> None:
        if self._world is not run.world:
            self._world, first = run.world, run.world.space.first_pair
            self._first_pairs = first[:-1][first[:-1] < first[1:]]
            self._has_choices = len(self._first_pairs) < run.world.space.pairs
        learner = run.learner
        values = np.maximum.reduceat(learner.q, self._first_pairs)
        self._with_value = int(np.count_nonzero(values != learner.hyperparameters.initial_q))

    def _is_blank(self, run: Run) -> bool:
        return not self._with_value and bool((run.learner.q == run.learner.hyperparameters.initial_q).all())

    def _has_optimal_policy(self, run: Run) -> bool:
        learner, optimum = run.learner, self._answer().solution
        if learner.mdp is None or optimum is None or not (self._has_choices and self._with_value):
            return False
        return is_optimal(learner.mdp, learner.q, learner.hyperparameters.ties, optimum)


# Stepping and seeking


NEWS_EVERY: Final = 0.25
WAITING: Final = "{steps:,} steps to replay: waiting for the compiler, which takes a few seconds"
_WORTH_A_FORECAST: Final = 0.5  # seconds at full speed
_ALIKE: Final = 2.0
"""Chunks are similar if they grow by less than this factor."""
_FULL_SPEED: Final = 100_000.0
"""Full speed where no clock says how fast the machine is."""
PIECE: Final = 1_000
"""Steps of a chunk without `automatic`, always the same: an environment that cannot be replayed keeps the
trail of small chunks only, and its picture must not depend on the machine.
"""
_SETTLED: Final = 3
"""Similar chunks in a row before their size counts as settled. The first call of machine code takes
longer.
"""


class Transport:
    """Advances `group` in chunks of about 15 ms and measures the speed.

    Without `automatic` it measures nothing, and time passes only by `ticks_left`.
    """

    def __init__(
        self, group: RunGroup, *, speed: float | None, automatic: bool, clock: Callable[[], float]
    ) -> None:
        self.group = group
        """The runs."""
        self.speed = speed
        """Chosen speed in steps per second, or None for full speed."""
        self.learning: LearningPace | None = None
        """Sets the speed from learning; once over, its last speed remains."""
        self.meter = SpeedMeter()
        """Measures the speed."""
        self.ticks_left = 0
        """Sixtieths of a second that still have to pass."""
        self._ticks = 0  # passed
        self._automatic = automatic
        self._clock = clock
        self._pace = Pace()
        self._chunk = ChunkSize()
        self._loops: list[Loop] = []  # interpreted loops at the last measurement
        self._last_news = 0.0
        self._sought = 0
        self._seek_meter = SpeedMeter()
        self._alike = 0
        """Number of similar chunks in a row."""
        self._settled_at: float | None = None
        """Time at which a seek reached full speed. Earlier chunks are small and give no forecast."""

    def set_speed(self, speed: float | None) -> None:
        """Set a fixed speed."""
        self.learning = None
        self.speed = speed
        self.start(at_once=False)

    def go_by_learning(self, answer: Callable[[], Answer]) -> None:
        """Let learning set the speed, with the solution if known."""
        self.learning = LearningPace(answer)
        self.start(at_once=False)

    def watching(self, *, hides_answer: bool) -> str:
        """Describe what the speed follows, without optimality if `hides_answer`."""
        learning = self.learning
        if learning is None or learning.is_over:
            return ""
        return learning.in_words(hides_answer=hides_answer)

    def look(self) -> None:
        """Check what other steps have changed."""
        if self.learning is not None and not self.learning.is_over:
            self.learning.look(self.group.built_in.run, self._now)

    @property
    def _now(self) -> float:
        return self._clock() if self._automatic else self._ticks * TICK

    @property
    def is_behind(self) -> bool:
        """True if time or steps are due."""
        return self.ticks_left > 0 or self._pace.due(self._now) > 0

    def start(self, *, at_once: bool) -> None:
        """Aim at the chosen speed from now on, the first step `at_once` or not."""
        self.meter.clear()
        if self.learning is not None and not self.learning.is_over:
            self.learning.start(self.group.built_in.run, self._now)
            self.speed = self.learning.speed
        if not self._automatic:
            self.ticks_left = 0
            self._pace.start(self.speed or _FULL_SPEED, self._now, at_once=False)
        elif self.speed is not None:
            self._pace.start(self.speed, self._now, at_once)

    def measure_anew(self) -> None:
        """Forget measured times: a step may now take a thousand times as long."""
        self._chunk = ChunkSize()
        self.meter.clear()
        self._seek_meter.clear()
        self._sought, self._alike, self._settled_at = 0, 0, None
        self._last_news = self._clock()

    def keep_pace(self) -> float:
        """Take due steps, and return the seconds until the next."""
        if self.speed is None and self._automatic:
            self.take_steps(self._chunk.steps)
            return 0.0
        due = self._pace.due(self._now)
        if due > 0 and self.learning is not None and not self.learning.is_over:
            self._take_and_look(self.learning, due)
        elif due > 0:
            self._pace.took(self.take_steps(due))
        elif self.ticks_left:
            self.ticks_left -= 1
            self._ticks += 1
        return self._pace.wait(self._now) if self._automatic else 0.0

    def _take_and_look(self, learning: LearningPace, due: int) -> None:
        run, until, rest = self.group.built_in.run, self._now + CHUNK, None
        while due > 0 and rest is None and self._now < until and not run.over:
            taken = self.take_steps(learning.stride(run, due), in_chunks=self._automatic)
            self._pace.took(taken)
            due -= taken
            rest = learning.look(run, self._now)
            if run.noticed:
                break
        now = self._now
        learning.hasten(now)
        if rest is not None or learning.speed != self.speed:
            self.speed = learning.speed
            self._pace.start(self.speed, now + (rest or 0.0), at_once=False)

    def take_steps(self, steps: int, episodes: int = UNLIMITED, *, in_chunks: bool = True) -> int:
        """Take at most `steps` and `episodes` within a chunk. Return the number of steps.

        Without `in_chunks` only events and the end of the run make them fewer.
        """
        loops = self.group.interpreted_loops
        if loops != self._loops:
            self._loops, self._chunk = loops, ChunkSize()
        run = self.group.current.run
        if in_chunks and self.group.program is None:  # a program is only waited for
            steps = min(steps, self._chunk.steps if self._automatic else PIECE)
        before, start = run.step, self._clock()
        if self._automatic:
            run.learner.set_time_budget(CHUNK)
        self.group.advance(steps, episodes)
        now = self._clock()
        taken = run.step - before
        if taken == self._chunk.steps:
            self._chunk.measured(taken, now - start)
        if self._automatic:
            self.meter.note(now, run.step, self.speed)
        return taken

    def continue_seek(self, seconds: float) -> bool:
        """Seek for about `seconds`. Return True on arrival."""
        now = self._clock()
        until = now + seconds
        while self.group.seeking:
            if now >= until:
                return False
            before, wanted = self._clock(), self._chunk.steps
            taken = self.group.continue_seek(wanted)
            self._sought += taken
            now = self._clock()
            if self._settled_at is not None:
                self._seek_meter.note(now, self._sought, None)
            if taken == wanted:
                self._chunk.measured(taken, now - before)
                self._alike = self._alike + 1 if self._chunk.steps < _ALIKE * wanted else 0
                if self._settled_at is None and self._alike == _SETTLED:
                    self._settled_at = now
            else:
                self._chunk = ChunkSize()  # in another run or loop a step may take a thousand times as long
        self._chunk = ChunkSize()
        return True

    def has_news(self) -> bool:
        """Return True if a seek's progress is due."""
        now = self._clock()
        if now - self._last_news < NEWS_EVERY:
            return False
        self._last_news = now
        return True

    @property
    def steps_to_seek(self) -> int:
        """Steps left to seek."""
        done, steps = self.group.progress
        return steps - done

    def seek_message(self, *, waits: bool) -> str:
        """Describe a seek, which may wait for machine code."""
        if waits:
            return WAITING.format(steps=self.steps_to_seek)
        done, steps = self.group.progress
        goes_back = self.group.program is not None or self.group.built_in.run.learner.rewindable
        begins = "" if goes_back else " from the seed"
        words = f"replaying{begins}: {done:,} of {steps:,} steps"
        rate = self._seek_meter.steps_per_second
        is_sure = self._settled_at is not None and self._clock() - self._settled_at >= _WORTH_A_FORECAST
        return f"{words}, about {lasting((steps - done) / rate)} left" if rate and is_sure else words
