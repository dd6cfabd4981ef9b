"""Training without a screen."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.lab.experiments.patience import Patience
from rl_tui.lab.run.changes import written_change
from rl_tui.lab.run.recipe import UNLIMITED, JournalEntry
from rl_tui.lab.run.run import Run

# So long an environment that is stepped for real goes on without a word about how far it has come
TIME_BUDGET: Final = 0.2
_LONGEST_ENTRY: Final = 200

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
    start = time.perf_counter()
    patience = Patience()
    run.learner.set_time_budget(TIME_BUDGET)
    until = run.step  # at first no further than to what is set at the very start
    while True:
        with _naming_the_entry(run, journal):
            run.follow(journal, until, UNLIMITED if goal.steps is not None else goal.episodes or 0)
        if run.stop_reason:
            raise UserError(f"{run.recipe.scenario.id}: {run.stop_reason}")
        done, wanted = goal.reached_by(run)
        on_progress(done, wanted)
        start += patience.look(run.learner, done, wanted)
        ahead = journal[len(run.journal) :]
        if done < wanted and run.over and ahead and ahead[0].step <= run.step:
            with _naming_the_entry(run, journal):
                run.apply(ahead[0].change)  # an action after the end, which is refused
        if done >= wanted or run.over:
            return time.perf_counter() - start
        chunk = patience.chunk(run.learner)
        end = run.step + chunk if goal.steps is None else min(run.step + chunk, goal.steps)
        until = min(end, next((entry.step for entry in ahead if entry.step > run.step), end))


@contextmanager
def _naming_the_entry(run: Run, journal: Sequence[JournalEntry]) -> Iterator[None]:
    """Let what is wrong with an entry of ``journal`` name its step and what it changes."""
    try:
        yield
    except UserError as fault:
        entry = journal[len(run.journal)]
        what = one_line(written_change(entry, run.first_actions), _LONGEST_ENTRY)
        raise UserError(f"{what}: {fault}") from fault
