"""The runs of a cell: train every seed, and summarize the results."""

from __future__ import annotations

import math
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.runs.figures import greedy_figures
from rl_tui.runs.measures import Measure, measured_run
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.runs.training.batched_runs import runs_at_once
from rl_tui.runs.training.seeded_runs import TIME_BUDGET
from rl_tui.studies.statistics.censored import arrivals_of
from rl_tui.studies.statistics.intervals import interquartile_mean, summary_of
from rl_tui.studies.sweeps.cell import (
    ARRIVED,
    MEASURES,
    Cell,
    Figures,
    batched_figures,
    figures_of_run,
    loop_in_batches,
    runs_in_batches,
)
from rl_tui.studies.sweeps.cells.content import ExactFacts
from rl_tui.worlds.mdp.space import FloatArray

# When to get machine code


# Renting until it costs as much as buying is at most twice as expensive as the optimum
WORTH_READING: Final = 0.3
WORTH_COMPILING: Final = 2.0


class MachineCodeDemand:
    """Adds up the interpreted time of each loop, and requests machine code in time.

    Cached code is read in the calling thread, other code is compiled in parallel. Safe from several threads.
    """

    def __init__(self) -> None:
        self._seconds: defaultdict[Loop, float] = defaultdict(float)
        self._compiled = list[Loop]()
        self._read = set[Loop]()
        self._lock = threading.Lock()

    def ran(self, loop: Loop, seconds: float) -> None:
        """Add `seconds` of interpreted time."""
        if loop in COMPILED_LOOPS or loop in BACKGROUND.failed:
            return
        with self._lock:
            self._seconds[loop] += seconds
            if self._seconds[loop] >= WORTH_READING and loop not in self._read and was_compiled(loop):
                self._read.add(loop)
                if BACKGROUND.read(loop):
                    return
            if self._seconds[loop] >= WORTH_COMPILING and loop not in self._compiled:
                self._compiled.append(loop)
                BACKGROUND.want(self._compiled)


DEMAND: Final = MachineCodeDemand()
"""The shared instance of this process."""


# One row per seed


NEAR: Final = 0.05
"""Distance to the best that counts as arrival, as a share of best − random."""
GROWTH: Final = 2.0**0.25
LONGEST_REASON: Final = 200
# largest number of steps between two checks, about 0.1 s
_CHUNK: Final = 2_000_000
_CHUNK_INTERPRETED: Final = 10_000

GoOn = Callable[[], None]


@dataclass(frozen=True, slots=True)
class RunRow:
    """The result of one seed of a cell."""

    seed: int
    figures: Figures
    failed: str | None = None
    seconds: float = 0.0
    machine: str | None = field(default=None, compare=False)
    """Machine that made it, or None for this one."""


NO_FIGURES: Final[Figures] = dict.fromkeys((*MEASURES, ARRIVED))


def go_on() -> None:
    """Continue without a check."""


def run_rows(cell: Cell, seeds: Sequence[int], check: GoOn = go_on) -> Iterator[RunRow]:
    """Yield the row of each seed, also of broken runs. `check` may raise to stop."""
    waiting, marks = list(seeds), tuple(marks_up_to(cell.goal.episodes or 0))
    while waiting:
        seeded = runs_in_batches(cell) if len(waiting) > 1 else None
        at_once = waiting[: 1 if seeded is None else max(1, runs_at_once(seeded, len(marks)))]
        waiting = waiting[len(at_once) :]
        if seeded is None or len(at_once) == 1:
            yield _row(cell, at_once[0], check)
            continue
        start = time.perf_counter()
        found = batched_figures(cell, seeded, at_once, marks, _arrival_line(cell.content.facts), check)
        seconds = (time.perf_counter() - start) / len(at_once)
        for seed, figures in zip(at_once, found, strict=True):
            # a run that broke down is repeated alone to find the reason
            yield _row(cell, seed, check) if figures is None else RunRow(seed, figures, None, seconds)


def _row(cell: Cell, seed: int, check: GoOn) -> RunRow:
    start = time.perf_counter()
    try:
        figures, failed = _figures(cell, seed, check), None
    except UserError as reason:
        figures, failed = NO_FIGURES, one_line(str(reason), LONGEST_REASON)
    seconds = time.perf_counter() - start
    loop = loop_in_batches(cell)
    if loop is not None:
        DEMAND.ran(loop, seconds)
    return RunRow(seed, figures, failed, seconds)


def marks_up_to(episodes: int) -> Iterator[int]:
    """Yield the episodes of evaluations: 1, 2, 3, …, growing by 2^(1/4), and the last."""
    mark = 1
    while mark < episodes:
        yield mark
        mark = max(mark + 1, int(mark * GROWTH))
    yield episodes


def _figures(cell: Cell, seed: int, check: GoOn) -> Figures:
    recipe = replace(cell.recipe, seed=seed)
    run = Run(recipe, begin(recipe, cell.content.shared), evaluate=False)
    run.learner.set_time_budget(TIME_BUDGET)
    facts = cell.content.facts if cell.content.shared is not None else ExactFacts(run.world.mdp)
    wanted = cell.goal.episodes or 0
    line = None if run.learner.drifted is not None else _arrival_line(facts)
    arrival = _train(run, wanted, line, check)
    if run.learner.drifted is not None:  # each run has its own drifted means
        facts = ExactFacts(run.learner.mdp)
    check()
    measured = measured_run(run, greedy_figures(run, facts.optimum(recipe.hyperparameters.gamma)))
    if run.learner.plans:
        measured = replace(measured, bandit=None)  # a planner's backups pull no arm
    return figures_of_run(measured, facts.best, line, arrival)


