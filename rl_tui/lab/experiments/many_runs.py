"""The same training under many seeds, in parallel on the cores."""

from __future__ import annotations

import math
import statistics
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any, Final, TextIO, TypeVar

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.exact.solution import Solution
from rl_tui.common.errors import UserError
from rl_tui.lab.experiments.episode_rows import EpisodeRows, csv_file
from rl_tui.lab.experiments.learning_curve import RunCurve, each_of, mean_curve, no_curve
from rl_tui.lab.experiments.patience import cores, pays, seconds_interpreted
from rl_tui.lab.experiments.training import Goal, OnProgress, no_progress, train
from rl_tui.lab.experiments.whole_file import whole_file
from rl_tui.lab.run.figures import (
    BANDIT_FIGURES,
    exact_world,
    finite,
    greedy_figures,
    head,
    optimum_of,
    pulls,
)
from rl_tui.lab.run.recipe import Recipe, begin
from rl_tui.lab.run.run import OnEpisodes, Run
from rl_tui.worlds.drawing import Arms

Result = TypeVar("Result")

LONGEST_GOODBYE: Final = 2.0

FIGURES: Final = (
    "steps",
    "episodes",
    "value_at_start",
    "expected_return",
    "max_error",
    "return_last_100",
    "length_last_100",
    "first_reward_episode",
)


def no_compiling() -> None:
    """Ignore that runs wait for machine code."""


def many_runs(
    recipe: Recipe,
    runs: int,
    goal: Goal,
    csv: Path | TextIO | None = None,
    on_progress: OnProgress = no_progress,
    workers: int | None = None,
    on_compiling: Callable[[], None] = no_compiling,
) -> dict[str, Any]:
    """Train ``runs`` times, with the seed of ``recipe`` and those that follow, and return what came of it.

    It is the document of ``train --runs --json``. ``csv``, a path or a stream, takes one row an episode, in
    the order of the runs. ``on_progress`` is called from several threads, one at a time; ``on_compiling``
    where they wait for machine code. Raises UserError as one run does.
    """
    experiment = _Experiment(recipe, runs, goal, on_progress, workers or cores(), on_compiling)
    start = time.perf_counter()
    rows = experiment.rows(csv)
    seconds = time.perf_counter() - start
    curve = experiment.curve(min(row["episodes"] for row in rows))
    document: dict[str, Any] = finite(
        {
            **head(recipe),
            "seconds": seconds,
            "steps_per_second": sum(row["steps"] for row in rows) / seconds,
            "runs": rows,
            "summary": {name: summary([row[name] for row in rows]) for name in experiment.figures},
            "curve": curve,
        }
    )
    return document


def summary(values: Sequence[float | None]) -> dict[str, float | int | None]:
    """Return mean, standard error (of n − 1), least, greatest and number of the values that are there."""
    there = [value for value in values if value is not None and math.isfinite(value)]
    count = len(there)
    return {
        "mean": statistics.fmean(there) if there else None,
        "stderr": statistics.stdev(there) / math.sqrt(count) if count > 1 else None,
        "min": min(there, default=None),
        "max": max(there, default=None),
        "count": count,
    }


class _GivenUpError(Exception):
    """Another run failed or the user broke off: this one need not go on."""


