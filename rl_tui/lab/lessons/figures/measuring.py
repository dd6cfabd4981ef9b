"""A measure of a run in a figure, by the names that conditions of tasks have for them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.findings import near, shown
from rl_tui.lab.lessons.figures.expression import FigureError
from rl_tui.lab.lessons.figures.subject import name_of, whole
from rl_tui.lab.lessons.judging.measures import MEASURES, MissingError, Value
from rl_tui.lab.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.lab.lessons.schema import MOST_STEPS, Condition

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run

ARGUMENTS: Final = ("state", "action", "actions", "first", "last", "at")
"""What some measures take besides."""


def measured(run: Run, measure: str, arguments: Mapping[str, Any]) -> Value:
    """Return a measure of ``run`` where it stands. Raises FigureError where it has no value."""
    condition = _condition(measure, arguments)
    try:
        return MEASURES[measure].of(JudgedMoment(run, run.recipe, Kept()), condition)
    except MissingError as reason:
        raise FigureError(f"{measure}: {reason}", "a measure that has a value at that step") from reason


def measuring(measure: str, arguments: Mapping[str, Any]) -> Callable[[Run], Value | None]:
    """Return what measures any run, from several threads if need be: None where there is no value."""
    condition = _condition(measure, arguments)
    in_turn, kept = threading.Lock(), Kept()

    def of_run(run: Run) -> Value | None:
        with in_turn:
            try:
                return MEASURES[measure].of(JudgedMoment(run, run.recipe, kept), condition)
            except MissingError:
                return None

    return of_run


def _condition(measure: str, arguments: Mapping[str, Any]) -> Condition:
    """Return a condition that measures so; what it asks for does not count."""
    row = MEASURES.get(measure)
    if row is None:
        raise FigureError(shown(measure), f"the name of a measure{near(measure, MEASURES)}")
    missing = [name for name in row.needs if name not in arguments]
    if missing:
        raise FigureError(f"{measure} without {missing[0]}", f"{measure} with {', '.join(row.needs)}")
    given: dict[str, Any] = dict(arguments)
    for name in ("state", "action", "at"):
        if name in given:
            given[name] = name_of(given[name])
    for name in ("first", "last"):
        if name in given:
            given[name] = whole(given[name], name, 0, MOST_STEPS)
    if "actions" in given:
        actions = given["actions"]
        if not isinstance(actions, list) or len(actions) != 2:
            raise FigureError(f"actions = {shown(actions)}", "a list of two actions")
        given["actions"] = [name_of(each) for each in actions]
    try:
        return Condition.model_validate({"text": measure, "measure": measure, "equals": 0.0, **given})
    except ValueError as fault:
        raise FigureError(shown(str(arguments)), f"arguments of {measure}") from fault
