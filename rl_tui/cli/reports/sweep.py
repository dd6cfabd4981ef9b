"""The report of a sweep, for people."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from rl_tui.cli.output import alike, columns, number
from rl_tui.common.words import counted
from rl_tui.lab.sweeps.cell import settings_text
from rl_tui.lab.sweeps.document import result_of
from rl_tui.lab.sweeps.measures import Measure
from rl_tui.lab.sweeps.plan import SweepPlan
from rl_tui.lab.sweeps.ranking import Ranking
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.sweep import SweepProgress
from rl_tui.lab.sweeps.variation import written

SHOWN: Final = 10
_LIKE_BEST: Final = "="


def sweep_report(
    plan: SweepPlan, store: Store, ranking: Ranking, best: dict[str, Any] | None, done: SweepProgress
) -> str:
    """Return what a sweep came to: its best cells, and what to know of the others."""
    cells, runs = counted(plan.count, "cell"), counted(plan.runs, "run")
    parts = [f"{plan.scenario.title}: {cells}, {runs} each, seeds {plan.first_seed} to {plan.seeds[-1]}"]
    if ranking.skipped:
        parts.append(f"{counted(ranking.skipped, 'cell')} cannot work: {ranking.reasons[0].reason}")
    if ranking.best is None:
        return "\n".join([*parts, "", f"No run has the figure {ranking.measure.id}: take another --measure"])
    parts += ["", _table(plan, store, ranking), "", *_notes(ranking, done)]
    if best is not None and "again" in best:
        parts += [_again(plan, ranking, best["again"])]
    return "\n".join(parts)


def _table(plan: SweepPlan, store: Store, ranking: Ranking) -> str:
    """Return the best cells, a row each."""
    measure = ranking.measure
    shown = [result_of(plan, store, index) for index in ranking.first(SHOWN)]
    there = [each for each in shown if each is not None]
    figures = [each.summary.figures[measure.id] for each in there]
    texts = alike([each.get(key) for key in (_mean(measure), "low", "high", "median") for each in figures])
    columns_of_numbers = [texts[start::1][: len(there)] for start in range(0, len(texts), len(there))]
    rows = [
        (
            *map(written, each.cell.settings.values()),
            *numbers,
            str(each.summary.failed or ""),
            _LIKE_BEST if ranking.verdict(each.cell.index) else "",
        )
        for each, *numbers in zip(there, *columns_of_numbers, strict=True)
    ]
    head = (*plan.names, f"{measure.id}: mean", "95 % from", "to", "median", "failed", "")
    text = columns([head, *rows], right=range(len(plan.names), len(head) - 1))
    more = len(ranking.indexes) - len(there)
    return f"{text}\n... and {more:,} more: --json and --csv have all" if more else text


def _notes(ranking: Ranking, done: SweepProgress) -> list[str]:
    measure = ranking.measure
    notes = [f"{measure.id} is {measure.title}: {measure.formula}."]
    others = int(np.count_nonzero(ranking.alike)) - 1
    if int(np.count_nonzero(ranking.compared)) > 1:
        notes.append(
            f"{_LIKE_BEST} cannot be told from the best: {others:,} of {len(ranking.indexes) - 1:,} others "
            f"({ranking.method})."
        )
    else:
        notes.append("So few runs tell no cell from another for sure: --runs 10 or more would.")
    if done.failed:
        notes.append(f"{counted(done.failed, 'run')} broke down; a cell with one is not called best.")
    return notes


def _again(plan: SweepPlan, ranking: Ranking, again: dict[str, Any]) -> str:
    assert ranking.best is not None  # or it would not have been trained again
    measure = ranking.measure
    mean, shrunk = again[measure.id][_mean(measure)], again["shrunk"]
    first, last = again["first_seed"], again["first_seed"] + again["runs"] - 1
    settings = settings_text(ranking.best.settings)
    said = f"The best, {settings}, again on fresh seeds {first} to {last}: {number(mean)}"
    if shrunk is None:
        return f"{said}."
    low, high = again[measure.id]["low"], again[measure.id]["high"]
    interval = "" if low is None or high is None else f" ({number(low)} to {number(high)})"
    return f"{said}{interval}, {number(abs(shrunk))} {'worse' if shrunk > 0 else 'better'} than before."


def _mean(measure: Measure) -> str:
    return "restricted_mean" if measure.may_never_arrive else "mean"