class _Experiment:
    """The runs and what they share: a world that no seed shapes, and its exact answer."""

    def __init__(
        self,
        recipe: Recipe,
        runs: int,
        goal: Goal,
        on_progress: OnProgress,
        workers: int,
        on_compiling: Callable[[], None],
    ) -> None:
        self._recipes = [replace(recipe, seed=recipe.seed + index) for index in range(runs)]
        self._goal = goal
        self._on_progress = on_progress
        self._workers = min(workers, runs)
        self._lock = threading.Lock()
        self._given_up = False
        self._done = [0] * runs
        self._curves: list[RunCurve | None] = [None] * runs
        first = Run(recipe, evaluate=False)
        self._planner = first.learner.plans
        self._bandit = isinstance(first.world.drawing, Arms)
        self._world = None if recipe.scenario.section.drawn_from_seed else first.world
        # Where the world drifts, each run comes to other means, and so to another exact answer
        self._shared = self._world is not None and first.learner.drifted is None
        self._optimum = self._optimum_of(first) if self._shared else None
        # Interpreted, all runs together have one core. An environment that is stepped is not tried: it may do
        # anything, and takes most of the time itself
        wanted, by_episodes = goal.steps or goal.episodes or 0, goal.steps is None
        if first.learner.rewindable:
            seconds = runs * seconds_interpreted(first.learner, wanted, episodes=by_episodes)
            if pays(first.learner.loop, seconds):
                on_compiling()
                BACKGROUND.get(first.learner.loop)

    @property
    def figures(self) -> tuple[str, ...]:
        """The names of a run's figures."""
        return (*FIGURES, *BANDIT_FIGURES) if self._bandit else FIGURES

    def rows(self, csv: Path | TextIO | None) -> list[dict[str, Any]]:
        """Train every run to the goal and return its figures."""
        with ExitStack() as stack:
            if csv is None:
                return self._in_parallel(lambda index: self._row(index, None), lambda index: None)
            target = stack.enter_context(csv_file(csv))
            parts = Path(stack.enter_context(TemporaryDirectory()))

            def append(index: int) -> None:
                part = parts / str(index)
                if part.exists():  # or it could not even begin
                    with part.open(encoding="utf-8", newline="") as rows:
                        copyfileobj(rows, target)
                    part.unlink()

            return self._in_parallel(lambda index: self._row(index, parts / str(index)), append)

    def curve(self, episodes: int) -> dict[str, list[Any]]:
        """Return the mean curve over the first ``episodes`` episodes, which every run has finished.

        How wide its bins are shows only when all runs are done, if these were given a number of steps: then
        they are simply done once more, since the same recipe gives the same episodes, in no memory to speak
        of. The sweeps of a planner have no returns, and so no curve.
        """
        if episodes == 0 or self._planner:
            return no_curve(self._bandit)
        if any(curve is None for curve in self._curves):
            self._goal = Goal(episodes=episodes)
            self._on_progress = no_progress
            self._in_parallel(self._train, lambda index: None)
        return mean_curve([curve for curve in self._curves if curve is not None], self._bandit)

    def _in_parallel(self, work: Callable[[int], Result], on_done: Callable[[int], None]) -> list[Result]:
        """Return ``work`` of every run, in order; ``on_done`` is called in order too, as soon as may be.

        Where a run fails, or the user breaks off, ``on_done`` is called for it too before that is raised.
        """
        results = []
        handed_on = 0
        pool = ThreadPoolExecutor(self._workers, thread_name_prefix="run")
        futures = [pool.submit(work, index) for index in range(len(self._recipes))]
        try:
            for index, future in enumerate(futures):
                wait([future])
                handed_on = index + 1
                on_done(index)
                results.append(future.result())
        except BaseException as error:
            self._given_up = True
            pool.shutdown(wait=False, cancel_futures=True)
            wait(futures, LONGEST_GOODBYE)  # an environment that does not answer is not waited for
            is_waiting = handed_on == len(results) < len(futures)  # or it was in the middle of handing on
            if isinstance(error, KeyboardInterrupt) and is_waiting and futures[handed_on].done():
                on_done(handed_on)
            raise
        pool.shutdown()
        return results

    def _row(self, index: int, part: Path | None) -> dict[str, Any]:
        if part is None:
            run = self._train(index)
        else:
            with whole_file(part) as stream:
                run = self._train(index, EpisodeRows(stream, index + 1))
        optimum = self._optimum if self._shared else self._optimum_of(run)
        exact = greedy_figures(run, optimum)
        mean_return, mean_length = run.history.last_100
        return {
            "seed": run.recipe.seed,
            "steps": run.step,
            "episodes": run.learner.episodes,
            "value_at_start": exact.value_at_start,
            "expected_return": exact.expected_return,
            "max_error": exact.max_error,
            "return_last_100": mean_return,
            "length_last_100": mean_length,
            "first_reward_episode": run.learner.first_reward_episode or None,
            **pulls(run),
        }

    def _train(self, index: int, *also: OnEpisodes) -> Run:
        recipe = self._recipes[index]
        beginning = begin(recipe, self._world)
        curve = None
        if self._goal.episodes and not self._planner:
            curve = self._curves[index] = RunCurve(self._goal.episodes)
        run = Run(recipe, beginning, evaluate=False, on_episodes=each_of(*also, curve))
        try:
            train(run, self._goal, partial(self._note_progress, index))
        except UserError as error:
            raise UserError(f"seed {recipe.seed}: {error}") from error
        return run

    def _note_progress(self, index: int, done: int, wanted: int) -> None:
        if self._given_up:
            raise _GivenUpError
        with self._lock:
            self._done[index] = done
            self._on_progress(sum(self._done), wanted * len(self._done))

    @staticmethod
    def _optimum_of(run: Run) -> Solution | None:
        return optimum_of(exact_world(run), run.recipe.hyperparameters.gamma)
