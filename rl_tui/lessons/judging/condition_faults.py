"""Unknown names in a task, and keys that do not fit together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.findings import Finding, near, shown
from rl_tui.lessons.judging.measures import ARGUMENTS, MEASURES, Gives, MeasureKind, TaskMeasure
from rl_tui.runs.changes import read_change

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Ask, Attempt, Condition, Measured, Task

ALGORITHM: Final = "algorithm"
FIRST_EPISODES: Final = 100
"""Number of first episodes whose lengths are stored individually."""
MOST_STEPS_OF_A_SEED: Final = 2_000_000
"""Limit of steps for a condition over seeds. A seed that needs more for its episodes fails."""

_BOUNDS: Final = ("at_least", "at_most", "above", "below")
_OF_SEEDS: Final = ("hold", "mean", "episodes", "steps")


def task_findings(task: Task) -> Iterator[Finding]:
    """Yield errors in conditions and attempts, without the world."""
    watches = task.program is not None
    for number, condition in enumerate(task.conditions):
        yield from (each.inside("conditions", number) for each in condition_findings(condition))
        measure = MEASURES.get(condition.measure)
        if measure is not None and (measure.of_program is not None) != watches:
            found = (
                f"{measure.name} is not a measure of {'a program' if watches else 'a run'}; choose another"
            )
            yield Finding(("conditions", number, "measure"), found)
    for name, attempts in (("accepts", task.accepts), ("rejects", task.rejects)):
        for number, attempt in enumerate(attempts):
            yield from (each.inside(name, number) for each in attempt_findings(attempt))


def setting_findings(settings: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield unknown settings and wrong values."""
    for name, value in settings.items():
        finding = _setting_finding(name, value)
        if finding is not None:
            yield finding


def attempt_findings(attempt: Attempt) -> Iterator[Finding]:
    """Yield impossible settings and changes."""
    yield from (each.inside("settings") for each in setting_findings(attempt.settings))
    if attempt.steps is not None and attempt.episodes is not None:
        yield Finding(("episodes",), "steps and episodes are both set; keep one of them")
    for number, change in enumerate(attempt.changes):
        try:
            read_change(change)
        except ValueError as fault:
            why = str(fault).removeprefix(shown(change)).removeprefix(":").strip()
            yield Finding(("changes", number), f"{shown(change)}: {why}")


def prediction_findings(ask: Ask) -> Iterator[Finding]:
    """Yield errors in the metric that a prediction shows."""
    if ask.shows is None:
        return
    yield from (each.inside("shows") for each in _measure_findings(ask.shows))
    measure = MEASURES.get(ask.shows.measure)
    if measure is None:
        return
    if measure.of_program is not None:
        yield Finding(("shows", "measure"), f"{measure.name} is not a measure of a run; choose another")
    elif ask.answer is not None and measure.gives not in (Gives.NUMBER, Gives.EITHER):
        found = f"{measure.name} is {measure.gives}, but the answer is a number; choose another measure"
        yield Finding(("shows", "measure"), found)


def condition_findings(condition: Condition) -> Iterator[Finding]:
    """Yield errors of `condition`, without its world."""
    yield from _measure_findings(condition)
    measure = MEASURES.get(condition.measure)
    if measure is not None:
        yield from _wanted_findings(condition, measure)
        yield from _seed_findings(condition, measure)


def _measure_findings(measured: Measured) -> Iterator[Finding]:
    measure = MEASURES.get(measured.measure)
    if measure is None:
        expected = f"the name of a measure{_near_measure(measured.measure)}"
        yield Finding(("measure",), shown(measured.measure), expected)
        return
    yield from _argument_findings(measured, measure)
    if measured.at == "start" and measure.kind is not MeasureKind.SETTING:
        yield Finding(("at",), f"at works only with a setting, unlike {measure.name}; leave out at")


def _near_measure(name: str) -> str:
    return near(name, MEASURES) or near(name.replace("-", "_"), MEASURES)


