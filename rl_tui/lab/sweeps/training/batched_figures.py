"""The figures of many seeds of a cell, trained by one call of machine code: the same bits as one by one."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, cast

import numpy as np

from rl_tui.agents.batches.batch import batching_of
from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.policies import greedy_policy
from rl_tui.agents.exact.policy_figures import expected_returns
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop
from rl_tui.lab.experiments.batched_runs import BatchedRuns
from rl_tui.lab.experiments.seeded_runs import SeededRuns
from rl_tui.lab.sweeps.cell import Cell
from rl_tui.lab.sweeps.measures import ARRIVED
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

Figures = Mapping[str, float | int | None]

# The measures that a row of ``train --runs`` has, and what they are called there
_COLUMNS: Final = {
    "expected_return": "expected_return",
    "value_at_start": "value_at_start",
    "max_error": "max_error",
    "area": "return_mean",
    "steps": "steps",
    "episodes": "episodes",
    "return_last_100": "return_last_100",
}


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
    found = list[Figures | None]()
    for index, row in enumerate(runs.rows(check)):
        arrived = None if line is None else int(arrivals[index] is not None)
        total = runs.total_return(index)
        figures = {name: row[column] for name, column in _COLUMNS.items()}
        figures |= {"regret": _regret(row, total, facts.best), "arrival": arrivals[index], ARRIVED: arrived}
        found.append(None if index in broken else figures)
    return found


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


def _regret(row: Mapping[str, Any], total: float, best: float | None) -> float | None:
    """Return what the episodes of a run lost against the ``best`` policy; of a bandit by true means."""
    if "regret" in row:
        return cast("float | None", row["regret"])
    if best is None or not row["episodes"]:
        return None
    regret = row["episodes"] * best - total
    return regret if math.isfinite(regret) else None
