"""The work of a study of many seeds, reported block by block."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.common.words import counted
from rl_tui.runs.background.child import let_others_go_first
from rl_tui.runs.figures import finite, summary
from rl_tui.runs.run import Run
from rl_tui.runs.training.batched_runs import BatchedRuns, runs_at_once
from rl_tui.runs.training.many_runs import Curves, rows, train_curves
from rl_tui.runs.training.seeded_runs import Goal, OnProgress, SeededRuns, mean_curve, no_compiling
from rl_tui.studies.many_seeds.figures import (
    Estimate,
    LaneStudy,
    PairedDifference,
    SeedCurve,
    SeedStudy,
    StudyState,
)
from rl_tui.studies.many_seeds.request import FIRST_BLOCK, MOST_STEPS, StudiedRun, StudyRequest
from rl_tui.worlds.world import World

# Means and paired differences


Row = Mapping[str, Any]


def estimate_of(values: Iterable[float | None]) -> Estimate | None:
    """Return the mean of the known values, or None."""
    found = summary(list(values))
    mean, count = found["mean"], found["count"]
    return None if mean is None or count is None else Estimate(mean, found["stderr"], int(count))


def difference_of(shown: Sequence[float | None], other: Sequence[float | None]) -> PairedDifference | None:
    """Return `shown` minus `other`, seed by seed, or None."""
    pairs = [(a, b) for a, b in zip(shown, other, strict=True) if a is not None and b is not None]
    mean = estimate_of(a - b for a, b in pairs)
    if mean is None:
        return None
    return PairedDifference(mean, sum(a > b for a, b in pairs), sum(a == b for a, b in pairs))


def estimates_of(rows: Sequence[Row], names: Iterable[str]) -> dict[str, Estimate]:
    """Return the mean over `rows` of each number that exists."""
    found = {name: estimate_of(row[name] for row in rows) for name in names}
    return {name: estimate for name, estimate in found.items() if estimate is not None}


def differences_of(
    shown: Sequence[Row], other: Sequence[Row], names: Iterable[str]
) -> dict[str, PairedDifference]:
    """Return `difference_of` for each number that both runs have."""
    found = {
        name: difference_of([row[name] for row in shown], [row[name] for row in other]) for name in names
    }
    return {name: difference for name, difference in found.items() if difference is not None}


# The training


MOST_SECONDS: Final = 60.0
"""CPU-time limit of a study in seconds, without compilation."""
BATCHED_BELOW: Final = 100_000
"""Steps of a seed above which batches save no time."""
COLLECTED_ABOVE: Final = 10_000
"""Pairs above which a finished run is freed at once, because its parts form cycles."""


class _TooLongError(Exception):
    """A seed needs too many steps to finish its episodes."""


class _OutOfTimeError(Exception):
    """The study has used its CPU time."""


def work(request: StudyRequest, tell: Callable[[SeedStudy, float], None]) -> None:
    """Compute the study, with low priority once machine code is ready."""
    study = Study(request)
    if study.has_machine_code and not request.is_awaited:
        let_others_go_first()
    study.get_machine_code()
    if not request.is_awaited:
        let_others_go_first()
    for report in study.reports():
        tell(report, report.seeds / report.most)


class Study:
    """Computes the study for `request`. `clock` returns CPU seconds. Raises UserError."""

    def __init__(self, request: StudyRequest, clock: Callable[[], float] = time.process_time) -> None:
        start = clock()
        self._clock = clock
        self._request = request
        self._goal = Goal(steps=request.steps, episodes=request.episodes)
        self._lanes: list[_Lane] = []
        for lane in request.lanes:
            known = self._lanes[0].runs.first.world if self._lanes else None
            self._lanes.append(_Lane(lane, known))
        self._study = request.nothing_yet
        self._spent = clock() - start

    @property
    def has_machine_code(self) -> bool:
        """True if machine code for the first loops is cached."""
        return all(was_compiled(lane.runs.first.learner.loop) for lane in self._lanes)

    def get_machine_code(self) -> None:
        """Compile the loops that run long enough."""
        for lane in self._lanes:
            lane.runs.get_machine_code(self._request.most, self._goal, no_compiling)

    def reports(self) -> Iterator[SeedStudy]:
        """Yield the study after 8, 16, 32, … seeds. Raises UserError.

        It ends after 60 s, including worlds but not compilation.
        """
        end = self._clock() + MOST_SECONDS - self._spent

        def check() -> None:
            if self._clock() >= end:
                raise _OutOfTimeError

        try:
            yield from self._blocks(check)
        except _OutOfTimeError:
            yield self._ended_early()

    def _blocks(self, check: Callable[[], None]) -> Iterator[SeedStudy]:
        try:
            yield from self._blocks_of_goal(check)
        except _TooLongError:
            self._goal = Goal(steps=MOST_STEPS)
            episodes = counted(self._request.episodes or 0, "episode")
            why = f"each seed ends after {MOST_STEPS:,} steps, because one needs more for {episodes}"
            self._study = replace(
                self._study,
                state=StudyState.RUNNING,
                lanes=(),
                seeds=0,
                episodes=None,
                steps=MOST_STEPS,
                message="; ".join(filter(None, (self._request.message, why))),
            )
            yield self._study
            for lane in self._lanes:
                lane.begin_anew()
            yield from self._blocks_of_goal(check)

    def _blocks_of_goal(self, check: Callable[[], None]) -> Iterator[SeedStudy]:
        seeds, block = 0, FIRST_BLOCK
        while seeds < self._request.most:
            while seeds < block:
                at_once = min(block - seeds, *(lane.seeds_at_once for lane in self._lanes))
                for lane in self._lanes:
                    lane.add_seeds(at_once, self._goal, check)
                seeds += at_once
            for lane in self._lanes:
                lane.complete_curve(self._goal, check)
            block = min(2 * block, self._request.most)
            is_last = seeds == self._request.most
            yield self._tell(seeds, StudyState.DONE if is_last else StudyState.RUNNING)

    def _ended_early(self) -> SeedStudy:
        """Return the last complete block, or else the seeds that every run has finished."""
        seeds = min(len(lane.rows) for lane in self._lanes)
        if seeds < 2:
            return replace(
                self._study,
                state=StudyState.OUT_OF_TIME,
                message=f"{MOST_SECONDS:.0f} s of processor time were not enough for 2 seeds",
            )
        if self._study.seeds:
            return replace(self._study, state=StudyState.OUT_OF_TIME)
        return self._tell(seeds, StudyState.OUT_OF_TIME)

    def _tell(self, seeds: int, state: StudyState) -> SeedStudy:
        shown = self._lanes[self._request.shown]
        self._study = replace(
            self._study,
            state=state,
            seeds=seeds,
            lanes=tuple(lane.study(seeds, None if lane is shown else shown) for lane in self._lanes),
        )
        return self._study


def _bounding(check: Callable[[], None]) -> Callable[[Run | BatchedRuns], OnProgress]:
    def watch(run: Run | BatchedRuns) -> OnProgress:
        def on_progress(done: int, wanted: int) -> None:
            check()
            if run.step > MOST_STEPS:
                raise _TooLongError

        return on_progress

    return watch


class _Lane:
    def __init__(self, lane: StudiedRun, known: World | None) -> None:
        self.runs = SeededRuns(lane.recipe, lane.journal, known)
        self.rows: list[Row] = []
        self._curves = Curves(0)
        self._plans = lane.plans

    def begin_anew(self) -> None:
        self.rows, self._curves = [], Curves(0)

    @property
    def seeds_at_once(self) -> int:
        """Number of seeds to train together: one until it is known that none takes long."""
        is_quick = bool(self.rows) and self.rows[0]["steps"] <= BATCHED_BELOW
        return max(1, runs_at_once(self.runs)) if is_quick else 1

    def add_seeds(self, count: int, goal: Goal, check: Callable[[], None]) -> None:
        if goal.episodes is not None and not self._plans:
            self._curves.episodes = goal.episodes
        first = self.runs.first_seed + len(self.rows)
        self.rows += rows(
            self.runs,
            range(first, first + count),
            goal,
            lambda run: self.runs.row(run, check),
            lambda batch, _: batch.rows(check),
            curves=self._curves,
            watch=_bounding(check),
        )
        if self.runs.first.world.space.pairs > COLLECTED_ABOVE:
            gc.collect()
        check()

    def complete_curve(self, goal: Goal, check: Callable[[], None]) -> None:
        """Train again for the curve if a number of steps ends each seed: its bins are known only now."""
        if self._curves.episodes or goal.episodes is not None or self._plans:
            return
        self._curves.episodes = min(row["episodes"] for row in self.rows)
        if self._curves.episodes:
            seeds = range(self.runs.first_seed, self.runs.first_seed + len(self.rows))
            train_curves(self.runs, seeds, self._curves, watch=_bounding(check))

    def study(self, seeds: int, shown: _Lane | None) -> LaneStudy:
        rows, names = self.rows[:seeds], self.runs.figures
        common = [] if shown is None else [name for name in names if name in shown.runs.figures]
        return LaneStudy(
            estimates=estimates_of(rows, names),
            this_seed={name: finite(rows[0][name]) for name in names},
            differences=differences_of(shown.rows[:seeds] if shown else rows, rows, common),
            curve=self._mean_curve(rows),
            seeds={
                name: np.array([row[name] for row in rows if finite(row[name]) is not None]) for name in names
            },
        )

    def _mean_curve(self, rows: Sequence[Row]) -> SeedCurve:
        if len(self._curves.points) < len(rows):
            return SeedCurve()
        curve = mean_curve(self._curves.points[: len(rows)], self.runs.is_bandit)
        episode = np.array(curve["episode"], np.int64)
        whole = episode <= min(row["episodes"] for row in rows)  # a later seed may have fewer episodes
        mean, stderr = np.array(curve["return_mean"]), np.array(curve["return_stderr"])
        return SeedCurve(episode[whole], mean[whole], stderr[whole])
