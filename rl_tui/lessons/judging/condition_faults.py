"""Errors in a well-formed task: unknown names, and keys that do not fit together."""

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
    """Yield errors in the conditions and attempts of `task`, without its world."""
    watches = task.program is not None
    for number, condition in enumerate(task.conditions):
        yield from (each.inside("conditions", number) for each in condition_findings(condition))
        measure = MEASURES.get(condition.measure)
        if measure is not None and (measure.of_program is not None) != watches:
            expected = f"a measure of {'the program' if watches else 'the run: the task has no program'}"
            yield Finding(("conditions", number, "measure"), shown(measure.name), expected)
    for name, attempts in (("accepts", task.accepts), ("rejects", task.rejects)):
        for number, attempt in enumerate(attempts):
            yield from (each.inside(name, number) for each in attempt_findings(attempt))


def setting_findings(settings: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield settings that are unknown or have a wrong value."""
    for name, value in settings.items():
        finding = _setting_finding(name, value)
        if finding is not None:
            yield finding


def attempt_findings(attempt: Attempt) -> Iterator[Finding]:
    """Yield settings and changes of `attempt` that are impossible."""
    yield from (each.inside("settings") for each in setting_findings(attempt.settings))
    if attempt.steps is not None and attempt.episodes is not None:
        yield Finding(("episodes",), shown(attempt.episodes), "either steps or episodes, not both")
    for number, change in enumerate(attempt.changes):
        try:
            read_change(change)
        except ValueError as fault:
            why = str(fault).removeprefix(shown(change)).removeprefix(":").strip()
            yield Finding(("changes", number), shown(change), f"a possible change: {why}")


def prediction_findings(ask: Ask) -> Iterator[Finding]:
    """Yield errors in the metric that a prediction shows, without its world."""
    if ask.shows is None:
        return
    yield from (each.inside("shows") for each in _measure_findings(ask.shows))
    measure = MEASURES.get(ask.shows.measure)
    if measure is None:
        return
    if measure.of_program is not None:
        yield Finding(("shows", "measure"), shown(measure.name), "a measure of the run")
    elif ask.answer is not None and measure.gives not in (Gives.NUMBER, Gives.EITHER):
        expected = f"a measure that is a number, as the answer is: {measure.name} is {measure.gives}"
        yield Finding(("shows", "measure"), shown(measure.name), expected)


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
        expected = f"no at: {measure.name} is not a setting"
        yield Finding(("at",), shown(measured.at), expected)


def _near_measure(name: str) -> str:
    return near(name, MEASURES) or near(name.replace("-", "_"), MEASURES)


def _argument_findings(condition: Measured, measure: TaskMeasure) -> Iterator[Finding]:
    takes = " and ".join(measure.needs) or "none of them"
    for name in ARGUMENTS:
        value = getattr(condition, name)
        is_given = name in condition.model_fields_set
        if name in measure.needs and not is_given:
            yield Finding((name,), "nothing", f"{name}: the measure {measure.name} needs {takes}")
        elif is_given and name not in measure.needs:
            found = shown(list(value) if isinstance(value, tuple) else value)
            yield Finding((name,), found, f"no {name}: the measure {measure.name} needs {takes}")
        elif name == "actions" and is_given and len(value) != 2:
            yield Finding((name,), shown(list(value)), "a list of two actions")
    first, last = condition.first, condition.last
    if "last" in measure.needs and first is not None and last is not None:
        if not 1 <= first <= FIRST_EPISODES:
            yield Finding(("first",), shown(first), f"an episode, 1 to {FIRST_EPISODES}")
        elif not first <= last <= FIRST_EPISODES:
            yield Finding(("last",), shown(last), f"an episode, {first} to {FIRST_EPISODES}")


def _wanted_findings(condition: Condition, measure: TaskMeasure) -> Iterator[Finding]:
    """Yield values that `measure` cannot have."""
    if measure.gives in (Gives.TEXT, Gives.TRUTH):
        for name in _BOUNDS:
            if getattr(condition, name) is not None:
                expected = f"equals or one_of: {measure.name} is {measure.gives}"
                yield Finding((name,), shown(getattr(condition, name)), expected)
    wanted = {} if condition.equals is None else {("equals",): condition.equals}
    for place, value in [*wanted.items(), *((("one_of", n), v) for n, v in enumerate(condition.one_of))]:
        expected = _refused(measure, value)
        if expected:
            yield Finding(place, shown(value), expected)


def _refused(measure: TaskMeasure, value: float | str | bool) -> str:
    """Return the possible values of `measure` instead of `value`, or "" if it is possible."""
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
    """Yield keys that do not fit with seeds, or without them."""
    if not condition.seeds:
        for name in _OF_SEEDS:
            if name in condition.model_fields_set:
                yield Finding((name,), shown(getattr(condition, name)), f"no {name}, or a number of seeds")
        return
    if not measure.differs_by_seed:
        expected = f"no seeds: {measure.name} is the same in all of them"
        yield Finding(("seeds",), shown(condition.seeds), expected)
    if condition.mean and measure.gives is not Gives.NUMBER:
        yield Finding(("mean",), "true", f"no mean: {measure.name} is {measure.gives}")
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
        expected = f"algorithm or a hyper-parameter{near(name, names)}"
        return Finding((name,), "an unknown setting", expected)
    parameter = PARAMETERS[name]
    return None if parameter.accepts(value) else Finding((name,), shown(value), parameter.expected)
