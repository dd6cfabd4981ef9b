"""The metrics of a run, for `train --json`, many seeds and sweeps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rl_tui.runs.bandit import BanditFigures
    from rl_tui.runs.run import Run

# Input of the metrics


@dataclass(frozen=True, slots=True)
class GreedyFigures:
    """Exact numbers of the greedy policy, or None if unknown."""

    value_at_start: float | None = None
    optimal_value_at_start: float | None = None
    expected_return: float | None = None
    max_error: float | None = None
    greedy_ends: float | None = None


NO_EXACT_FIGURES: Final = GreedyFigures()


@dataclass(frozen=True, slots=True)
class MeasuredRun:
    """The input of metrics: a run at its current step."""

    steps: int
    episodes: int
    """Finished episodes, including a planner's sweeps."""
    total_return: float
    """Sum of the undiscounted returns of all finished episodes."""
    mean_return: float | None
    """Their mean, or None before the first has ended."""
    last_100: tuple[float | None, float | None]
    """Mean return and mean length of the last 100 episodes or fewer."""
    first_reward_episode: int
    """First episode (from 1) with a reward other than 0, or 0 if there is none."""
    exact: GreedyFigures = NO_EXACT_FIGURES
    bandit: BanditFigures | None = None
    """Regret and pulls of a bandit, else None."""
    best_return: float | None = None
    """Expected return of the best policy, which may depend on the time, or None if unknown."""
    arrival: int | None = None
    """Episodes until the greedy policy was within 5 % of the best, or None if it never was."""


def measured_run(run: Run, exact: GreedyFigures = NO_EXACT_FIGURES) -> MeasuredRun:
    """Return the input of metrics for `run`."""
    return MeasuredRun(
        run.step,
        run.learner.episodes,
        run.history.total_return,
        run.mean_return,
        run.history.last_100,
        run.learner.first_reward_episode,
        exact,
        run.bandit,
    )


# The table


@dataclass(frozen=True, slots=True)
class Measure:
    """A metric of a run.

    `of` returns None if there is no value. With `may_never_arrive`, None counts as later than any value.
    `larger_is_better` is None if neither direction is better.
    """

    id: str
    title: str
    unit: str
    formula: str
    of: Callable[[MeasuredRun], float | None]
    larger_is_better: bool | None = None
    may_never_arrive: bool = False


def _regret(run: MeasuredRun) -> float | None:
    if run.bandit is not None:
        return run.bandit.regret
    if run.best_return is None or run.mean_return is None:
        return None
    regret = run.episodes * run.best_return - run.total_return
    return regret if math.isfinite(regret) else None


_TABLE: Final = (
    Measure(
        "expected_return",
        "expected return",
        "return",
        "exact expected return of the final greedy policy, from the start, undiscounted, within the "
        "time limit",
        lambda run: run.exact.expected_return,
        larger_is_better=True,
    ),
    Measure(
        "value_at_start",
        "value at the start",
        "discounted return",
        "exact expected return of the final greedy policy, from the start, discounted, without a time limit",
        lambda run: run.exact.value_at_start,
        larger_is_better=True,
    ),
    Measure(
        "optimal_value_at_start",
        "optimal value at the start",
        "discounted return",
        "exact expected return of the optimal policy, from the start, discounted, without a time limit",
        lambda run: run.exact.optimal_value_at_start,
    ),
    Measure(
        "greedy_ends",
        "greedy policy ends",
        "share",
        "exact probability that an episode of the greedy policy ends, 0 to 1",
        lambda run: run.exact.greedy_ends,
    ),
    Measure(
        "max_error",
        "largest error of Q",
        "discounted return",
        "max over all pairs of |Q(s, a) - Q*(s, a)|",
        lambda run: run.exact.max_error,
        larger_is_better=False,
    ),
    Measure(
        "area",
        "return per episode over all of training",
        "return",
        "mean return of all finished episodes: the area under the learning curve, divided by its length",
        lambda run: run.mean_return,
        larger_is_better=True,
    ),
    Measure(
        "arrival",
        "episodes until within 5 % of the best",
        "episodes",
        "first mark where best - greedy <= 0.05 (best - random). greedy, best and random are the exact "
        "expected returns of three policies: the agent's greedy policy, the best policy that may look at the "
        "time left, and the random policy. Marks are episodes 1, 2, "
        "3 and so on, later with growing gaps (a factor of at most 2^(1/4)), and the last episode",
        lambda run: run.arrival,
        larger_is_better=False,
        may_never_arrive=True,
    ),
    Measure(
        "regret",
        "regret",
        "return",
        "episodes x best return - sum of the returns; for a bandit, the sum over all pulls of max q* - "
        "q*(pulled arm)",
        _regret,
        larger_is_better=False,
    ),
    Measure("steps", "steps", "steps", "steps in total", lambda run: run.steps),
    Measure(
        "episodes", "episodes", "episodes", "finished episodes; sweeps of a planner", lambda run: run.episodes
    ),
    Measure(
        "return_last_100",
        "return, last 100 episodes",
        "return",
        "mean undiscounted return of the last 100 finished episodes (all, if there are fewer)",
        lambda run: run.last_100[0],
        larger_is_better=True,
    ),
    Measure(
        "length_last_100",
        "length, last 100 episodes",
        "steps",
        "mean length of the last 100 finished episodes",
        lambda run: run.last_100[1],
    ),
    Measure(
        "return_mean",
        "mean return",
        "return",
        "mean undiscounted return of all finished episodes",
        lambda run: run.mean_return,
        larger_is_better=True,
    ),
    Measure(
        "first_reward_episode",
        "episode of the first reward that is not 0",
        "episodes",
        "the first episode with a reward other than 0, from 1",
        lambda run: run.first_reward_episode or None,
        larger_is_better=False,
        may_never_arrive=True,
    ),
    Measure(
        "winnings",
        "winnings",
        "return",
        "bandits: the sum of all rewards",
        lambda run: None if run.bandit is None else run.bandit.winnings,
        larger_is_better=True,
    ),
    Measure(
        "best_arm_rate",
        "best arm, share of pulls",
        "share",
        "bandits: the share of pulls on the best arm, 0 to 1",
        lambda run: None if run.bandit is None else run.bandit.best_arm_rate,
        larger_is_better=True,
    ),
)
MEASURES: Final = {measure.id: measure for measure in _TABLE}
"""All metrics by id."""
EXACT: Final = ("value_at_start", "expected_return", "max_error")
"""Metrics that are always exact."""
_LAST_100: Final = ("return_last_100", "length_last_100")
FIGURES: Final = ("steps", "episodes", *EXACT, "return_mean", *_LAST_100, "first_reward_episode")
"""Metrics in a row of `train --runs --json`, in order."""
BANDIT_FIGURES: Final = ("winnings", "regret", "best_arm_rate")
"""Further metrics of a bandit."""


def figures_of(run: MeasuredRun, names: Iterable[str]) -> dict[str, float | None]:
    """Return the metrics `names` of `run`, in that order."""
    return {name: MEASURES[name].of(run) for name in names}
