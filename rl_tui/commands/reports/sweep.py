"""The report of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any, Final

import numpy as np

from rl_tui.commands.line.output import alike, columns, number
from rl_tui.common.words import counted
from rl_tui.runs.measures import Measure
from rl_tui.studies.sweeps.cells.variation import Value, written
from rl_tui.studies.sweeps.document import CellResult, Document, result_of
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.ranking import Ranking, Standings
from rl_tui.studies.sweeps.store import Store

SHOWN: Final = 10
MOST_WORLDS: Final = 20
WIDTH: Final = 100
_LIKE_BEST: Final = "="


def sweep_report(
    plan: SweepPlan, store: Store, standings: Standings, bests: Sequence[Document], failed: int
) -> str:
    """Return the report: the best cells (perhaps trained again), and notes on the others."""
    seeds = f"seeds {plan.first_seed} to {plan.seeds[-1]}" if plan.runs > 1 else f"seed {plan.first_seed}"
    head = f"{plan.scenario.title}: {counted(plan.count, 'cell')}, {counted(plan.runs, 'run')} each, {seeds}"
    parts = [head]
    if standings.skipped:
        parts.append(f"{counted(standings.skipped, 'cell')} cannot work: {standings.reasons[0].reason}")
    if not standings.bests:
        return "\n".join(
            [*parts, "", f"No run has the metric {standings.measure.id}: take another --measure"]
        )
    rankings = [each for each in standings.rankings.values() if each.best is not None]
    table = _cells(plan, store, standings, rankings[0]) if len(rankings) == 1 else ""
    parts += [
        "",
        table or _worlds(plan, store, standings, rankings),
        "",
        *_notes(standings, rankings, failed),
    ]
    parts += [_again(plan, standings.measure, each) for each in bests[:MOST_WORLDS] if "again" in each]
    return "\n".join(parts)


def sensitivity_report(sensitivities: Sequence[Document] | None) -> str:
    """Return how much each algorithm gains from its own settings per scenario, or ""."""
    if not sensitivities:
        return ""
    rows = [("algorithm", "own settings", "in common", "sensitivity", "held out", "best in common")]
    for each in sensitivities:
        scores = alike([each[name] for name in ("tuned", "in_common", "value", "held_out")])
        rows.append((each["algorithm"], *scores, _settings(each["common"])))
    said = (
        "Sensitivity: mean score with the best settings of each scenario, minus the mean score with one "
        "setting for all. A score of 0 is the random policy, 1 the best one."
    )
    return f"{fill(said, WIDTH)}\n\n{columns(rows, right=(1, 2, 3, 4))}"


def _cells(plan: SweepPlan, store: Store, standings: Standings, ranking: Ranking) -> str:
    shown = _there(plan, store, standings.first(ranking, SHOWN))
    tells = np.count_nonzero(ranking.compared) > 1
    verdicts = [_LIKE_BEST if tells and ranking.verdict(each.cell.index) else "" for each in shown]
    text = _table(plan, standings.measure, shown, ("", verdicts))
    more = len(ranking.indexes) - len(shown)
    return f"{text}\n... and {more:,} more: --json and --csv have all" if more else text


def _worlds(plan: SweepPlan, store: Store, standings: Standings, rankings: Sequence[Ranking]) -> str:
    indexes = [each.best.index for each in rankings[:MOST_WORLDS] if each.best is not None]
    shown = _there(plan, store, indexes)
    alike_each = [
        f"{int(np.count_nonzero(each.alike)) - 1:,} of {len(each.indexes) - 1:,}" for each in rankings
    ]
    text = _table(plan, standings.measure, shown, ("others like it", alike_each))
    more = len(rankings) - len(shown)
    return f"{text}\n... and {more:,} more worlds: --json has all" if more > 0 else text


def _there(plan: SweepPlan, store: Store, indexes: Sequence[int]) -> list[CellResult]:
    found = (result_of(plan, store, index) for index in indexes)
    return [each for each in found if each is not None]


def _table(
    plan: SweepPlan, measure: Measure, shown: Sequence[CellResult], last: tuple[str, Sequence[str]]
) -> str:
    figures = [each.summary.figures[measure.id] for each in shown]
    numbers = [alike([each[key] for each in figures]) for key in (*_means(measure), "median")]
    failed = [str(each.summary.failed or "") for each in shown]
    has_failed = any(failed)
    rows = [
        (*map(_setting, each.cell.settings.values()), *more)
        for each, *more in zip(shown, *numbers, *([failed] if has_failed else []), last[1], strict=False)
    ]
    head = (*plan.names, measure.id, "from", "to", "median", *(["failed"] if has_failed else []), last[0])
    return columns([head, *rows], right=range(len(plan.names), len(head) - 1))


def _setting(value: Value) -> str:
    return f"{value:.6g}" if isinstance(value, float) else written(value)


def _settings(values: Mapping[str, Value]) -> str:
    return " ".join(f"{name}={_setting(value)}" for name, value in values.items())


def _notes(standings: Standings, rankings: Sequence[Ranking], failed: int) -> list[str]:
    measure = standings.measure
    notes = [f"{measure.id}: {measure.formula}."]
    if measure.may_never_arrive:
        notes.append("Shown: mean of min(arrival, episodes), with its 95 % interval.")
    else:
        notes.append("Shown: mean over the runs, with its 95 % interval.")
    if len(rankings) > 1:
        notes.append("Returns of different worlds are not comparable: each world has its own best.")
    if all(len(each.indexes) == 1 for each in rankings):
        notes.append("Nothing to compare: each world has a single cell. Give --vary several values.")
    elif not any(int(np.count_nonzero(each.compared)) > 1 for each in rankings):
        notes.append("Too few runs to compare cells: use --runs 10 or more.")
    elif len(rankings) == 1:
        others, of = int(np.count_nonzero(rankings[0].alike)) - 1, len(rankings[0].indexes) - 1
        notes.append(
            f"{_LIKE_BEST} tied with the best: {others:,} of {of:,} other cells ({standings.method})."
        )
    if failed:
        notes.append(f"{counted(failed, 'run')} failed; cells with a failed run cannot be best.")
    return [fill(each, WIDTH) for each in notes]


def _again(plan: SweepPlan, measure: Measure, best: Mapping[str, Any]) -> str:
    again = best["again"]
    mean, low, high = (again[measure.id][name] for name in _means(measure))
    first, runs = again["first_seed"], again["runs"]
    seeds = f"seed {first}" if runs == 1 else f"seeds {first} to {first + runs - 1}"
    settings = _settings({name: best[name] for name in plan.names})
    said = f"The best, {settings}, again on fresh {seeds}: {number(mean)}"
    if low is not None and high is not None:
        said += f" ({number(low)} to {number(high)})"
    shrunk = again["shrunk"]
    if shrunk is not None:
        said += f", {number(abs(shrunk))} {'worse' if shrunk > 0 else 'better'} than when it was chosen"
    return fill(f"{said}.", WIDTH)


def _means(measure: Measure) -> tuple[str, str, str]:
    return (
        ("restricted_mean", "restricted_low", "restricted_high")
        if measure.may_never_arrive
        else ("mean", "low", "high")
    )
