"""The limit of steps in the check of a lesson file."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.errors import complaint
from rl_tui.lessons.figures.expression import FigureError
from rl_tui.runs.recipe import JournalEntry, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.runs.training.batched_runs import BatchedRuns
from rl_tui.runs.training.seeded_runs import Goal, OnProgress

FIGURE_STEPS: Final = 1_000_000_000
"""Limit for all runs of one figure."""
FILE_STEPS: Final = 4_000_000_000
"""Limit for all runs of a file, including attempts at tasks."""
STEPPED: Final = 100
"""Weight of one step of a simulated environment, which takes longer."""
_PLANNING: Final = "planning_steps"

WatchRun = Callable[[Run | BatchedRuns], OnProgress]
"""Returns the callback that counts the steps of a current run."""


class StepBudgetError(Exception):
    """The requested steps, and the limit."""

    def __init__(self, found: str, expected: str) -> None:
        self.found, self.expected = found, expected
        super().__init__(complaint(found, expected))


class _SpentError(Exception):
    pass


class StepBudget:
    """Counts the steps of all runs for one file, and ends runs above the limits.

    The result depends only on the file, not on time or the order of threads.
    """

    def __init__(self, figure: int = FIGURE_STEPS, file: int = FILE_STEPS) -> None:
        self._most_of_figure, self._most = figure, file
        self._under_way: list[str] = []
        self.of_figures = Counter[str]()
        """Steps so far for each figure."""
        self.taken = 0
        """Steps so far in all."""

    @contextmanager
    def of_figure(self, name: str) -> Iterator[None]:
        """Count runs meanwhile for this figure only. Raises FigureError at too many steps."""
        self._under_way.append(name)
        try:
            yield
        except StepBudgetError as fault:
            raise FigureError(fault.found, fault.expected) from None
        finally:
            self._under_way.pop()

    @contextmanager
    def counted(
        self, first: Run, journal: Sequence[JournalEntry], goal: Goal, runs: int
    ) -> Iterator[WatchRun]:
        """Count runs like `first`, and yield a function that must watch each.

        Failed runs count with all steps of their goal, or with the steps taken for a goal in episodes. Raises
        StepBudgetError, for a goal in steps before the first.
        """
        weight, left = _weight(first, journal), self._left
        asked = (goal.steps or 0) * runs * weight
        if asked > left:
            raise self._refusal(f"{asked:,}")
        counting, total = threading.Lock(), 0

        def watch(run: Run | BatchedRuns) -> OnProgress:
            counted = 0

            def on_progress(done: int, wanted: int) -> None:
                nonlocal counted, total
                with counting:
                    total += (run.step - counted) * weight
                    counted = run.step
                    if total > left:
                        raise _SpentError

            return on_progress

        is_whole = False
        try:
            yield watch
            is_whole = True
        except _SpentError:
            raise self._refusal(f"more than {left:,}") from None
        finally:
            self._spend(min(total if is_whole else max(asked, total), left))

    def charge(self, run: Run, most: int) -> None:
        """Count at most `most` steps of a finished run. Raises StepBudgetError."""
        asked, left = min(run.step, most) * _weight(run, run.journal), self._left
        refusal = self._refusal(f"{asked:,}")
        self._spend(min(asked, left))
        if asked > left:
            raise refusal

    def check_any_left(self) -> None:
        """Raise StepBudgetError if no step is left."""
        if self._left <= 0:
            raise self._refusal("one more")

    @property
    def _left(self) -> int:
        left = self._most - self.taken
        if not self._under_way:
            return left
        return min(left, self._most_of_figure - self.of_figures[self._under_way[-1]])

    def _spend(self, steps: int) -> None:
        self.taken += steps
        self.of_figures.update(dict.fromkeys(self._under_way[-1:], steps))

    def _refusal(self, asked: str) -> StepBudgetError:
        figure = f" of figure {self._under_way[-1]}" if self._under_way else ""
        left, expected = self._most - self.taken, f"at most {self._most_of_figure:,} steps in a figure"
        if self._left == left:
            expected = f"at most {self._most:,} steps in a file, of which {left:,} are left"
        return StepBudgetError(f"{asked} steps{figure}", expected)


def _weight(run: Run, journal: Sequence[JournalEntry]) -> int:
    """Return the weight of one step. Each planning step counts as one more."""
    algorithms, planning = [run.recipe.algorithm], [run.recipe.hyperparameters.planning_steps]
    for entry in journal:
        match entry.change:
            case SwitchAlgorithm(algorithm=algorithm):
                algorithms.append(algorithm)
            case SetParameter(name=name, value=value) if name == _PLANNING:
                planning.append(int(value))
    plans = any(_PLANNING in BY_ID[each].parameters for each in algorithms)
    return (1 + max(planning) * plans) * (1 if run.learner.rewindable else STEPPED)
