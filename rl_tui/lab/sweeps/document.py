"""The results of a sweep: the document of ``sweep --json``, cell by cell, in the order of the plan."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from rl_tui.lab.sweeps.cell import Cell
from rl_tui.lab.sweeps.measures import MEASURES
from rl_tui.lab.sweeps.plan import SweepPlan
from rl_tui.lab.sweeps.ranking import Ranking
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.summaries import CellSummary, mean_of, summarized


@dataclass(frozen=True)
class CellResult:
    """A cell, and what its runs say together."""

    cell: Cell
    summary: CellSummary

    @property
    def as_json(self) -> dict[str, Any]:
        """It as a document has it: settings, runs, failed, and each measure."""
        summary = self.summary
        return {**self.cell.settings, "runs": summary.runs, "failed": summary.failed, **summary.figures}


def results(plan: SweepPlan, store: Store) -> Iterator[CellResult]:
    """Yield each cell of ``plan`` that ``store`` has runs of, in the order of the plan, one at a time."""
    for index in range(plan.count):
        found = result_of(plan, store, index)
        if found is not None:
            yield found


def result_of(plan: SweepPlan, store: Store, index: int) -> CellResult | None:
    """Return cell ``index`` of ``plan``; None where it cannot work, or ``store`` has no run of it."""
    cell = plan.cell(index)
    if not isinstance(cell, Cell):
        return None
    summary = summarized(store.rows(cell.key, plan.seeds))
    return CellResult(cell, summary) if summary.runs else None


def fresh_seeds(plan: SweepPlan) -> range:
    """Return as many seeds as each cell has, none of them among those."""
    return range(plan.first_seed + plan.runs, plan.first_seed + 2 * plan.runs)


def best_document(ranking: Ranking, plan: SweepPlan, store: Store, *, again: bool) -> dict[str, Any] | None:
    """Return the best cell as JSON, and with ``again`` what it came to on fresh seeds.

    By those nobody chose it: ``shrunk`` is by how much its mean is worse there.
    """
    cell, measure = ranking.best, ranking.measure
    if cell is None:
        return None
    document = CellResult(cell, summarized(store.rows(cell.key, plan.seeds))).as_json
    if again:
        fresh = fresh_seeds(plan)
        before, after = (
            mean_of(store.rows(cell.key, seeds), measure, seeds) for seeds in (plan.seeds, fresh)
        )
        summary = summarized(store.rows(cell.key, fresh))
        sign = 1.0 if measure.larger_is_better else -1.0
        document["again"] = {
            "first_seed": fresh.start,
            "runs": summary.runs,
            "failed": summary.failed,
            **summary.figures,
            "shrunk": None if before is None or after is None else sign * (before - after),
        }
    return document


def json_pieces(
    plan: SweepPlan, store: Store, ranking: Ranking, best: dict[str, Any] | None, **more: Any
) -> Iterator[str]:
    """Yield the document in pieces, so that it is never in memory as a whole.

    ``best`` is what :func:`best_document` returned, ``more`` what else stands at the end.
    """
    head = {
        "scenario": plan.scenario.id,
        "vary": [each.text for each in plan.variations],
        "first_seed": plan.first_seed,
        "runs": plan.runs,
        "measures": [asdict(each) for each in MEASURES.values()],
        "measure": ranking.measure.id,
        "like_best_by": ranking.method,
    }
    yield f'{_text(head)[:-1]}, "cells": ['
    between = ""
    for each in results(plan, store):
        yield f"{between}{_text(each.as_json | {'like_best': ranking.verdict(each.cell.index)})}"
        between = ", "
    reasons = [{**each.settings, "reason": each.reason} for each in ranking.reasons]
    tail = {"skipped": {"cells": ranking.skipped, "first": reasons}, "best": best, **more}
    yield f"], {_text(tail)[1:]}\n"


def _text(document: dict[str, Any]) -> str:
    return json.dumps(document, allow_nan=False)