def _arrival_line(facts: ExactFacts) -> float | None:
    if facts.mdp is None or facts.best is None or facts.random is None:
        return None
    return facts.best - NEAR * (facts.best - facts.random)


def _train(run: Run, episodes: int, line: float | None, check: GoOn) -> int | None:
    arrival = None if line is None else _arrival(run, episodes, line, check)
    _advance(run, episodes, check)
    return arrival


def _arrival(run: Run, episodes: int, line: float, check: GoOn) -> int | None:
    for mark in marks_up_to(episodes):
        _advance(run, mark, check)
        earned = run.greedy_return(run.learner.q, run.recipe.hyperparameters.ties)
        if earned is not None and earned >= line:
            return run.learner.episodes
    return None


def _advance(run: Run, episodes: int, check: GoOn) -> None:
    learner = run.learner
    while learner.episodes < episodes and not run.over:
        check()
        start, was_interpreted = time.perf_counter(), not learner.is_compiled
        run.advance(_CHUNK_INTERPRETED if was_interpreted else _CHUNK, episodes - learner.episodes)
        if was_interpreted:
            DEMAND.ran(learner.loop, time.perf_counter() - start)
    if run.stop_reason:
        raise UserError(run.stop_reason)


# Summary of a cell


_EMPTY: Final = dict.fromkeys(("mean", "median", "iqm", "low", "high"))
_NO_ARRIVALS: Final = dict.fromkeys(
    ("share_low", "share_high", "restricted_mean", "restricted_low", "restricted_high")
)


@dataclass(frozen=True)
class CellSummary:
    """Summary of the rows of one cell."""

    runs: int
    """Number of runs, including failed ones."""
    failed: int
    """Number of failed runs."""
    figures: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Mean, median, iqm, low, high and count of each metric."""
    first_failure: str = ""
    """Why the first failed run broke down."""


def values_by_seed(rows: Iterable[RunRow], measure: Measure, seeds: range) -> tuple[FloatArray | None, bool]:
    """Return a metric by seed, `[N]`, NaN if missing, and True if every row has one.

    Runs that never arrive count with their number of episodes. Without rows there are no values.
    """
    values, count = np.full(len(seeds), np.nan), 0
    for row in rows:
        count += 1
        value = _restricted(row) if measure.may_never_arrive else row.figures[measure.id]
        if value is not None and math.isfinite(value):
            values[row.seed - seeds.start] = value
    return (values if count else None), int((~np.isnan(values)).sum()) == count


def summarized(rows: Iterable[RunRow]) -> CellSummary:
    """Summarize the `rows` of one cell."""
    kept = list(rows)
    sound = [row for row in kept if row.failed is None]
    failures = [row.failed for row in kept if row.failed is not None]
    figures = {
        each.id: _arrivals(sound) if each.may_never_arrive else _figure(_values(sound, each.id))
        for each in MEASURES.values()
    }
    return CellSummary(len(kept), len(failures), figures, failures[0] if failures else "")


def _values(rows: Sequence[RunRow], name: str) -> list[float]:
    there = (row.figures[name] for row in rows)
    return [float(value) for value in there if value is not None and math.isfinite(value)]


def _figure(values: Sequence[float]) -> dict[str, Any]:
    found = summary_of(values)
    if found is None:
        return {**_EMPTY, "count": 0}
    return {name: getattr(found, name) for name in (*_EMPTY, "count")}


def _arrivals(rows: Sequence[RunRow]) -> dict[str, Any]:
    """Summarize arrivals, without a mean unless all have arrived."""
    watched = [row for row in rows if row.figures[ARRIVED] is not None]
    times = np.array([row.figures["arrival"] if row.figures[ARRIVED] else np.nan for row in watched], float)
    found = arrivals_of(times, np.array([row.figures["episodes"] for row in watched], float))
    if found is None:
        return {**_EMPTY, "count": 0, "arrived": 0, **_NO_ARRIVALS}
    arrived = times[~np.isnan(times)]
    have_all = len(arrived) == len(times)
    return {
        "mean": found.restricted_mean if have_all else None,
        "median": found.median,
        "iqm": interquartile_mean(arrived) if have_all else None,
        "low": found.low if have_all else None,
        "high": found.high if have_all else None,
        "count": found.count,
        "arrived": len(arrived),
        "share_low": found.share_low,
        "share_high": found.share_high,
        "restricted_mean": found.restricted_mean,
        "restricted_low": found.low,
        "restricted_high": found.high,
    }


def _restricted(row: RunRow) -> float | None:
    """Return min(arrival, episodes) of `row`, or None if unknown."""
    if row.figures[ARRIVED] is None:
        return None
    return row.figures["arrival"] if row.figures[ARRIVED] else row.figures["episodes"]
