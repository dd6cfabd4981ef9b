"""Training under many seeds, in parallel and in batches."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import closing, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Protocol, TextIO, TypeVar

from rl_tui.runs.figures import finite, head, summary
from rl_tui.runs.recipe import JournalEntry, Recipe
from rl_tui.runs.run import OnEpisodes
from rl_tui.runs.training.batched_runs import BatchedRuns, runs_at_once
from rl_tui.runs.training.compile_or_interpret import cores
from rl_tui.runs.training.episode_rows import Listening, episodes_in_order
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

Part = TypeVar("Part")
Result = TypeVar("Result")
RunT = TypeVar("RunT")

LONGEST_GOODBYE: Final = 2.0
"""Seconds that other runs may take to end after one has failed."""


class RunsBySeed(Protocol[RunT]):
    """Runs that differ in their seed, such as `SeededRuns`."""

    first_seed: int
    figures: tuple[str, ...]
    """Names of the numbers in a row."""
    is_bandit: bool
    """True if the world is a bandit, whose optimal actions are counted."""
    plans: bool
    """True if there are sweeps instead of episodes."""

    def new_run(self, seed: int, *on_episodes: OnEpisodes | None) -> RunT:
        """Return a fresh run of `seed`."""
        ...

    def train(self, run: RunT, goal: Goal, on_progress: OnProgress) -> None:
        """Advance `run` to `goal`. `on_progress` may raise to stop."""
        ...

    def row(self, run: RunT) -> dict[str, Any]:
        """Return seed and numbers of `run`."""
        ...


# Training


@dataclass
class Curves:
    """Learning curves over the first `episodes` episodes (0: none), in the order of seeds."""

    episodes: int
    most_bins: int = MOST_BINS
    points: list[CurvePoints] = field(default_factory=list)


class _GivenUpError(Exception):
    """Stops a run after another has failed or the caller has enough rows."""


def rows(
    seeded: RunsBySeed[RunT],
    seeds: range,
    goal: Goal,
    measure: Callable[[RunT], Result],
    measure_batch: Callable[[BatchedRuns, Callable[[], None]], Iterable[Result]] | None = None,
    *,
    curves: Curves | None = None,
    watch: Callable[[RunT | BatchedRuns], OnProgress] = lambda _: no_progress,
    listening: Listening = lambda _: nullcontext(),
    workers: int = 0,
) -> Generator[Result, None, None]:
    """Train under each seed and yield the results in order. Raises UserError for the first broken run.

    Args:
        seeded: Runs to train.
        seeds: Seeds in ascending order.
        goal: End of the training.
        measure: Returns the result of a run, in the training thread.
        measure_batch: Returns the results of a batch with the same bits, and calls its second argument
            between slow parts. None prevents batches.
        curves: Receives the curve of each run.
        watch: Returns the listener for progress, which may raise to stop everything.
        listening: Opens the listener for the episodes of a single run.
        workers: Number of threads; 0 trains each run on request.
    """
    is_ended = threading.Event()
    batched = seeded if measure_batch is not None and isinstance(seeded, SeededRuns) else None
    episodes, most_bins = (0, 0) if curves is None else (curves.episodes, curves.most_bins)

    def check() -> None:
        if is_ended.is_set():
            raise _GivenUpError

    def watched(run: RunT | BatchedRuns) -> OnProgress:
        hear = watch(run)

        def on_progress(done: int, wanted: int) -> None:
            check()
            hear(done, wanted)

        return on_progress

    def trained(part: range) -> tuple[Iterable[Result], list[CurvePoints]]:
        if len(part) > 1 and batched is not None and measure_batch is not None:
            batch = BatchedRuns(batched, part, goal, curve_episodes=episodes, most_bins=most_bins)
            batch.train(watched(batch))
            return measure_batch(batch, check), batch.curves
        curve = RunCurve(episodes, most_bins) if episodes else None
        with listening(part.start) as listener:
            run = seeded.new_run(part.start, listener, curve)
            seeded.train(run, goal, watched(run))
        return [measure(run)], [curve.points] if curve else []

    crew = max(1, min(workers, len(seeds)))
    parts = _parts(seeds, crew, runs_at_once(batched) if batched else 0)
    for found, points in _in_parallel(trained, parts, crew, is_ended) if workers else map(trained, parts):
        if curves is not None:
            curves.points += points
        yield from found


def train_curves(
    seeded: RunsBySeed[RunT],
    seeds: range,
    curves: Curves,
    watch: Callable[[RunT | BatchedRuns], OnProgress] = lambda _: no_progress,
    workers: int = 0,
) -> None:
    """Train again for curves, whose bins are known only when all runs are done."""
    goal = Goal(episodes=curves.episodes)
    measures = _measure_nothing, _measure_no_batch
    for _ in rows(seeded, seeds, goal, *measures, curves=curves, watch=watch, workers=workers):
        pass


def _measure_nothing(run: object) -> None: ...


def _measure_no_batch(batch: BatchedRuns, check: Callable[[], None]) -> Iterable[None]:
    return ()


def _parts(seeds: range, workers: int, at_once: int) -> list[range]:
    runs = len(seeds)
    each = math.ceil(runs / (workers * math.ceil(runs / (workers * at_once)))) if at_once > 1 else 1
    return [seeds[first : first + each] for first in range(0, runs, each)]


def _in_parallel(
    work: Callable[[Part], Result], parts: Sequence[Part], workers: int, is_ended: threading.Event
) -> Iterator[Result]:
    pool = ThreadPoolExecutor(workers, thread_name_prefix="run")
    futures = [pool.submit(work, part) for part in parts]
    try:
        for future in futures:
            wait([future])
            yield future.result()
    except BaseException:
        is_ended.set()
        pool.shutdown(wait=False, cancel_futures=True)
        running = [future for future in futures if not future.cancelled()]  # cancelled ones never finish
        wait(running, LONGEST_GOODBYE)  # do not wait for an environment that does not respond
        raise
    pool.shutdown()


# The document of train --runs --json


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
    """Train with consecutive seeds and return the document of `train --runs --json`.

    `csv` receives one row per episode, in the order of runs. `on_progress` is called from several threads,
    one at a time. Edits of `journal` apply to the world of each seed. Raises UserError.
    """
    seeded = SeededRuns(recipe, journal)
    seeded.get_machine_code(runs, goal, on_compiling)
    return {**head(recipe), **figures_of_runs(seeded, runs, goal, csv, on_progress, workers, most_bins)}


def figures_of_runs(
    seeded: RunsBySeed[RunT],
    runs: int,
    goal: Goal,
    csv: Path | TextIO | None,
    on_progress: OnProgress = no_progress,
    workers: int | None = None,
    most_bins: int = MOST_BINS,
) -> dict[str, Any]:
    """Train `runs` of `seeded` and return the document without its head."""
    seeds, crew = range(seeded.first_seed, seeded.first_seed + runs), workers or cores()
    curves = Curves(0 if seeded.plans else goal.episodes or 0, most_bins)
    wanted = runs * (goal.steps or goal.episodes or 0)
    counting, in_all = threading.Lock(), 0

    def watch(_: object) -> OnProgress:
        counted = 0

        def count(done: int, _: int) -> None:
            nonlocal counted, in_all
            with counting:
                in_all += done - counted
                counted = done
                on_progress(in_all, wanted)

        return count

    start = time.perf_counter()
    found = list[dict[str, Any]]()
    with (
        episodes_in_order(csv, seeds.start) as (listening, hand_on),
        closing(
            rows(
                seeded,
                seeds,
                goal,
                lambda run: finite(seeded.row(run)),
                BatchedRuns.rows if csv is None else None,  # batches do not report single episodes
                curves=curves,
                watch=watch,
                listening=listening,
                workers=crew,
            )
        ) as each,
    ):
        for seed in seeds:
            try:
                found.append(next(each))
            finally:  # also after a failure or an interrupt
                hand_on(seed)
    seconds = time.perf_counter() - start
    curve, fewest = no_curve(seeded.is_bandit), min(row["episodes"] for row in found)
    if fewest and not seeded.plans:  # a planner's sweeps have no returns
        if not curves.episodes:
            curves.episodes = fewest
            train_curves(seeded, seeds, curves, workers=crew)
        curve = mean_curve(curves.points, seeded.is_bandit)
    return {
        "seconds": seconds,
        "steps_per_second": sum(row["steps"] for row in found) / seconds,
        "runs": found,
        "summary": finite({name: summary([row[name] for row in found]) for name in seeded.figures}),
        "curve": finite(curve),
    }
