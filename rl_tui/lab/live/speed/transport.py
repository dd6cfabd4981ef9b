"""How a group of runs moves on: so many steps at a time, at a wanted speed, and to where it has to be."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rl_tui.common.words import lasting
from rl_tui.lab.live.speed.learning_pace import LearningPace
from rl_tui.lab.live.speed.pacing import CHUNK, ChunkSize, Pace, SpeedMeter
from rl_tui.lab.run.recipe import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.agents.kernels.machine_code import Loop
    from rl_tui.lab.run.exact_answers import Answer
    from rl_tui.lab.timeline.run_group import RunGroup

NEWS_EVERY: Final = 0.25
WAITING: Final = "{steps:,} steps to replay: waiting for the compiler, which takes some seconds"
_WORTH_A_FORECAST: Final = 0.5  # seconds at full speed
_ALIKE: Final = 2.0
"""A chunk is alike that is less than so many times as large as the one before."""
_SETTLED: Final = 3
"""So many alike in a row have the size that fits; the first call of machine code alone takes long."""


class Transport:
    """Moves ``group`` on in chunks of about 15 ms, and measures how long they take.

    ``clock`` gives seconds. With ``automatic`` off no speed is measured.
    """

    def __init__(
        self, group: RunGroup, *, speed: float | None, automatic: bool, clock: Callable[[], float]
    ) -> None:
        self.group = group
        """The runs that are moved."""
        self.speed = speed
        """The wanted steps a second, None for as fast as it goes."""
        self.learning: LearningPace | None = None
        """What sets the speed while a person watches it learn; once that is over, its last speed stays."""
        self.meter = SpeedMeter()
        """What measures the steps a second."""
        self._automatic = automatic
        self._clock = clock
        self._pace = Pace()
        self._chunk = ChunkSize()
        self._loops: list[Loop] = []  # those that were interpreted when it was measured
        self._last_news = 0.0
        self._sought = 0
        self._seek_meter = SpeedMeter()
        self._alike = 0
        """How many chunks in a row were of about the same size."""
        self._settled_at: float | None = None
        """When a seek came to full speed: at first its chunks are small, which tells nothing of the rest."""

    def set_speed(self, speed: float | None) -> None:
        """Aim at another speed, from now on whatever is learned."""
        self.learning = None
        self.speed = speed
        self.start(at_once=False)

    def go_by_learning(self, answer: Callable[[], Answer]) -> None:
        """Let what is learned set the speed from now on; ``answer`` gives the exact answer, if any."""
        self.learning = LearningPace(answer)
        self.start(at_once=False)

    def watching(self, *, hides_answer: bool) -> str:
        """Return what the speed goes by, in words; empty where it is the wanted one.

        With ``hides_answer`` the words do not tell whether an optimal policy was found.
        """
        learning, run = self.learning, self.group.current.run
        if learning is None or learning.is_over:
            return ""
        if not self._automatic:
            learning.look(run, self._clock())
        return learning.in_words(hides_answer=hides_answer)

    def start(self, *, at_once: bool) -> None:
        """Aim at the wanted speed from now on; ``at_once`` makes the first step due immediately."""
        self.meter.clear()
        if self.learning is not None and not self.learning.is_over:
            self.learning.start(self.group.current.run, self._clock())
            self.speed = self.learning.speed
        if self.speed is not None:
            self._pace.start(self.speed, self._clock(), at_once)

    def measure_anew(self) -> None:
        """Forget how long a step takes: it may now take a thousand times as long, or as short."""
        self._chunk = ChunkSize()
        self.meter.clear()
        self._measure_seek()

    def keep_pace(self) -> float:
        """Take the steps that are due at the wanted speed; return in how many seconds the next ones are."""
        if self.speed is None:
            self.take_steps(self._chunk.steps)
            return 0.0
        due = self._pace.due(self._clock())
        if due > 0 and self.learning is not None and not self.learning.is_over:
            self._take_and_look(self.learning, due)
        elif due > 0:
            self._pace.took(self.take_steps(due))
        return self._pace.wait(self._clock())

    def _take_and_look(self, learning: LearningPace, due: int) -> None:
        """Take steps that are ``due`` as far as there is nothing new, and go on at the speed for what is."""
        run, until, rest = self.group.current.run, self._clock() + CHUNK, None
        while due > 0 and rest is None and self._clock() < until and not run.over:
            taken = self.take_steps(learning.stride(run, due))
            self._pace.took(taken)
            due -= taken
            rest = learning.look(run, self._clock())
            if run.noticed:
                break
        now = self._clock()
        learning.hasten(now)
        if rest is not None or learning.speed != self.speed:
            self.speed = learning.speed
            self._pace.start(self.speed, now + (rest or 0.0), at_once=False)

    def take_steps(self, steps: int, episodes: int = UNLIMITED) -> int:
        """Take at most ``steps`` steps, or ``episodes`` episodes, within a chunk; return how many steps."""
        loops = self.group.interpreted_loops
        if loops != self._loops:
            self._loops, self._chunk = loops, ChunkSize()
        run, steps = self.group.current.run, min(steps, self._chunk.steps)
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

    def start_seek(self) -> None:
        """Note that the group begins to seek now."""
        self._chunk = ChunkSize()
        self._last_news = self._clock()
        self._measure_seek()

    def _measure_seek(self) -> None:
        self._sought, self._alike, self._settled_at = 0, 0, None
        self._seek_meter.clear()

    def continue_seek(self, seconds: float) -> bool:
        """Seek for about so many seconds; return whether all are where they have to be."""
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
        """Return True if it is time to show how far a seek has come."""
        now = self._clock()
        if now - self._last_news < NEWS_EVERY:
            return False
        self._last_news = now
        return True

    @property
    def steps_to_seek(self) -> int:
        """How many steps are left until the run that is seeking now is where it has to be."""
        done, steps = self.group.progress
        return steps - done

    def seek_message(self, *, waits: bool) -> str:
        """Return how far a seek has come and how long it will take, as far as that is known.

        Where it ``waits`` for machine code it says so.
        """
        if waits:
            return WAITING.format(steps=self.steps_to_seek)
        done, steps = self.group.progress
        begins = "" if self.group.current.run.learner.rewindable else " from the seed"
        words = f"replaying{begins}: {done:,} of {steps:,} steps"
        rate = self._seek_meter.steps_per_second
        is_sure = self._settled_at is not None and self._clock() - self._settled_at >= _WORTH_A_FORECAST
        return f"{words}, about {lasting((steps - done) / rate)} left" if rate and is_sure else words
