"""What it is worth to an algorithm to have settings of its own in every scenario."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from rl_tui.lab.statistics.sensitivity import Sensitivity, sensitivity_of
from rl_tui.lab.sweeps.cell import Cell
from rl_tui.lab.sweeps.measures import SweepMeasure
from rl_tui.lab.sweeps.plan import SweepPlan
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.summaries import values_by_seed
from rl_tui.lab.sweeps.variation import ALGORITHM, SCENARIO, Value
from rl_tui.worlds.mdp.space import FloatArray

SCORES: Final = ("expected_return", "area")
"""The measures that have a scale from the random policy to the best one."""

_Settings = tuple[tuple[str, Value], ...]


def sensitivities(plan: SweepPlan, store: Store, measure: SweepMeasure) -> list[dict[str, Any]] | None:
    """Return, as JSON, how sensitive each algorithm of ``plan`` is to the settings that vary.

    None where nothing can be said: fewer than two scenarios, points at random, a measure without a scale, or
    a scenario without an exact answer. A setting of which a run broke down in some scenario is left out.
    """
    varied = next((each.listed for each in plan.variations if each.name == SCENARIO), ())
    if plan.random is not None or len(varied) < 2 or measure.id not in SCORES:
        return None
    values: dict[str, dict[_Settings, dict[Value, FloatArray]]] = {}
    scales: dict[Value, tuple[float, float]] = {}
    for index in range(plan.count):
        cell = plan.cell(index)
        if not isinstance(cell, Cell):
            continue
        scale = _scale(cell)
        if scale is None:
            return None
        scales[cell.settings[SCENARIO]] = scale
        found, is_complete = values_by_seed(store.rows(cell.key, plan.seeds), measure, plan.seeds)
        if found is not None and is_complete:
            of_algorithm = values.setdefault(cell.recipe.algorithm, {})
            of_algorithm.setdefault(_rest(cell.settings), {})[cell.settings[SCENARIO]] = found
    if len(scales) < len(varied):
        return None
    return [
        each
        for algorithm, of_algorithm in values.items()
        if (each := _sensitivity(algorithm, of_algorithm, scales, plan.runs)) is not None
    ]


def _sensitivity(
    algorithm: str,
    values: Mapping[_Settings, Mapping[Value, FloatArray]],
    scales: Mapping[Value, tuple[float, float]],
    runs: int,
) -> dict[str, Any] | None:
    scenarios, settings = list(scales), list(values)
    matrix = np.full((len(scenarios), len(settings), runs), np.nan)
    for column, each in enumerate(settings):
        for row, scenario in enumerate(scenarios):
            matrix[row, column] = values[each].get(scenario, np.nan)
    random, best = np.array([scales[each] for each in scenarios]).T
    found = sensitivity_of(matrix, random, best)
    return None if found is None else _as_json(algorithm, found, scenarios, settings)


def _as_json(
    algorithm: str, found: Sensitivity, scenarios: list[Value], settings: list[_Settings]
) -> dict[str, Any]:
    return {
        ALGORITHM: algorithm,
        "value": found.value,
        "held_out": found.held_out,
        "tuned": found.tuned,
        "in_common": found.in_common,
        "common": dict(settings[found.common]),
        "scenarios": [
            {SCENARIO: scenario, "best": dict(settings[int(place)]), "lost": float(lost)}
            for scenario, place, lost in zip(scenarios, found.best, found.lost, strict=True)
        ],
    }


def _scale(cell: Cell) -> tuple[float, float] | None:
    """Return what the random policy and the best one earn in the world of ``cell``; None if nobody knows."""
    facts = cell.content.facts
    if cell.content.shared is None or facts.random is None or facts.best is None:
        return None
    return None if facts.best == facts.random else (facts.random, facts.best)


def _rest(settings: Mapping[str, Value]) -> _Settings:
    return tuple((name, value) for name, value in settings.items() if name not in (SCENARIO, ALGORITHM))
