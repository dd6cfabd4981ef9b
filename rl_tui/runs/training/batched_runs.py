"""Runs that differ in their seed, trained together by one call of machine code."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from rl_tui.agents.batches.batch import UNLIMITED, DrawnWorld, RunBatch
from rl_tui.agents.exact.policy_figures import batch_figures
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS
from rl_tui.agents.kernels.position import DONE, EPISODES_FULL
from rl_tui.runs.bandit import BanditFigures, bandit_figures
from rl_tui.runs.figures import MOST_STATES, row_of
from rl_tui.runs.measures import NO_EXACT_FIGURES, GreedyFigures, MeasuredRun
from rl_tui.runs.recipe import Beginning, begin
from rl_tui.runs.training.seeded_runs import (
    MOST_BINS,
    CurvePoints,
    Goal,
    RunCurve,
    SeededRuns,
    no_compiling,
    no_progress,
    width_of_bins,
)
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_RUNS: Final = 256
"""Runs in one batch. More would not reduce the Python overhead further."""
MOST_BYTES: Final = 64_000_000
"""Memory of the learners in a batch."""
FIRST_STEPS: Final = 20_000
"""Steps of the first call. A check follows each call."""
MOST_STEPS_AT_ONCE: Final = 2_000_000
SHORT_CALL: Final = 0.05
"""A call shorter than this many seconds is followed by a longer one."""
LONG_CALL: Final = 0.1
"""A call longer than this many seconds is followed by a shorter one."""

STATES_AT_ONCE: Final = 10_000
"""Number of states in the policies that are evaluated between two checks, about 0.5 s."""


def runs_at_once(seeded: SeededRuns, marks: int = 0) -> int:
    """Return the largest batch with `marks` stored estimates, or 0 without compiled code."""
    learner = seeded.first.learner
    if seeded.batched_loop not in COMPILED_LOOPS:
        return 0
    return min(MOST_RUNS, MOST_BYTES // (learner.nbytes + 8 * marks * learner.space.pairs))


def steps_of_next_call(steps: int, seconds: float) -> int:
    """Choose the steps of the next call by time; algorithms differ a thousandfold."""
    if seconds < SHORT_CALL:
        return min(2 * steps, MOST_STEPS_AT_ONCE)
    return max(1, steps // 2) if seconds > LONG_CALL else steps


class BatchedRuns:
    """The runs of `seeded` with `seeds`, trained together.

    Learning curves have `curve_episodes`, and estimates are stored after `mark_episodes` (ascending). Raises
    UserError.
    """

    def __init__(
        self,
        seeded: SeededRuns,
        seeds: Sequence[int],
        goal: Goal,
        *,
        curve_episodes: int = 0,
        most_bins: int = MOST_BINS,
        mark_episodes: Sequence[int] = (),
    ) -> None:
        self._seeded, self._seeds, self._goal = seeded, seeds, goal
        self._beginnings: list[Beginning] = []
        world: TabularMDP | list[DrawnWorld]
        if seeded.shared is None:
            self._beginnings = [begin(replace(seeded.recipe, seed=seed)) for seed in seeds]
            world = [DrawnWorld(_table(each), each.streams) for each in self._beginnings]
        else:
            assert seeded.shared.world.mdp is not None  # only worlds with a table are batched
            world = seeded.shared.world.mdp
        self._curve_episodes, self._most_bins = curve_episodes, most_bins
        self.batch = RunBatch(
            seeded.recipe.algorithm,
            seeded.recipe.hyperparameters,
            seeds,
            world,
            steps=UNLIMITED if goal.steps is None else goal.steps,
            episodes=UNLIMITED if goal.steps is not None else goal.episodes or 0,
            curve_episodes=curve_episodes,
            width=max(1, width_of_bins(curve_episodes, most_bins)),
            mark_episodes=mark_episodes,
        )

    def train(self, on_progress: Callable[[int, int], None] = no_progress) -> None:
        """Train all runs to the goal. `on_progress` (done, wanted) may raise to stop.

        Raises UserError for the first run that broke down.
        """
        wanted = (self._goal.steps or self._goal.episodes or 0) * len(self._seeds)
        self.advance(lambda: on_progress(self._done, wanted))
        for index in self.broken:
            self._seeded.train(self._seeded.new_run(self._seeds[index]), self._goal, no_progress)
        on_progress(self._done, wanted)

    @property
    def hyperparameters(self) -> Hyperparameters:
        """Settings of all runs."""
        return self._seeded.recipe.hyperparameters

    def advance(self, check: Callable[[], None]) -> None:
        """Train all runs except broken ones. `check` may raise to stop."""
        steps, start = FIRST_STEPS, time.perf_counter()
        while self.batch.advance(steps):
            steps = steps_of_next_call(steps, time.perf_counter() - start)
            check()
            start = time.perf_counter()

    @property
    def step(self) -> int:
        """Steps of the longest run."""
        return self.batch.longest

    @property
    def _done(self) -> int:
        steps, episodes = self.batch.done()
        return episodes if self._goal.steps is None else steps

    @property
    def broken(self) -> list[int]:
        """Indexes of runs that broke down."""
        return np.flatnonzero(~np.isin(self.batch.stop, (DONE, EPISODES_FULL))).tolist()

    def rows(self, check: Callable[[], None] = no_compiling) -> list[dict[str, Any]]:
        """Return the rows of `SeededRuns.row`, with the same bits. `check` may raise to stop."""
        rows = zip(self._seeds, self.measured(check), self._digests(), strict=True)
        return [row_of(*each) for each in rows]

    def measured(self, check: Callable[[], None]) -> list[MeasuredRun]:
        """Return the input of metrics for each run. `check` may raise to stop."""
        batch, exact = self.batch, self._exact(check)
        with np.errstate(invalid="ignore"):  # runs without an episode
            means = batch.digest.total_return[:, 0] / batch.episodes
        columns: dict[str, Iterable[Any]] = {
            "steps": batch.steps.tolist(),
            "episodes": batch.episodes.tolist(),
            "total_return": batch.digest.total_return[:, 0].tolist(),
            "mean_return": _if_there(means),
            "last_100": zip(*map(_if_there, batch.recent_means()), strict=True),
            "first_reward_episode": batch.first_reward_episode.tolist(),
            "exact": exact,
            "bandit": map(self._bandit, range(len(self._seeds))),
        }
        rows = zip(*columns.values(), strict=True)
        return [MeasuredRun(**dict(zip(columns, row, strict=True))) for row in rows]

    def _digests(self) -> list[str | None]:
        if self._seeded.shared is not None:
            return [self._seeded.digest(self._seeded.first.world)] * len(self._seeds)
        return [self._seeded.digest(each.world) for each in self._beginnings]

    @property
    def curves(self) -> list[CurvePoints]:
        """Learning curves, empty if none were requested."""
        if not self._curve_episodes:
            return []
        last_episode = RunCurve(self._curve_episodes, self._most_bins).last_episode
        count = np.diff(last_episode, prepend=0)
        sums_of_each = zip(*self.batch.digest.curve, strict=True)
        return [CurvePoints(last_episode, *(part / count for part in sums)) for sums in sums_of_each]

    def _exact(self, check: Callable[[], None]) -> list[GreedyFigures]:
        q, shared = self.batch.q, self._seeded.shared
        at_once = 1
        if shared is not None and not self._drifts:
            at_once = max(1, STATES_AT_ONCE // shared.world.space.states)
        found = list[GreedyFigures]()
        for index in range(0, len(q), at_once):
            check()
            found += self._exact_in(self._table_now(index), q[index : index + at_once])
        return found

    def _exact_in(self, mdp: TabularMDP | None, q: FloatArray) -> list[GreedyFigures]:
        if mdp is None or mdp.states > MOST_STATES:
            return [NO_EXACT_FIGURES] * len(q)
        values = self._seeded.recipe.hyperparameters
        optimum = self._seeded.optimum(mdp, values.gamma)
        found = batch_figures(mdp, q, values.ties, values.gamma, optimum)
        columns = map(_if_there, (found.value_at_start, found.expected_return, found.max_error))
        return [
            GreedyFigures(value_at_start=value, expected_return=earned, max_error=error)
            for value, earned, error in zip(*columns, strict=True)
        ]

    @property
    def _drifts(self) -> bool:
        return bool(self.batch.drift.offset.shape[1])

    def _table_now(self, index: int) -> TabularMDP | None:
        shared = self._seeded.shared
        mdp = _table(self._beginnings[index]) if shared is None else shared.world.mdp
        if mdp is None or not self._drifts:
            return mdp
        return replace(mdp, reward=mdp.reward + self.batch.drift.offset[index][mdp.outcome_pair])

    def _bandit(self, index: int) -> BanditFigures | None:
        world = self._beginnings[index].world if self._beginnings else self._seeded.first.world
        total, drifted = float(self.batch.digest.total_return[index, 0]), self.batch.drifted(index)
        return bandit_figures(world, self.batch.visits[index], total, drifted)


def _table(beginning: Beginning) -> TabularMDP:
    mdp = beginning.world.mdp
    assert mdp is not None  # only worlds with a table are batched
    return mdp


def _if_there(column: FloatArray) -> list[float | None]:
    numbers: list[float | None] = column.tolist()
    for place in np.flatnonzero(~np.isfinite(column)).tolist():
        numbers[place] = None
    return numbers
