"""The results of a sweep: the document of ``sweep --json``, cell by cell, in the order of the plan."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, Final

from rl_tui.lab.sweeps.cell import Cell, SkippedCell
from rl_tui.lab.sweeps.measures import JUDGED_BY, MEASURES, Measure
from rl_tui.lab.sweeps.plan import WHOLE, Shard, SweepPlan
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.summaries import CellSummary, score_of, summarized

_MOST_REASONS: Final = 20


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


def results(plan: SweepPlan, store: Store, shard: Shard = WHOLE) -> Iterator[CellResult]:
    """Yield each cell of ``plan`` that ``store`` has runs of, in the order of the plan, one at a time."""
    for index in sorted(plan.order(shard)) if shard != WHOLE else range(plan.count):
        cell = plan.cell(index)
        if isinstance(cell, Cell):
            summary = summarized(store.rows(cell.key, plan.seeds))
            if summary.runs:
                yield CellResult(cell, summary)


@dataclass(frozen=True)
class Overview:
    """What a look at all cells tells."""

    measure: Measure
    """By which they are compared."""
    best: Cell | None
    """The best of them, the first of equals; None where none has the measure."""
    skipped: int
    """How many cells cannot work."""
    reasons: tuple[SkippedCell, ...]
    """The first of these."""


def overview(plan: SweepPlan, store: Store, measure: Measure | None = None) -> Overview:
    """Return the best cell by ``measure``; without one by the first of the usual ones that any run has."""
    wanted = [measure] if measure is not None else [MEASURES[name] for name in JUDGED_BY]
    best: dict[str, tuple[float, Cell]] = {}
    count, reasons = 0, list[SkippedCell]()
    for index in range(plan.count):
        cell = plan.cell(index)
        if isinstance(cell, SkippedCell):
            count += 1
            if len(reasons) < _MOST_REASONS:
                reasons.append(cell)
            continue
        rows = list(store.rows(cell.key, plan.seeds))
        for each in wanted:
            score = score_of(rows, each)
            if score is not None and (each.id not in best or score > best[each.id][0]):
                best[each.id] = score, cell
    chosen = next((each for each in wanted if each.id in best), wanted[0])
    return Overview(chosen, best[chosen.id][1] if chosen.id in best else None, count, tuple(reasons))


def fresh_seeds(plan: SweepPlan) -> range:
    """Return as many seeds as each cell has, none of them among those."""
    return range(plan.first_seed + plan.runs, plan.first_seed + 2 * plan.runs)


def best_document(found: Overview, plan: SweepPlan, store: Store, *, again: bool) -> dict[str, Any] | None:
    """Return the best cell as JSON, and with ``again`` what it came to on fresh seeds.

    By those nobody chose it: ``shrunk`` is by how much its mean is worse there.
    """
    if found.best is None:
        return None
    first, fresh = (list(store.rows(found.best.key, seeds)) for seeds in (plan.seeds, fresh_seeds(plan)))
    document = CellResult(found.best, summarized(first)).as_json
    if again:
        before, after = (score_of(rows, found.measure) for rows in (first, fresh))
        summary = summarized(fresh)
        document["again"] = {
            "first_seed": fresh_seeds(plan).start,
            "runs": summary.runs,
            "failed": summary.failed,
            **summary.figures,
            "shrunk": None if before is None or after is None else before - after,
        }
    return document


def json_pieces(
    plan: SweepPlan, store: Store, found: Overview, best: dict[str, Any] | None, **more: Any
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
        "measure": found.measure.id,
    }
    yield f'{_text(head)[:-1]}, "cells": ['
    between = ""
    for each in results(plan, store):
        yield f"{between}{_text(each.as_json)}"
        between = ", "
    reasons = [{**each.settings, "reason": each.reason} for each in found.reasons]
    tail = {"skipped": {"cells": found.skipped, "first": reasons}, "best": best, **more}
    yield f"], {_text(tail)[1:]}\n"


def _text(document: dict[str, Any]) -> str:
    return json.dumps(document, allow_nan=False)
