"""The report of a sweep, for people."""

from __future__ import annotations

import heapq
from typing import Any, Final

from rl_tui.cli.output import alike, columns
from rl_tui.common.words import counted
from rl_tui.lab.sweeps.cell import settings_text
from rl_tui.lab.sweeps.document import CellResult, Overview, results
from rl_tui.lab.sweeps.measures import Measure
from rl_tui.lab.sweeps.plan import SweepPlan
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.sweep import SweepProgress
from rl_tui.lab.sweeps.variation import written

SHOWN: Final = 10


def sweep_report(
    plan: SweepPlan, store: Store, found: Overview, best: dict[str, Any] | None, done: SweepProgress
) -> str:
    """Return what a sweep came to: its best cells, and what to know of the others."""
    cells = counted(plan.count, "cell")
    parts = [f"{plan.scenario.title}: {cells}, {counted(plan.runs, 'run')} each, from seed {plan.first_seed}"]
    if done.skipped:
        parts.append(f"{counted(done.skipped, 'cell')} cannot work: {done.reasons[0]}")
    if done.failed:
        parts.append(f"{counted(done.failed, 'run')} broke down, and count in no mean")
    measure = found.measure
    parts += ["", _table(plan, store, measure)]
    if best is not None and "again" in best:
        parts += ["", _again(found, best["again"], measure)]
    return "\n".join(parts)


def _table(plan: SweepPlan, store: Store, measure: Measure) -> str:
    """Return the best cells, a row each."""
    name = "restricted_mean" if measure.may_never_arrive else "mean"

    def rank(result: CellResult) -> tuple[float, int]:
        mean = result.summary.figures[measure.id][name]
        score = float("-inf") if mean is None else mean if measure.larger_is_better else -mean
        return score, -result.cell.index

    shown = heapq.nlargest(SHOWN, results(plan, store), key=rank)
    figures = [each.summary.figures[measure.id] for each in shown]
    known = [[each.get(key) for each in figures] for key in (name, "low", "high", "median")]
    texts = [alike(each) for each in known]
    rows = [
        (*map(written, each.cell.settings.values()), *numbers, str(each.summary.failed or ""))
        for each, *numbers in zip(shown, *texts, strict=True)
    ]
    head = (*plan.names, measure.title, "from", "to", "median", "failed")
    return columns([head, *rows], right=range(len(plan.names), len(head)))


def _again(found: Overview, again: dict[str, Any], measure: Measure) -> str:
    assert found.best is not None  # or it would not have been trained again
    name = "restricted_mean" if measure.may_never_arrive else "mean"
    (mean,) = alike([again[measure.id][name]])
    (shrunk,) = alike([again["shrunk"]])
    return (
        f"The best, {settings_text(found.best.settings)}, trained again with seeds from "
        f"{again['first_seed']}: {measure.title} {mean}, which is {shrunk} worse"
    )
