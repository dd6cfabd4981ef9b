"""Results of a run, as `train --json` prints them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, Solution, why_unsolved
from rl_tui.agents.exact.policy_figures import figures, greedy_policy
from rl_tui.agents.exact.solve import returns, solve
from rl_tui.agents.hyperparameters import Ties
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.runs.measures import (
    BANDIT_FIGURES,
    FIGURES,
    NO_EXACT_FIGURES,
    GreedyFigures,
    MeasuredRun,
    figures_of,
    measured_run,
)
from rl_tui.runs.recipe import Recipe
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.runs.run import Run

MOST_STATES: Final = 50_000
_LEARNED: Final = (
    "value_at_start",
    "optimal_value_at_start",
    "expected_return",
    "max_error",
    "return_mean",
    "return_last_100",
    "length_last_100",
    "greedy_ends",
    "first_reward_episode",
)


def exact_world(run: Run) -> TabularMDP | None:
    """Return the current transition table if there is one of at most 50,000 states (2,000 without SciPy)."""
    mdp = run.learner.mdp
    return None if mdp is None or mdp.states > MOST_STATES or why_unsolved(mdp.states) else mdp


def why_inexact(run: Run) -> str:
    """Return why `run` has no exact results, or ""."""
    if run.learner.mdp is None:
        return NO_TABLE
    left_out = f"not computed above {MOST_STATES:,} states; rl-tui solve computes the optimal values"
    return "" if exact_world(run) else why_unsolved(run.learner.mdp.states) or left_out


def optimum_of(mdp: TabularMDP | None, gamma: float) -> Solution | None:
    """Solve `mdp` exactly, or None if impossible."""
    if mdp is None:
        return None
    try:
        return solve(mdp, gamma)
    except NoExactAnswer:
        return None


def greedy_figures(run: Run, optimum: Solution | None) -> GreedyFigures:
    """Evaluate the greedy policy of `run` exactly."""
    hyperparameters = run.learner.hyperparameters
    return figures_of_estimates(
        exact_world(run), run.learner.q, hyperparameters.ties, hyperparameters.gamma, optimum
    )


def figures_of_estimates(
    mdp: TabularMDP | None, q: FloatArray, ties: Ties, gamma: float, optimum: Solution | None
) -> GreedyFigures:
    """Evaluate the greedy policy of `q`, `[P]`, exactly, if there is an `mdp`."""
    if mdp is None:
        return NO_EXACT_FIGURES
    of_policy = figures(mdp, greedy_policy(mdp, q, ties), gamma)
    return GreedyFigures(
        value_at_start=of_policy.value_at_start,
        optimal_value_at_start=optimum.value_at_start if optimum else None,
        expected_return=of_policy.expected_return,
        max_error=float(np.abs(q - optimum.q).max()) if optimum else None,
        greedy_ends=of_policy.ends,
    )


def head(recipe: Recipe) -> dict[str, Any]:
    """Return scenario, algorithm, seed and settings as JSON."""
    return {
        "scenario": recipe.scenario.id,
        "algorithm": recipe.algorithm,
        "seed": recipe.seed,
        "hyperparameters": recipe.hyperparameters.as_dict(),
    }


def training_figures(run: Run, seconds: float) -> dict[str, Any]:
    """Return the document of `train --json`."""
    space, learner = run.world.space, run.learner
    exact = greedy_figures(run, optimum_of(exact_world(run), learner.hyperparameters.gamma))
    measured = measured_run(run, exact)
    document: dict[str, Any] = finite(
        {
            **head(run.recipe),
            **figures_of(measured, ("episodes", "steps")),
            "seconds": seconds,
            "steps_per_second": run.step / seconds if seconds > 0.0 else None,
            "states": list(space.state_names),
            "actions": list(space.action_names),
            "world": world_digest(run.world),
            "q": table(space, learner.q),
            "visits": table(space, learner.visits),
            "policy": policy_names(space, greedy_policy(space, learner.q, "random")),
            **figures_of(measured, _LEARNED),
            **_pulls(measured),
        }
    )
    return document


def row_of(seed: int, run: MeasuredRun, world: str | None) -> dict[str, Any]:
    """Return the row of a run in `train --runs --json`."""
    return {"seed": seed, **figures_of(run, FIGURES), "world": world, **_pulls(run)}


def _pulls(run: MeasuredRun) -> dict[str, float | None]:
    return {} if run.bandit is None else figures_of(run, BANDIT_FIGURES)


def world_digest(world: World) -> str | None:
    """Return the digest of its table, or None."""
    return None if world.mdp is None else table_digest(world.mdp)


def solution_figures(recipe: Recipe, mdp: TabularMDP, solution: Solution) -> dict[str, Any]:
    """Return the document of `solve --json`."""
    earned = returns(mdp, solution)
    return {
        "scenario": recipe.scenario.id,
        "gamma": solution.gamma,
        "states": list(mdp.state_names),
        "actions": list(mdp.action_names),
        "v": solution.v.tolist(),
        "q": table(mdp, solution.q),
        "policy": policy_names(mdp, solution.greedy.astype(float)),
        "left_out": policy_names(mdp, (solution.best & ~solution.greedy).astype(float)),
        "value_at_start": solution.value_at_start,
        "expected_return": earned.expected_return,
        "best_expected_return": earned.best_expected_return,
        "iterations": solution.iterations,
    }


def table(space: FiniteSpace, values: npt.NDArray[Any]) -> list[list[Any]]:
    """Arrange `values`, `[P]`, as rows of states; None where unavailable."""
    rows: list[list[Any]] = [[None] * len(space.action_names) for _ in range(space.states)]
    places = zip(space.pair_state.tolist(), space.pair_action.tolist(), values.tolist(), strict=True)
    for state, action, value in places:
        rows[state][action] = value
    return rows


def policy_names(space: FiniteSpace, policy: FloatArray) -> list[list[str]]:
    """Return the actions of each state with a positive probability in `policy`, `[P]`."""
    names: list[list[str]] = [[] for _ in range(space.states)]
    chosen = np.flatnonzero(policy)
    states, actions = space.pair_state[chosen].tolist(), space.pair_action[chosen].tolist()
    for state, action in zip(states, actions, strict=True):
        names[state].append(space.action_names[action])
    return names


def summary(values: Sequence[float | None]) -> dict[str, float | int | None]:
    """Return mean, standard error (n − 1), minimum, maximum and count of the finite values."""
    there = [value for value in values if value is not None and math.isfinite(value)]
    count = len(there)
    mean, stderr = math.fsum(there) / count if there else None, None
    if mean is not None and count > 1:
        squares = (np.array(there, np.float64) - mean) ** 2
        stderr = math.sqrt(math.fsum(squares.tolist()) / (count - 1) / count)
    return {
        "mean": mean,
        "stderr": stderr,
        "min": min(there, default=None),
        "max": max(there, default=None),
        "count": count,
    }


def finite(value: Any) -> Any:
    """Replace numbers that are not finite by None."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite(each) for key, each in value.items()}
    return [finite(each) for each in value] if isinstance(value, list) else value
