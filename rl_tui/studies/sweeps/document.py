"""The results of a sweep as the document of `sweep --json`, and as CSV."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, TextIO

import numpy as np

from rl_tui.runs.measures import Measure
from rl_tui.studies.statistics.sensitivity import Sensitivity, sensitivity_of
from rl_tui.studies.statistics.shrinkage import shrinkage_of
from rl_tui.studies.sweeps.cell import MEASURES, Cell
from rl_tui.studies.sweeps.cells.variation import ALGORITHM, SCENARIO, Value, written
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.ranking import Standings
from rl_tui.studies.sweeps.runs import CellSummary, summarized, values_by_seed
from rl_tui.studies.sweeps.schema import FIGURES
from rl_tui.studies.sweeps.store import Store
from rl_tui.worlds.mdp.space import FloatArray

# The raw results as CSV, one row a run


def write_csv(stream: TextIO, plan: SweepPlan, store: Store) -> None:
    """Write the rows of `plan` in its order, with all numbers and reasons."""
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*plan.names, "seed", *FIGURES, "failed"])
    for index in range(plan.count):
        cell = plan.cell(index)
        if not isinstance(cell, Cell):
            continue
        settings = [written(value) for value in cell.settings.values()]
        for row in store.rows(cell.key, plan.seeds):
            figures = ("" if each is None else repr(each) for each in map(row.figures.get, FIGURES))
            writer.writerow([*settings, row.seed, *figures, row.failed or ""])


# Sensitivity to settings


SCORES: Final = ("expected_return", "area")
"""Metrics with a scale from the random to the best policy."""

_SAID: Final = ("id", "title", "formula", "unit", "larger_is_better", "may_never_arrive")
"""Attributes of a metric in a document."""
_Settings = tuple[tuple[str, Value], ...]


def sensitivities(plan: SweepPlan, store: Store, measure: Measure) -> list[dict[str, Any]] | None:
    """Return the sensitivity of each algorithm to its settings, or None if undefined.

    A setting with a failed run in some scenario is left out.
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
    facts = cell.content.facts
    if cell.content.shared is None or facts.random is None or facts.best is None:
        return None
    return None if facts.best == facts.random else (facts.random, facts.best)


def _rest(settings: Mapping[str, Value]) -> _Settings:
    return tuple((name, value) for name, value in settings.items() if name not in (SCENARIO, ALGORITHM))


# The document


Document = dict[str, Any]
_NOBODY: Final[FloatArray] = np.empty(0)


@dataclass(frozen=True)
class CellResult:
    """A cell with the summary of its runs."""

    cell: Cell
    summary: CellSummary

    @property
    def as_json(self) -> Document:
        """The cell in a document."""
        summary = self.summary
        return {**self.cell.settings, "runs": summary.runs, "failed": summary.failed, **summary.figures}


def results(plan: SweepPlan, store: Store) -> Iterator[CellResult]:
    """Yield each cell of `plan` with runs, one at a time."""
    for index in range(plan.count):
        found = result_of(plan, store, index)
        if found is not None:
            yield found


def result_of(plan: SweepPlan, store: Store, index: int) -> CellResult | None:
    """Return cell `index`, or None if it cannot work or has no run."""
    cell = plan.cell(index)
    if not isinstance(cell, Cell):
        return None
    summary = summarized(store.rows(cell.key, plan.seeds))
    return CellResult(cell, summary) if summary.runs else None


def fresh_seeds(plan: SweepPlan) -> range:
    """Return as many new seeds as each cell has."""
    return range(plan.first_seed + plan.runs, plan.first_seed + 2 * plan.runs)


def best_documents(standings: Standings, plan: SweepPlan, store: Store, *, again: bool) -> list[Document]:
    """Return the best cell of each world as JSON data.

    `again` adds results on fresh seeds if the cell was chosen among several. `shrunk` is the loss of the mean
    there, with a 95 % interval.
    """
    documents, chosen = list[Document](), {cell.index for cell in standings.chosen}
    for cell in standings.bests:
        document = CellResult(cell, summarized(store.rows(cell.key, plan.seeds))).as_json
        if again and cell.index in chosen:
            document["again"] = _again(plan, store, cell, standings.measure)
        documents.append(document)
    return documents


def _again(plan: SweepPlan, store: Store, cell: Cell, measure: Measure) -> Document:
    fresh = fresh_seeds(plan)
    before, after = (_values(store, cell, measure, seeds) for seeds in (plan.seeds, fresh))
    shrinkage = shrinkage_of(before, after, larger_is_better=bool(measure.larger_is_better))
    summary = summarized(store.rows(cell.key, fresh))
    return {
        "first_seed": fresh.start,
        "runs": summary.runs,
        "failed": summary.failed,
        **summary.figures,
        "shrunk": None if shrinkage is None else shrinkage.shrunk,
        "shrunk_low": None if shrinkage is None else shrinkage.low,
        "shrunk_high": None if shrinkage is None else shrinkage.high,
    }


def _values(store: Store, cell: Cell, measure: Measure, seeds: range) -> FloatArray:
    found, _ = values_by_seed(store.rows(cell.key, seeds), measure, seeds)
    return _NOBODY if found is None else found[~np.isnan(found)]


def json_pieces(
    plan: SweepPlan, store: Store, standings: Standings, bests: list[Document], **more: Any
) -> Iterator[str]:
    """Yield the document piece by piece, with `more` entries at the end."""
    head = {
        "scenario": plan.scenario.id,
        "vary": [each.text for each in plan.variations],
        "settings": dict(plan.overrides),
        "episodes": plan.episodes,
        "first_seed": plan.first_seed,
        "runs": plan.runs,
        "random": plan.random,
        "measures": [{key: getattr(each, key) for key in _SAID} for each in MEASURES.values()],
        "measure": standings.measure.id,
        "like_best_by": standings.method,
    }
    yield f'{_text(head)[:-1]}, "cells": ['
    between = ""
    for each in results(plan, store):
        yield f"{between}{_text(each.as_json | {'like_best': standings.verdict(each.cell)})}"
        between = ", "
    reasons = [{**each.settings, "reason": each.reason} for each in standings.reasons]
    tail = {
        "skipped": {"cells": standings.skipped, "first": reasons},
        "best": bests[0] if len(bests) == 1 else None,
        "bests": bests,
        "sensitivity": sensitivities(plan, store, standings.measure),
        **more,
    }
    yield f"], {_text(tail)[1:]}\n"


def _text(document: Document) -> str:
    return json.dumps(document, allow_nan=False)
