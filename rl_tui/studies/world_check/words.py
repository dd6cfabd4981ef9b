"""Texts of a world check."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final, NamedTuple

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.words import counted
from rl_tui.runs.answers.first_update_words import CHANCE_OF, number_in_words, wait_in_words
from rl_tui.studies.world_check.report import CheckStage, WorldReport
from rl_tui.worlds.mdp.space import FiniteSpace

NOT_KNOWN: Final = "not known"
_MOST_NAMED: Final = 12
_DECIMALS: Final = 5
_DIGITS: Final = 4

LABELS: Final[Mapping[str, str]] = {
    "random_return": "random policy",
    "best_return": "best policy",
    "shortest_way": "optimal path",
    "first_update": "first update",
    "flips": "flip points",
    "never_reached": "never reached",
    "endless_states": "no way out",
    "endless": "may never end",
}
"""Labels of the fields of a report, in order."""
_STAGES: Final[Mapping[str, CheckStage]] = {"flips": CheckStage.FLIPS, "endless": CheckStage.TRIALS}
"""Stage in which a field is computed, if not the first."""


class Row(NamedTuple):
    """One line about a `field`, without texts while pending."""

    field: str
    figure: str = ""
    remark: str = ""


def rows(
    report: WorldReport, space: FiniteSpace, gamma: float, name_of: Callable[[int], str] | None = None
) -> list[Row]:
    """Return a row for each of `LABELS`. `gamma` is for the shortest path."""
    name = name_of or space.state_names.__getitem__
    limit = f", within {counted(space.time_limit, 'step')}" if space.time_limit else ""
    best = "may use the clock" if limit else "per episode"
    said: dict[str, Callable[[], Row]] = {
        "random_return": lambda: Row("", _return(report.random_return), f"per episode{limit}"),
        "best_return": lambda: Row("", _return(report.best_return), best),
        "shortest_way": lambda: Row(
            "", counted(report.shortest_way or 0, "step"), f"the shortest for γ {gamma:g}"
        ),
        "first_update": lambda: Row("", _first_update(report)),
        "flips": lambda: Row("", _flips(report)),
        "never_reached": lambda: Row("", _some(report.never_reached, name)),
        "endless_states": lambda: Row("", _no_way_out(report, space, name)),
        "endless": lambda: Row("", *_endless(report, space)),
    }
    return [_row(report, field, said[field]) for field in LABELS]


def _row(report: WorldReport, field: str, known: Callable[[], Row]) -> Row:
    if field in report.unknown:
        return Row(field, NOT_KNOWN, report.unknown[field])
    is_known = getattr(report, field) is not None and report.stage > _STAGES.get(field, CheckStage.FIGURES)
    return known()._replace(field=field) if is_known else Row(field)


def warnings(report: WorldReport) -> tuple[str, ...]:
    """Return all warnings and reasons for unknown results."""
    return (*report.warnings, *(f"{LABELS[field]}: {reason}" for field, reason in report.unknown.items()))


def _return(value: float | None) -> str:
    assert value is not None
    text = f"{value:.{_DECIMALS}f}"
    return text.removeprefix("-") if not float(text) else text


def _first_update(report: WorldReport) -> str:
    assert report.first_update is not None
    return wait_in_words(report.first_update, _rounded).removeprefix(CHANCE_OF)


def _rounded(number: float) -> str:
    return number_in_words(float(f"{number:.3g}"))


def _flips(report: WorldReport) -> str:
    assert report.flips is not None
    if not report.flips:
        return "none: the same actions are optimal at every γ"
    at = ", ".join(f"{flip.gamma:.{_DIGITS}g}" for flip in report.flips[:_MOST_NAMED])
    more = ", …" if len(report.flips) > _MOST_NAMED else ""
    return f"the optimal actions change at γ {at}{more}"


def _some(states: Sequence[int] | None, name: Callable[[int], str]) -> str:
    assert states is not None
    if not states:
        return "no states"
    more = f" and {len(states) - _MOST_NAMED:,} more" if len(states) > _MOST_NAMED else ""
    return f"{counted(len(states), 'state')}: {', '.join(map(name, states[:_MOST_NAMED]))}{more}"


def _no_way_out(report: WorldReport, space: FiniteSpace, name: Callable[[int], str]) -> str:
    ended = _ended_by(space, "episodes there") if report.endless_states else ""
    return _some(report.endless_states, name) + ended


def _endless(report: WorldReport, space: FiniteSpace) -> tuple[str, str]:
    tried, found = report.tried, report.endless
    assert found is not None
    assert tried is not None
    if not tried.seeds:
        return "no policy", "every policy ends in this world"
    most = f"{tried.steps:,} steps"
    how = f"seeds {tried.seeds[0]}–{tried.seeds[-1]}: {counted(tried.episodes, 'episode')} or {most}"
    if tried.in_part:
        how += f"; {names(tried.in_part)} reached the limit of steps first"
    if not found:
        return "none found", how
    return f"greedy policies of {names(found)}{_ended_by(space, 'them')}", how


def _ended_by(space: FiniteSpace, what: str) -> str:
    return f"; the time limit of {counted(space.time_limit, 'step')} ends {what}" if space.time_limit else ""


def names(algorithms: Sequence[str]) -> str:
    """Return the names of `algorithms`."""
    if len(algorithms) == len(BY_ID):
        return "every algorithm"
    return ", ".join(BY_ID[algorithm].name for algorithm in algorithms)
