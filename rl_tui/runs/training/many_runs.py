"""The same training under many seeds, in parallel on the cores."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any, Final, Generic, Protocol, TextIO, TypeVar

from rl_tui.common.files import whole_file
from rl_tui.runs.figures import finite, head, summary
from rl_tui.runs.recipe import JournalEntry, Recipe
from rl_tui.runs.run import OnEpisodes
from rl_tui.runs.training.batched_runs import BatchedRuns, runs_at_once
from rl_tui.runs.training.compile_or_interpret import cores
from rl_tui.runs.training.episode_rows import EpisodeRows, csv_file
from rl_tui.runs.training.seeded_runs import (
    MOST_BINS,
    CurvePoints,
    Goal,
    OnProgress,
    RunCurve,
    SeededRuns,
    mean_curve,
    no_compiling,
    no_curve,
    no_progress,
)

Result = TypeVar("Result")
RunT = TypeVar("RunT")

LONGEST_GOODBYE: Final = 2.0


def many_runs(
    recipe: Recipe,
    runs: int,
    goal: Goal,
    csv: Path | TextIO | None = None,
    on_progress: OnProgress = no_progress,
    workers: int | None = None,
    on_compiling: Callable[[], None] = no_compiling,
    journal: Sequence[JournalEntry] = (),
    most_bins: int = MOST_BINS,
) -> dict[str, Any]:
    """Train ``runs`` times, with the seed of ``recipe`` and those that follow, and return what came of it.

    It is the document of ``train --runs --json``. ``csv``, a path or a stream, takes one row an episode, in
    the order of the runs. ``on_progress`` is called from several threads, one at a time; ``on_compiling``
    where they wait for machine code. Each of them applies ``journal`` at its steps, a change of the world to
    the one that its own seed drew. The mean curve has at most ``most_bins`` bins. Raises UserError as one
    run does.
    """
    seeded = SeededRuns(recipe, journal)
    seeded.get_machine_code(runs, goal, on_compiling)
    batched = seeded if csv is None else None  # a row an episode is what a batch does without
    figures = figures_of_runs(seeded, runs, goal, csv, on_progress, workers, batched, most_bins)
    return {**head(recipe), **figures}


class RunsBySeed(Protocol[RunT]):
    """Runs of anything that learns, which differ in their seed, as :class:`SeededRuns` has them."""

    @property
    def first_seed(self) -> int:
        """The seed of the first of them."""
        ...

    @property
    def figures(self) -> tuple[str, ...]:
        """The names of a run's figures."""
        ...

    @property
    def is_bandit(self) -> bool:
        """Whether their world is a bandit, whose optimal actions are counted."""
        ...

    @property
    def plans(self) -> bool:
        """Whether they have no episodes, but sweeps."""
        ...

    def new_run(self, seed: int, *on_episodes: OnEpisodes | None) -> RunT:
        """Return the run of ``seed``, not trained; each of ``on_episodes`` hears of its episodes."""
        ...

    def train(self, run: RunT, goal: Goal, on_progress: OnProgress) -> None:
        """Advance ``run`` to ``goal``; ``on_progress`` may raise to end it."""
        ...

    def row(self, run: RunT) -> dict[str, Any]:
        """Return the seed and the figures of ``run``."""
        ...


def figures_of_runs(
    seeded: RunsBySeed[RunT],
    runs: int,
    goal: Goal,
    csv: Path | TextIO | None,
    on_progress: OnProgress = no_progress,
    workers: int | None = None,
    batched: SeededRuns | None = None,
    most_bins: int = MOST_BINS,
) -> dict[str, Any]:
    """Train ``runs`` of ``seeded`` and return what came of it: the document without its head.

    ``batched`` are the same runs, where they are to be trained in batches if they can. The rest is as for
    :func:`many_runs`.
    """
    experiment = _Experiment(seeded, runs, goal, on_progress, workers or cores(), batched, most_bins)
    start = time.perf_counter()
    rows = experiment.rows(csv)
    seconds = time.perf_counter() - start
    curve = experiment.curve(min(row["episodes"] for row in rows))
    return {
        "seconds": seconds,
        "steps_per_second": sum(row["steps"] for row in rows) / seconds,
        "runs": rows,
        "summary": finite({name: summary([row[name] for row in rows]) for name in seeded.figures}),
        "curve": finite(curve),
    }


class _GivenUpError(Exception):
    """Another run failed or the user broke off: this one need not go on."""


