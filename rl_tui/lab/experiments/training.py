"""Training without a screen."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.lab.run.recipe import JournalEntry, TakeAction
from rl_tui.lab.run.run import Run

CHUNK: Final = 2_000_000
# So long an environment that is stepped for real goes on without a word about how far it has come
PATIENCE: Final = 0.2

OnProgress = Callable[[int, int], None]


def no_progress(done: int, wanted: int) -> None:
    """Ignore how far training has come."""


@dataclass(frozen=True, slots=True)
class Goal:
    """When training ends: after so many episodes or so many steps in all."""

    steps: int | None = None
    episodes: int | None = None

    def reached_by(self, run: Run) -> tuple[int, int]:
        """Return how much of it ``run`` has done, and the whole."""
        if self.steps is not None:
            return run.step, self.steps
        return run.learner.episodes, self.episodes or 0


def train(
    run: Run, goal: Goal, on_progress: OnProgress = no_progress, journal: Sequence[JournalEntry] = ()
) -> float:
    """Advance ``run`` to ``goal`` and return the seconds it took, compiling left out.

    Each entry of ``journal``, whose steps ascend, is applied at its step; those beyond the goal are left out.
    A run that is over before, its budget spent or its values converged, goes no further.
    Raises UserError where the run broke down, or a change does not fit.
    """
    run.warm_up()
    start = time.perf_counter()
    run.learner.set_time_budget(PATIENCE)
    waiting = list(journal)
    while True:
        done, wanted = goal.reached_by(run)
        while waiting and waiting[0].step <= run.step and not (done >= wanted and _is_step(waiting[0])):
            before = time.perf_counter()
            run.apply(waiting.pop(0).change)
            run.warm_up()  # another algorithm has a loop of its own
            start += time.perf_counter() - before
            done, wanted = goal.reached_by(run)
        on_progress(done, wanted)
        if done >= wanted or run.over:
            return time.perf_counter() - start
        left = wanted - done
        steps = min(CHUNK, waiting[0].step - run.step) if waiting else CHUNK
        if goal.steps is not None:
            run.advance(min(steps, left))
        else:
            run.advance(steps, left)
        if run.stop_reason:
            raise UserError(f"{run.recipe.scenario.id}: {run.stop_reason}")


def _is_step(entry: JournalEntry) -> bool:
    """Tell whether ``entry`` is a step taken by hand."""
    return isinstance(entry.change, TakeAction)
