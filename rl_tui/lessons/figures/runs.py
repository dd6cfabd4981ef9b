"""Figures from a single run, a recorded attempt, or runs over many seeds."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lessons.figures.expression import FigureError, SeedMean
from rl_tui.lessons.figures.subject import FigureSubject, measured, measuring, name_of, whole
from rl_tui.lessons.judging.seed_panel import attempted_run
from rl_tui.runs.changes import journal_of, read_change
from rl_tui.runs.run import Run
from rl_tui.runs.training.compile_or_interpret import cores
from rl_tui.runs.training.many_runs import rows
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns, no_compiling, train

if TYPE_CHECKING:
    from rl_tui.lessons.judging.measures import Value
    from rl_tui.runs.recipe import JournalEntry

LEAST_SEEDS: Final = 50
"""Fewest seeds for statements about learning."""
MOST_SEEDS: Final = 10_000
MOST_STEPS: Final = 10**9
"""Limit of one run in steps or episodes. The budget limits all runs together."""
MOST_KEPT: Final = 4
"""Number of single runs that are cached for further metrics. For runs over seeds only metrics are cached."""


def run(
    subject: FigureSubject,
    measure: object,
    steps: object = None,
    episodes: object = None,
    changes: Sequence[object] = (),
    **arguments: Any,
) -> Value:
    """Return a metric of one run with the setup's seed, after a number of steps or episodes."""
    goal, journal = _goal(steps, episodes), _journal(subject, changes)

    def trained() -> Run:
        made = Run(subject.recipe, None, evaluate=False)
        with subject.budget.counted(made, journal, goal, 1) as watch:
            train(made, goal, watch(made), journal)
        return made

    made = _kept(subject, ("run", id(subject), goal, journal), trained)
    return measured(made, _name(measure), arguments)


def attempt(subject: FigureSubject, page: object, name: object, measure: object, **arguments: Any) -> Value:
    """Return a metric at the end of an attempt, by its page and its name."""
    lesson = subject.lesson
    tasks = {each.id: each for each in lesson.tasks}
    wanted = name_of(page)
    if wanted not in tasks:
        raise FigureError(shown(wanted), f"the id of a page with a task{near(wanted, tasks)}")
    task = tasks[wanted].task
    attempts = {each.name: each for each in (*task.accepts, *task.rejects)} if task else {}
    called = name_of(name)
    if called not in attempts:
        raise FigureError(shown(called), f"the name of an attempt of that task{near(called, attempts)}")
    made = _kept(
        subject,
        ("attempt", id(lesson), wanted, called),
        lambda: attempted_run(lesson, wanted, attempts[called], on_end=subject.budget.charge),
    )
    return measured(made, _name(measure), arguments)


def _kept(subject: FigureSubject, key: object, make: Callable[[], Run]) -> Run:
    kept: dict[object, Run] = subject.known.setdefault("runs", {})
    if key not in kept:
        made = make()
        while len(kept) >= MOST_KEPT:
            kept.pop(next(iter(kept)))
        kept[key] = made
    return kept[key]


