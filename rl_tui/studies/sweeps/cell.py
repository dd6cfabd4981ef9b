"""A cell of a sweep: one combination of settings, and the key under which its runs are stored.

Equal training has an equal key, however the settings are written. Where the cell allows it, one call of
machine code trains many seeds, with the same bits as one by one.
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
"""Raised when the key itself is made in another way."""
KERNELS: Final = 1
"""Raised when the same recipe and seed come to other steps or estimates than before, bit for bit."""
FIGURES: Final = 1
"""Raised when the same run comes to other figures, or to figures of another meaning."""

# Figures are those of the greedy policy, whose ties this decides, whatever the agent's own policy is
_ALWAYS: Final = ("ties",)
_STEP_SIZE: Final = ("step_size_schedule", "alpha_min", "alpha_decay")


@dataclass(frozen=True, eq=False)
class Cell:
    """One combination of settings: what is trained there, under every seed alike."""

    index: int
    """Its number in the plan, from 0."""
    settings: Mapping[str, Value]
    """The value of each setting that varies, by its name, in the order of the plan."""
    recipe: Recipe
    """How its runs start; the seed is the first of the plan."""
    goal: Goal
    """So many episodes each run is trained for."""
    content: WorldContent
    """The world of its runs."""

    @cached_property
    def identity(self) -> dict[str, Any]:
        """All that its runs come from but for the seed, in one form: what its key is a hash of."""
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
        """The sha256, in hexadecimal, of the text of its identity."""
        return hashlib.sha256(self.identity_text.encode()).hexdigest()

    @cached_property
    def identity_text(self) -> str:
        """Its identity as JSON with sorted keys and no spaces."""
        return json.dumps(self.identity, sort_keys=True, separators=(",", ":"), allow_nan=False)

    @property
    def text(self) -> str:
        """Its settings in one line: ``alpha=0.1 algorithm=sarsa``."""
        return settings_text(self.settings)


@dataclass(frozen=True)
class SkippedCell:
    """A combination of settings that cannot work together, and why."""

    index: int
    settings: Mapping[str, Value]
    reason: str


def settings_text(settings: Mapping[str, Value]) -> str:
    """Return ``settings`` in one line: ``alpha=0.1 algorithm=sarsa``."""
    return " ".join(f"{name}={written(value)}" for name, value in settings.items())


def used_parameters(
    algorithm: str, values: Hyperparameters, *, is_bandit: bool
) -> dict[str, int | float | str]:
    """Return the hyper-parameters that make a difference, each in one form: what is equal is written alike.

    Those that algorithm and policy do not use are left out, and so are those that change nothing as things
    stand, such as where a decay of 0 would end.
    """
    used: dict[str, int | float | str] = {}
    for name in dict.fromkeys((*parameters_of(algorithm, values.policy), *_ALWAYS)):
        if name == "policy" or why_idle(name, algorithm, values, is_bandit=is_bandit):
            continue
        if values.sample_average and name in ("alpha", *_STEP_SIZE):
            used["alpha"] = SAMPLE_AVERAGE  # alpha may say so, or its schedule
            continue
        value = values.value(name)
        if not isinstance(value, str):
            value = int(value) if PARAMETERS[name].whole else float(value) + 0.0  # no zero below zero
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
"""The measures of a sweep by their ids, in the order of their columns."""
ARRIVED: Final = "arrived"
"""The figure beside ``arrival``: 1 where it happened, 0 where training ended before, null if no one knows."""
JUDGED_BY: Final = ("area", "expected_return")
"""By the first of these that its runs have a sweep is judged, where nobody says by which."""

Figures = Mapping[str, float | int | None]


def figures_of_run(run: MeasuredRun, best: float | None, line: float | None, arrival: int | None) -> Figures:
    """Return every measure of ``run``, and ``arrived``.

    The best policy earns ``best``; after ``arrival`` episodes the greedy policy first earned ``line``. Each
    is None where nobody can say, ``arrival`` also where that did not happen.
    """
    arrived = None if line is None else int(arrival is not None)
    return {**figures_of(replace(run, best_return=best, arrival=arrival), MEASURES), ARRIVED: arrived}


# Many seeds in one call


def loop_in_batches(cell: Cell) -> Loop | None:
    """Return the loop that trains many seeds of ``cell`` at once; None where each goes by itself.

    That is where each has a world of its own, or one that drifts or has no table.
    """
    mdp, recipe = cell.content.facts.mdp, cell.recipe
    if mdp is None or mdp.drift_std > 0.0 or cell.content.shared is None or BY_ID[recipe.algorithm].planner:
        return None
    policy = recipe.hyperparameters.policy
    return Loop(recipe.algorithm, policy, stepped=False, batching=batching_of(mdp, is_shared=True))


def runs_in_batches(cell: Cell) -> SeededRuns | None:
    """Return the runs of ``cell``, to be trained in batches; None where that cannot be, or not yet."""
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
    """Return the figures of each of ``seeds`` of ``seeded``, the runs of ``cell``; None if it broke down.

    After each of ``marks``, episodes that ascend, their greedy policies are looked at until they earn
    ``line``; where there is none, no mark is looked at. ``check`` is called now and then, and may raise to
    end it.
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
    """Return after which of ``marks`` the greedy policy of each run first earned ``line``; None for none."""
    assert mdp is not None  # or there were no line
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
