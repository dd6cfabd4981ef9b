"""A speed that goes by what is learned: quick until there is something to see, then slow enough to see it.

Only when steps are taken depends on it, never which. Times are in seconds, speeds in steps a second.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.lab.live.stop_condition import is_optimal
from rl_tui.lab.run.large_worlds import is_large
from rl_tui.worlds.drawing import Arms

if TYPE_CHECKING:
    from rl_tui.lab.run.exact_answers import Answer
    from rl_tui.lab.run.run import Run
    from rl_tui.worlds.mdp.space import IntArray
    from rl_tui.worlds.world import World

QUIET: Final = 1.5
"""After so long without anything new it gets faster."""
REST: Final = 0.3
"""So long it stands still where a state has its first value."""
_LONG_RESTS: Final = 10
_SHORTER: Final = 0.9  # each rest after those, than the one before
_LOOKS_A_SECOND: Final = 1_000
_JUDGED_EVERY: Final = 0.1


class Stage(Enum):
    """What there is to see."""

    FIRST_REWARD = auto()
    """No estimate has changed yet."""
    SPREADING = auto()
    """States get their first values."""
    OPTIMAL = auto()
    """The greedy policy came to be optimal."""
    PULLS = auto()
    """The pulls of a bandit."""


SPEEDS: Final = {
    Stage.FIRST_REWARD: (1_000.0, 3_000.0, 10_000.0, 30_000.0, 100_000.0),
    Stage.SPREADING: (1_000.0, 3_000.0, 10_000.0, 30_000.0),
    Stage.OPTIMAL: (100.0, 300.0, 1_000.0, 30.0),
    Stage.PULLS: (3.0, 10.0, 30.0, 100.0, 300.0),
}
"""The speeds that follow one another while nothing new is seen."""
_ENDING: Final = (Stage.OPTIMAL, Stage.PULLS)


class LearningPace:
    """Paces runs; ``answer`` gives the exact answer for the one shown, if there is one.

    It is quick until the first reward has changed an estimate, and gets quicker while none does. Then it
    stands still for a moment whenever a state gets a value: whenever its V, the largest of its estimates, is
    for the first time another than at the start. Once the greedy policy is optimal from the start of an
    episode, it goes on slowly and gets quicker; the last of these speeds stays. In a bandit there is nothing
    to spread: pulls get quicker.
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
        """Begin with what ``run`` has learned so far."""
        self._rests = 0
        self._judged_at = now
        self._count(run)
        if isinstance(run.world.drawing, Arms):
            self._enter(Stage.PULLS, now)
        elif self._has_optimal_policy(run):
            self._enter(Stage.OPTIMAL, now)
        else:
            self._enter(Stage.FIRST_REWARD if self._is_blank(run) else Stage.SPREADING, now)

    @property
    def speed(self) -> float:
        """The wanted speed."""
        return SPEEDS[self._stage][self._rise]

    @property
    def is_over(self) -> bool:
        """Whether nothing is waited for any more: its speed stays."""
        if self._rise < len(SPEEDS[self._stage]) - 1:
            return False
        if self._stage is Stage.SPREADING:
            return not self._has_choices or self._answer().solution is None
        return self._stage in _ENDING

    def stride(self, run: Run, due: int) -> int:
        """Return how many of the steps that are ``due`` to take before looking at ``run`` again."""
        if self._stage in _ENDING or is_large(run.world):
            return due
        return min(due, max(1, int(self.speed) // _LOOKS_A_SECOND))

    def look(self, run: Run, now: float) -> float | None:
        """Look what the last steps of ``run`` changed; return for how long to rest, None if not at all."""
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
        """Get faster if there was nothing new for a while."""
        if now - self._since >= QUIET and self._rise < len(SPEEDS[self._stage]) - 1:
            self._rise, self._since = self._rise + 1, now

    def in_words(self, *, hides_answer: bool) -> str:
        """Return what is waited for; while the answer is hidden nothing of it is told."""
        match self._stage:
            case Stage.FIRST_REWARD:
                return "until the first reward"
            case Stage.SPREADING:
                return f"values in {self._with_value:,} of {len(self._first_pairs):,} states"
            case Stage.OPTIMAL:
                return "nothing new" if hides_answer else "an optimal policy is found"
        return "faster and faster"

    def _enter(self, stage: Stage, now: float) -> None:
        self._stage, self._rise, self._since = stage, 0, now

    def _count(self, run: Run) -> None:
        """Count the states that have a value."""
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
        """Return whether an optimal policy was learned: not if there is none to learn, or nothing was yet."""
        learner, optimum = run.learner, self._answer().solution
        if learner.mdp is None or optimum is None or not (self._has_choices and self._with_value):
            return False
        return is_optimal(learner.mdp, learner.q, learner.hyperparameters.ties, optimum)