class _Experiment(Generic[RunT]):
    """The runs, in parallel."""

    def __init__(
        self,
        seeded: RunsBySeed[RunT],
        runs: int,
        goal: Goal,
        on_progress: OnProgress,
        workers: int,
        batched: SeededRuns | None,
        most_bins: int,
    ) -> None:
        self._runs = seeded
        self._batched = batched
        self._parts = _parts(runs, min(workers, runs), runs_at_once(batched) if batched else 0)
        self._count = runs
        self._goal = goal
        self._on_progress = on_progress
        self._workers = min(workers, len(self._parts))
        self._most_bins = most_bins
        self._lock = threading.Lock()
        self._given_up = False
        self._done = [0] * len(self._parts)
        self._curves: list[CurvePoints | None] = [None] * len(self._parts)

    def rows(self, csv: Path | TextIO | None) -> list[dict[str, Any]]:
        """Train every run to the goal and return its figures."""
        with ExitStack() as stack:
            if csv is None:
                found = self._in_parallel(self._rows_of_part, lambda part: None)
                return [row for rows in found for row in rows]
            target = stack.enter_context(csv_file(csv))
            parts = Path(stack.enter_context(TemporaryDirectory()))

            def append(index: int) -> None:
                part = parts / str(index)
                if part.exists():  # or it could not even begin
                    with part.open(encoding="utf-8", newline="") as rows:
                        copyfileobj(rows, target)
                    part.unlink()

            return self._in_parallel(lambda index: self._written_row(index, parts / str(index)), append)

    def curve(self, episodes: int) -> dict[str, list[Any]]:
        """Return the mean curve over the first ``episodes`` episodes, which every run has finished.

        How wide its bins are shows only when all runs are done, if these were given a number of steps: then
        they are simply done once more, since the same recipe gives the same episodes, in no memory to speak
        of. The sweeps of a planner have no returns, and so no curve.
        """
        if episodes == 0 or self._runs.plans:
            return no_curve(self._runs.is_bandit)
        if any(curve is None for curve in self._curves):
            self._goal = Goal(episodes=episodes)
            self._on_progress = no_progress
            self._in_parallel(self._train, lambda part: None)
        return mean_curve([curve for curve in self._curves if curve is not None], self._runs.is_bandit)

    def _in_parallel(self, work: Callable[[int], Result], on_done: Callable[[int], None]) -> list[Result]:
        """Return ``work`` of every part, in order; ``on_done`` is called in order too, as soon as may be.

        Where one fails, or the user breaks off, ``on_done`` is called for it too before that is raised.
        """
        results = []
        handed_on = 0
        pool = ThreadPoolExecutor(self._workers, thread_name_prefix="run")
        futures = [pool.submit(work, index) for index in range(len(self._parts))]
        try:
            for index, future in enumerate(futures):
                wait([future])
                handed_on = index + 1
                on_done(index)
                results.append(future.result())
        except BaseException as error:
            self._given_up = True
            pool.shutdown(wait=False, cancel_futures=True)
            running = [future for future in futures if not future.cancelled()]  # to wait, those are not done
            wait(running, LONGEST_GOODBYE)  # an environment that does not answer is not waited for
            is_waiting = handed_on == len(results) < len(futures)  # or it was in the middle of handing on
            if isinstance(error, KeyboardInterrupt) and is_waiting and futures[handed_on].done():
                on_done(handed_on)
            raise
        pool.shutdown()
        return results

    def _written_row(self, index: int, part: Path) -> dict[str, Any]:
        with whole_file(part) as stream:
            row: dict[str, Any] = finite(
                self._runs.row(self._train_one(index, EpisodeRows(stream, index + 1)))
            )
        return row

    def _rows_of_part(self, part: int) -> list[dict[str, Any]]:
        trained = self._train(part)
        if isinstance(trained, BatchedRuns):
            return trained.rows(self._check)
        return [finite(self._runs.row(trained))]

    def _train(self, part: int) -> RunT | BatchedRuns:
        indices = self._parts[part]
        if self._batched is None or len(indices) == 1:
            return self._train_one(part)
        seeds = [self._runs.first_seed + index for index in indices]
        runs = BatchedRuns(
            self._batched,
            seeds,
            self._goal,
            curve_episodes=self._goal.episodes or 0,
            most_bins=self._most_bins,
        )
        runs.train(partial(self._note_progress, part))
        if self._goal.episodes:
            self._curves[part] = runs.curves
        return runs

    def _train_one(self, part: int, *also: OnEpisodes) -> RunT:
        curve = None
        if self._goal.episodes and not self._runs.plans:
            curve = RunCurve(self._goal.episodes, self._most_bins)
        run = self._runs.new_run(self._runs.first_seed + self._parts[part].start, *also, curve)
        self._runs.train(run, self._goal, partial(self._note_progress, part))
        if curve is not None:
            self._curves[part] = curve.points
        return run

    def _check(self) -> None:
        if self._given_up:
            raise _GivenUpError

    def _note_progress(self, part: int, done: int, _: int) -> None:
        self._check()
        with self._lock:
            self._done[part] = done
            wanted = (self._goal.steps or self._goal.episodes or 0) * self._count
            self._on_progress(sum(self._done), wanted)


def _parts(runs: int, workers: int, at_once: int) -> list[range]:
    """Return so many ``runs`` in parts of one run, or about equal ones of at most ``at_once``."""
    each = math.ceil(runs / (workers * math.ceil(runs / (workers * at_once)))) if at_once > 1 else 1
    return [range(first, min(first + each, runs)) for first in range(0, runs, each)]
