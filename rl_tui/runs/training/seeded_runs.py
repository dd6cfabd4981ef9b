"""Training of one run, or of runs that differ only in their seed."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.batches.batch import batching_of
from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.agents.kernels.episode_bins import CurveSums, collect
from rl_tui.agents.kernels.machine_code import Loop, fastest
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.runs.changes import written_change
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.figures import exact_world, greedy_figures, optimum_of, row_of, world_digest
from rl_tui.runs.measures import BANDIT_FIGURES, FIGURES, measured_run
from rl_tui.runs.recipe import UNLIMITED, JournalEntry, Recipe, WorldChange, begin
from rl_tui.runs.run import OnEpisodes, Run, each_of
from rl_tui.runs.training.compile_or_interpret import Patience, batching_pays, pays, seconds_interpreted
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

# Training one run


# longest time between two progress reports of a simulated environment
TIME_BUDGET: Final = 0.2
_LONGEST_ENTRY: Final = 200

OnProgress = Callable[[int, int], None]


def no_progress(done: int, wanted: int) -> None:
    """Ignore progress."""


@dataclass(frozen=True, slots=True)
class Goal:
    """The end of training: steps or episodes in all."""

    steps: int | None = None
    episodes: int | None = None

    def reached_by(self, run: Run) -> tuple[int, int]:
        """Return how much of the goal is reached, and the whole."""
        if self.steps is not None:
            return run.step, self.steps
        return run.learner.episodes, self.episodes or 0


def train(
    run: Run, goal: Goal, on_progress: OnProgress = no_progress, journal: Sequence[JournalEntry] = ()
) -> float:
    """Train `run` until `goal` and return the seconds without compilation.

    Changes in `journal` beyond the goal are ignored. `on_progress` gets (done, wanted). Raises UserError.
    """
    start = time.perf_counter()
    patience = Patience()
    run.learner.set_time_budget(TIME_BUDGET)
    until = run.step  # begin with settings at the start only
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
                run.apply(ahead[0].change)  # an action after the end, which raises
        if done >= wanted or run.over:
            return time.perf_counter() - start
        chunk = patience.chunk(run.learner)
        end = run.step + chunk if goal.steps is None else min(run.step + chunk, goal.steps)
        until = min(end, next((entry.step for entry in ahead if entry.step > run.step), end))


@contextmanager
def _naming_the_entry(run: Run, journal: Sequence[JournalEntry]) -> Iterator[None]:
    try:
        yield
    except UserError as fault:
        entry = journal[len(run.journal)]
        what = one_line(written_change(entry, run.first_actions), _LONGEST_ENTRY)
        raise UserError(f"{what}: {fault}") from fault


# The mean learning curve


MOST_BINS: Final = 200


class CurvePoints(NamedTuple):
    """The learning curve of a run in B bins, `[B]`.

    `returns` (undiscounted) and `lengths` are means, `optimal` is the share of optimal actions.
    """

    last_episode: IntArray
    returns: FloatArray
    lengths: FloatArray
    optimal: FloatArray


def width_of_bins(episodes: int, most_bins: int = MOST_BINS) -> int:
    """Return the episodes in each of at most `most_bins` bins."""
    return math.ceil(episodes / most_bins)


class RunCurve:
    """Collects the learning curve over the first `episodes` episodes."""

    def __init__(self, episodes: int, most_bins: int = MOST_BINS) -> None:
        self.episodes = episodes
        self.width = width_of_bins(episodes, most_bins)
        bins = math.ceil(episodes / self.width)
        self.last_episode = np.minimum(np.arange(1, bins + 1) * self.width, episodes)
        self.sums = CurveSums(np.zeros(bins), np.zeros(bins, np.int64), np.zeros(bins, np.int64))
        self._done = 0

    def __call__(self, returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        """Add the next episodes, `[n]` each, up to the end."""
        part = slice(0, self.episodes - self._done)
        fastest(collect)(self.sums, self.width, self._done, returns[part], lengths[part], optimal[part])
        self._done = min(self.episodes, self._done + len(returns))

    @property
    def points(self) -> CurvePoints:
        """The curve."""
        count = np.diff(self.last_episode, prepend=0)
        return CurvePoints(self.last_episode, *(sums / count for sums in self.sums))


def curve_of_run(
    run: Run, curve: RunCurve | None, on_progress: OnProgress = no_progress
) -> dict[str, list[Any]]:
    """Return the learning curve of a finished `run`, empty for a planner.

    Without a `curve` that listened, the same episodes are trained again. Raises UserError.
    """
    bandit, episodes = run.world.is_bandit, run.learner.episodes
    if run.learner.plans or episodes == 0:
        return no_curve(bandit)
    if curve is None:
        curve = RunCurve(episodes)
        again = Run(run.recipe, begin(run.recipe), evaluate=False, on_episodes=curve)
        train(again, Goal(episodes=episodes), on_progress, run.journal)
    return mean_curve([curve.points], bandit)


def mean_curve(curves: Sequence[CurvePoints], bandit: bool) -> dict[str, list[Any]]:
    """Average `curves` with equal bins, with standard errors over several runs."""
    last_episodes, *parts = zip(*curves, strict=True)
    returns, lengths, optimal = map(np.array, parts)
    curve: dict[str, list[Any]] = {
        "episode": last_episodes[0].tolist(),
        "return_mean": returns.mean(axis=0).tolist(),
        "return_stderr": _standard_errors(returns),
        "length_mean": lengths.mean(axis=0).tolist(),
        "length_stderr": _standard_errors(lengths),
    }
    if bandit:
        curve["optimal_action_rate"] = optimal.mean(axis=0).tolist()
        curve["optimal_action_stderr"] = _standard_errors(optimal)
    return curve


def _standard_errors(values: FloatArray) -> list[float] | list[None]:
    runs, bins = values.shape
    if runs == 1:
        return [None] * bins
    errors: list[float] = (values.std(axis=0, ddof=1) / math.sqrt(runs)).tolist()
    return errors


def no_curve(bandit: bool) -> dict[str, list[Any]]:
    """Return an empty curve."""
    return {name: [] for name in mean_curve([RunCurve(1).points], bandit)}


# Runs under many seeds


def no_compiling() -> None:
    """Ignore a wait for machine code."""


class SeededRuns:
    """Trains `recipe` under different seeds, also from several threads.

    Runs share the world (unless it depends on the seed) and its solution. Raises UserError.
    """

    def __init__(
        self,
        recipe: Recipe,
        journal: Sequence[JournalEntry] = (),
        known: World | None = None,
        solve: Callable[[TabularMDP | None, float], Solution | None] = optimum_of,
    ) -> None:
        self._solve = solve
        self.recipe = recipe
        self.first = Run(recipe, begin(recipe, known), evaluate=False)
        """The first run, untrained."""
        self.first_seed = recipe.seed
        self.is_bandit = self.first.world.is_bandit
        """True if the world is a bandit."""
        self.plans = self.first.learner.plans
        """True if there are sweeps instead of episodes."""
        self.figures: tuple[str, ...] = (*FIGURES, *BANDIT_FIGURES) if self.is_bandit else FIGURES
        """Names of the numbers in a row."""
        self.journal = journal
        self.shared = None if recipe.scenario.section.drawn_from_seed else self.first.edited
        """The shared world, or None if each run has its own."""
        self._edited = [] if self.shared is None else self._worlds_after(self.shared)
        # by γ and by the number of edits, which are the same in all runs
        self._optima = dict[tuple[float, int], Solution | None]()
        self._digests = dict[int, str | None]()
        self._solving = threading.Lock()

    def _worlds_after(self, first: EditedWorld) -> list[EditedWorld]:
        worlds = [first]
        with suppress(UserError):  # the run that reaches an impossible change reports it
            for entry in self.journal:
                if isinstance(entry.change, WorldChange):
                    worlds.append(worlds[-1].after(entry.change, self.recipe))
        return worlds

    @property
    def batched_loop(self) -> Loop | None:
        """The loop for batches, or None for planners, with a journal, and for maps drawn from the seed."""
        learner, mdp = self.first.learner, self.first.world.mdp
        have_one_shape = self.shared is not None or self.is_bandit
        if mdp is None or learner.plans or self.journal or not have_one_shape:
            return None
        return learner.loop._replace(batching=batching_of(mdp, is_shared=self.shared is not None))

    def get_machine_code(self, runs: int, goal: Goal, on_compiling: Callable[[], None]) -> None:
        """Compile the loops if that pays, after `on_compiling`."""
        # Interpreted runs share one core. A simulated environment is not timed: a step may have
        # side effects, and most of the time is its own
        learner = self.first.learner
        if learner.rewindable:
            wanted, by_episodes = goal.steps or goal.episodes or 0, goal.steps is None
            seconds = runs * seconds_interpreted(learner, wanted, episodes=by_episodes)
            if pays(learner.loop, seconds):
                on_compiling()
                BACKGROUND.get(learner.loop)
            if self.batched_loop is not None and batching_pays(self.batched_loop, seconds):
                BACKGROUND.get(self.batched_loop)

    def new_run(self, seed: int, *on_episodes: OnEpisodes | None) -> Run:
        """Return a fresh run of `seed`."""
        recipe = replace(self.recipe, seed=seed)
        beginning = begin(recipe, None if self.shared is None else self.shared.world)
        on_each = each_of(*on_episodes)
        return Run(recipe, beginning, edited=self.shared, evaluate=False, on_episodes=on_each)

    def train(self, run: Run, goal: Goal, on_progress: OnProgress) -> None:
        """Advance `run` to `goal`. Raises UserError, naming the seed."""
        try:
            train(run, goal, on_progress, self.journal)
        except UserError as error:
            raise UserError(f"seed {run.recipe.seed}: {error}") from error

    def row(self, run: Run, check: Callable[[], None] = no_compiling) -> dict[str, Any]:
        """Return the row of `run` in `train --runs --json`. `check` may raise to stop."""
        check()
        changes = len(run.world_changes)
        optimum = self.optimum(exact_world(run), run.learner.hyperparameters.gamma, changes)
        check()
        measured = measured_run(run, greedy_figures(run, optimum))
        return row_of(run.recipe.seed, measured, self.digest(run.world, changes))

    def optimum(self, mdp: TabularMDP | None, gamma: float, changes: int = 0) -> Solution | None:
        """Solve `mdp` after `changes` edits, or None. A shared world is solved once."""
        # in a drifting world each run has other means, and so another solution
        if self.shared is None or (mdp is not None and mdp.drift_std > 0.0):
            return optimum_of(mdp, gamma)
        with self._solving:
            key = gamma, changes
            if key not in self._optima:
                self._optima[key] = self._solve(mdp, gamma)
            return self._optima[key]

    def digest(self, world: World, changes: int = 0) -> str | None:
        """Return the digest of `world` after `changes` edits, or None."""
        if self.shared is None:
            return world_digest(world)
        with self._solving:
            if changes not in self._digests:
                self._digests[changes] = world_digest(world)
            return self._digests[changes]
