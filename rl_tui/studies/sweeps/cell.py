"""A cell of a sweep: one combination of settings, and the key of its runs.

Equal training has an equal key, however the settings are written.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from rl_tui.agents.batches.batch import batching_of
from rl_tui.agents.catalogue import BY_ID, parameters_of
from rl_tui.agents.exact.policy_figures import expected_returns, greedy_policy
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, why_idle
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop
from rl_tui.runs.measures import MEASURES as RUN_MEASURES
from rl_tui.runs.measures import MeasuredRun, figures_of
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.training.batched_runs import BatchedRuns
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns
from rl_tui.studies.sweeps.cells.content import WorldContent
from rl_tui.studies.sweeps.cells.variation import Value, written
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# The cell and its key


KEY_FORMAT: Final = 1
"""Increased when the form of the key changes."""
KERNELS: Final = 1
"""Increased when equal recipes and seeds give different steps or estimates, in any bit."""
FIGURES: Final = 1
"""Increased when equal runs give different numbers, or numbers with another meaning."""

# ties decide the greedy policy that is evaluated, even if the agent has another policy
_ALWAYS: Final = ("ties",)
_STEP_SIZE: Final = ("step_size_schedule", "alpha_min", "alpha_decay")


@dataclass(frozen=True, eq=False)
class Cell:
    """One combination of settings, trained under every seed."""

    index: int
    """Number in the plan, from 0."""
    settings: Mapping[str, Value]
    """Values of the varying settings by name, in the order of the plan."""
    recipe: Recipe
    """Start of its runs. The seed is the first of the plan."""
    goal: Goal
    """Number of episodes of each run."""
    content: WorldContent

    @cached_property
    def identity(self) -> dict[str, Any]:
        """Everything that determines its runs except the seed, in a canonical form."""
        return {
            "format": KEY_FORMAT,
            "kernels": KERNELS,
            "figures": FIGURES,
            "world": self.content.digest,
            "algorithm": self.recipe.algorithm,
            "policy": None if BY_ID[self.recipe.algorithm].planner else self.recipe.hyperparameters.policy,
            "parameters": used_parameters(
                self.recipe.algorithm, self.recipe.hyperparameters, is_bandit=self.content.is_bandit
            ),
            "episodes": self.goal.episodes,
        }

    @cached_property
    def key(self) -> str:
        """SHA-256 of the identity, in hexadecimal."""
        return hashlib.sha256(self.identity_text.encode()).hexdigest()

    @cached_property
    def identity_text(self) -> str:
        """The identity as JSON with sorted keys and no spaces."""
        return json.dumps(self.identity, sort_keys=True, separators=(",", ":"), allow_nan=False)

    @property
    def text(self) -> str:
        """Its settings in one line: `alpha=0.1 algorithm=sarsa`."""
        return settings_text(self.settings)


@dataclass(frozen=True)
class SkippedCell:
    """A combination of settings that cannot work together."""

    index: int
    settings: Mapping[str, Value]
    reason: str


def settings_text(settings: Mapping[str, Value]) -> str:
    """Format `settings` in one line: `alpha=0.1 algorithm=sarsa`."""
    return " ".join(f"{name}={written(value)}" for name, value in settings.items())


def used_parameters(
    algorithm: str, values: Hyperparameters, *, is_bandit: bool
) -> dict[str, int | float | str]:
    """Return the hyperparameters with an effect, in a canonical form."""
    used: dict[str, int | float | str] = {}
    for name in dict.fromkeys((*parameters_of(algorithm, values.policy), *_ALWAYS)):
        if name == "policy" or why_idle(name, algorithm, values, is_bandit=is_bandit):
            continue
        if values.sample_average and name in ("alpha", *_STEP_SIZE):
            used["alpha"] = SAMPLE_AVERAGE  # alpha or its schedule may say so
            continue
        value = values.value(name)
        if not isinstance(value, str):
            value = int(value) if PARAMETERS[name].whole else float(value) + 0.0  # no negative zero
        used[name] = value
    return used


# What a run comes to


MEASURES: Final = {
    name: RUN_MEASURES[name]
    for name in (
        "expected_return",
        "value_at_start",
        "max_error",
        "area",
        "arrival",
        "regret",
        "steps",
        "episodes",
        "return_last_100",
    )
}
"""Metrics of a sweep by id, in the order of columns."""
ARRIVED: Final = "arrived"
"""Column after `arrival`: 1 if it happened, 0 if training ended before, null if unknown."""
JUDGED_BY: Final = ("area", "expected_return")
"""Default metrics that rank a sweep. The first with values is used."""

Figures = Mapping[str, float | int | None]


def figures_of_run(run: MeasuredRun, best: float | None, line: float | None, arrival: int | None) -> Figures:
    """Return every metric of `run`, and `arrived`.

    `best` is the expected return of the best policy, `line` the return that counts as arrival, and `arrival`
    the episodes until then.
    """
    arrived = None if line is None else int(arrival is not None)
    return {**figures_of(replace(run, best_return=best, arrival=arrival), MEASURES), ARRIVED: arrived}


# Many seeds in one call


def loop_in_batches(cell: Cell) -> Loop | None:
    """Return the loop that trains many seeds together, or None unless they share one constant table."""
    mdp, recipe = cell.content.facts.mdp, cell.recipe
    if mdp is None or mdp.drift_std > 0.0 or cell.content.shared is None or BY_ID[recipe.algorithm].planner:
        return None
    policy = recipe.hyperparameters.policy
    return Loop(recipe.algorithm, policy, stepped=False, batching=batching_of(mdp, is_shared=True))


def runs_in_batches(cell: Cell) -> SeededRuns | None:
    """Return the runs for batches, or None if not possible or compiled."""
    if loop_in_batches(cell) not in COMPILED_LOOPS:
        return None
    facts = cell.content.facts
    return SeededRuns(cell.recipe, known=cell.content.shared, solve=lambda _, gamma: facts.optimum(gamma))


def batched_figures(
    cell: Cell,
    seeded: SeededRuns,
    seeds: Sequence[int],
    marks: Sequence[int],
    line: float | None,
    check: Callable[[], None],
) -> list[Figures | None]:
    """Train several seeds of a cell together and return their numbers (None if broken down).

    The greedy policy is compared with `line` at the ascending `marks`. `check` may raise to stop.
    """
    facts = cell.content.facts
    marks = marks if line is not None else ()
    runs = BatchedRuns(seeded, seeds, cell.goal, mark_episodes=marks)
    runs.advance(check)
    arrivals = [None] * len(seeds) if line is None else _arrivals(runs, facts.mdp, marks, line, check)
    broken = set(runs.broken)
    return [
        None if index in broken else figures_of_run(run, facts.best, line, arrivals[index])
        for index, run in enumerate(runs.measured(check))
    ]


def _arrivals(
    runs: BatchedRuns,
    mdp: TabularMDP | None,
    marks: Sequence[int],
    line: float,
    check: Callable[[], None],
) -> list[int | None]:
    assert mdp is not None  # otherwise there would be no line
    batch, ties = runs.batch, runs.hyperparameters.ties
    found: list[int | None] = [None] * len(batch.stop)
    waiting = np.arange(len(found))
    estimates, passed = batch.mark_estimates, batch.marks_passed
    for place, mark in enumerate(marks):
        waiting = waiting[passed[waiting] > place]
        if not len(waiting):
            break
        check()
        earned = expected_returns(mdp, greedy_policy(mdp, estimates[waiting, place], ties))
        for index in waiting[earned >= line].tolist():
            found[index] = mark
        waiting = waiting[~(earned >= line)]
    return found