def _argument_findings(condition: Measured, measure: TaskMeasure) -> Iterator[Finding]:
    takes = " and ".join(measure.needs) or "no arguments"
    for name in ARGUMENTS:
        value = getattr(condition, name)
        is_given = name in condition.model_fields_set
        if name in measure.needs and not is_given:
            yield Finding((name,), f"missing; add {name}, because the measure {measure.name} needs {takes}")
        elif is_given and name not in measure.needs:
            yield Finding((name,), f"the measure {measure.name} takes {takes}; leave out {name}")
        elif name == "actions" and is_given and len(value) != 2:
            yield Finding((name,), shown(list(value)), "a list of two actions")
    first, last = condition.first, condition.last
    if "last" in measure.needs and first is not None and last is not None:
        if not 1 <= first <= FIRST_EPISODES:
            yield Finding(("first",), shown(first), f"an episode, 1 to {FIRST_EPISODES}")
        elif not first <= last <= FIRST_EPISODES:
            yield Finding(("last",), shown(last), f"an episode, {first} to {FIRST_EPISODES}")


def _wanted_findings(condition: Condition, measure: TaskMeasure) -> Iterator[Finding]:
    if measure.gives in (Gives.TEXT, Gives.TRUTH):
        for name in _BOUNDS:
            if getattr(condition, name) is not None:
                found = f"{measure.name} is {measure.gives}; use equals or one_of instead of {name}"
                yield Finding((name,), found)
    wanted = {} if condition.equals is None else {("equals",): condition.equals}
    for place, value in [*wanted.items(), *((("one_of", n), v) for n, v in enumerate(condition.one_of))]:
        expected = _refused(measure, value)
        if expected:
            yield Finding(place, shown(value), expected)


def _refused(measure: TaskMeasure, value: float | str | bool) -> str:
    if measure.kind is MeasureKind.SETTING:
        finding = _setting_finding(measure.name, value)
        return "" if finding is None else finding.expected
    if isinstance(value, bool) != (measure.gives is Gives.TRUTH):
        return str(measure.gives)
    if isinstance(value, str) != (measure.gives is Gives.TEXT):
        return str(measure.gives)
    if measure.accepts and value not in measure.accepts:
        return f"one of {', '.join(measure.accepts)}{near(str(value), measure.accepts)}"
    return ""


def _seed_findings(condition: Condition, measure: TaskMeasure) -> Iterator[Finding]:
    if not condition.seeds:
        for name in _OF_SEEDS:
            if name in condition.model_fields_set:
                yield Finding((name,), f"{name} works only with seeds; add seeds, or leave out {name}")
        return
    if not measure.differs_by_seed:
        yield Finding(("seeds",), f"{measure.name} is the same for every seed; leave out seeds")
    if condition.mean and measure.gives is not Gives.NUMBER:
        yield Finding(("mean",), f"{measure.name} is {measure.gives}, which has no mean; leave out mean")
    if condition.steps is not None and not 1 <= condition.steps <= MOST_STEPS_OF_A_SEED:
        yield Finding(("steps",), shown(condition.steps), f"1 to {MOST_STEPS_OF_A_SEED:,} steps of each seed")
    if condition.episodes is not None and not 1 <= condition.episodes <= MOST_STEPS_OF_A_SEED:
        expected = f"1 to {MOST_STEPS_OF_A_SEED:,} episodes of each seed"
        yield Finding(("episodes",), shown(condition.episodes), expected)


def _setting_finding(name: str, value: object) -> Finding | None:
    if name == ALGORITHM:
        known = isinstance(value, str) and value in BY_ID
        expected = f"one of {', '.join(BY_ID)}{near(str(value), BY_ID)}"
        return None if known else Finding((name,), shown(value), expected)
    if name not in PARAMETERS:
        names = (ALGORITHM, *PARAMETERS)
        return Finding((name,), f"unknown setting; use algorithm or a hyperparameter{near(name, names)}")
    parameter = PARAMETERS[name]
    return None if parameter.accepts(value) else Finding((name,), shown(value), parameter.expected)