def mean(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> SeedMean:
    """Return the mean of a metric over seeds 0, 1, …, with its standard error: written `m ± e`."""
    values = _values(subject, measure, _many(seeds), arguments)
    return SeedMean(statistics.fmean(values), statistics.stdev(values) / math.sqrt(len(values)))


def error_of_mean(
    subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any
) -> float:
    """Return the standard error of `mean`."""
    return mean(subject, measure, seeds, **arguments).error


def median(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the median of a metric over seeds 0, 1, …"""
    return statistics.median(_values(subject, measure, _many(seeds), arguments))


def least(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the smallest value of a metric over seeds 0, 1, …"""
    return min(_values(subject, measure, _many(seeds), arguments))


def greatest(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the largest value of a metric over seeds 0, 1, …"""
    return max(_values(subject, measure, _many(seeds), arguments))


def share(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the share of seeds 0, 1, … in which a metric is `at_least`, `equals` … a given value."""
    many = _many(seeds)
    return _holding(subject, measure, many, arguments) / many


def count(subject: FigureSubject, measure: object, seeds: object, **arguments: Any) -> int:
    """Return the number of seeds 0, 1, … in which the comparison of `share` is true. `seeds` may be small."""
    return _holding(subject, measure, whole(seeds, "seeds", 1, MOST_SEEDS), arguments)


def ahead(
    subject: FigureSubject,
    measure: object,
    these: object,
    those: object,
    seeds: object = LEAST_SEEDS,
    **arguments: Any,
) -> float:
    """Return the share of seeds in which a metric is larger with settings `these` than with `those`."""
    many = _many(seeds)
    one, other = (
        _values(subject.changed(_settings(each)), measure, many, arguments) for each in (these, those)
    )
    return sum(mine > its for mine, its in zip(one, other, strict=True)) / many


def _settings(value: object) -> dict[str, Any]:
    if not isinstance(value, dict) or not all(isinstance(name, str) for name in value):
        raise FigureError(shown(value), 'a table of settings, such as {"epsilon": 0}')
    return value


_TESTS: Final[dict[str, Callable[[Any, Any], bool]]] = {
    "at_least": lambda value, bound: value >= bound,
    "at_most": lambda value, bound: value <= bound,
    "above": lambda value, bound: value > bound,
    "below": lambda value, bound: value < bound,
    "equals": lambda value, bound: bool(value == bound),
}
TESTS: Final = tuple(_TESTS)


def _holding(subject: FigureSubject, measure: object, seeds: int, arguments: dict[str, Any]) -> int:
    """Count seeds in which all given tests are true. A missing value fails."""
    bounds = {name: arguments.pop(name) for name in TESTS if name in arguments}
    if not bounds:
        raise FigureError(f"the test is missing; add one of {', '.join(TESTS)}")
    every = _measured(subject, measure, seeds, arguments)
    try:
        return sum(
            value is not None and all(_TESTS[name](value, bound) for name, bound in bounds.items())
            for value in every
        )
    except TypeError as fault:  # a word compared with a number
        raise FigureError(
            f"{name_of(measure)} cannot be compared with {shown(list(bounds.values()))}; "
            "compare numbers with numbers, and words with words"
        ) from fault


def _values(subject: FigureSubject, measure: object, seeds: int, arguments: dict[str, Any]) -> list[float]:
    every = _measured(subject, measure, seeds, arguments)
    missing = [seed for seed, value in enumerate(every) if not isinstance(value, int | float)]
    if missing:
        raise FigureError(
            f"{name_of(measure)} has no number under seed {missing[0]}; "
            "choose a measure with a number under every seed"
        )
    return [float(value) for value in every if value is not None]


def _measured(
    subject: FigureSubject, measure: object, seeds: int, arguments: dict[str, Any]
) -> list[Value | None]:
    rest = dict(arguments)
    goal = _goal(rest.pop("steps", None), rest.pop("episodes", None))
    journal = _journal(subject, rest.pop("changes", ()))
    name = _name(measure)
    key = "seeds", id(subject), goal, journal, seeds, name, repr(sorted(rest.items()))
    if key not in subject.known:
        subject.known[key] = _of_each_seed(subject, goal, journal, seeds, measuring(name, rest))
    found: list[Value | None] = subject.known[key]
    return found


def _of_each_seed(
    subject: FigureSubject,
    goal: Goal,
    journal: tuple[JournalEntry, ...],
    seeds: int,
    measure: Callable[[Run], Value | None],
) -> list[Value | None]:
    seeded = SeededRuns(subject.with_seed(0), journal)
    with subject.budget.counted(seeded.first, journal, goal, seeds) as watch:
        seeded.get_machine_code(seeds, goal, no_compiling)
        return list(rows(seeded, range(seeds), goal, measure, watch=watch, workers=cores()))


def _many(seeds: object) -> int:
    return whole(seeds, "seeds", LEAST_SEEDS, MOST_SEEDS)


def _name(measure: object) -> str:
    if not isinstance(measure, str):
        raise FigureError(shown(measure), "the name of a measure, in quotes")
    return measure


def _goal(steps: object, episodes: object) -> Goal:
    if (steps is None) == (episodes is None):
        raise FigureError("the length of the run is not clear; give either steps or episodes")
    if steps is not None:
        return Goal(steps=whole(steps, "steps", 0, MOST_STEPS))
    return Goal(episodes=whole(episodes, "episodes", 0, MOST_STEPS))


def _journal(subject: FigureSubject, changes: object) -> tuple[JournalEntry, ...]:
    if not isinstance(changes, list | tuple) or not all(isinstance(each, str) for each in changes):
        raise FigureError(shown(changes), 'a list of changes, ["STEP:NAME=VALUE"]')
    try:
        texts = [read_change(str(each)) for each in changes]
    except ValueError as fault:
        raise UserError(str(fault)) from fault
    return journal_of(texts, subject.world.space.action_names)
