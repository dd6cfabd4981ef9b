"""Figures of runs: of one, of an attempt recorded in the lesson, of many that differ in their seed."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lab.experiments.patience import cores
from rl_tui.lab.experiments.seeded_runs import SeededRuns, no_compiling
from rl_tui.lab.experiments.training import Goal, OnProgress, train
from rl_tui.lab.lessons.figures.expression import FigureError, SeedMean
from rl_tui.lab.lessons.figures.measuring import measured, measured_of_each
from rl_tui.lab.lessons.figures.subject import FigureSubject, name_of, whole
from rl_tui.lab.lessons.judging.replays import attempted_run
from rl_tui.lab.run.changes import journal_of, read_change
from rl_tui.lab.run.run import Run

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.measures import Value
    from rl_tui.lab.run.recipe import JournalEntry

LEAST_SEEDS: Final = 50
"""Of what is said about learning: fewer may say anything."""
MOST_SEEDS: Final = 10_000
MOST_STEPS: Final = 10**9
"""Of all runs of a figure together."""
MOST_STEPPED: Final = 10**7
"""Of an environment that is stepped for real, which takes its time."""
MOST_KEPT: Final = 4
"""Runs over seeds that are kept, of which other measures may be asked."""


def run(
    subject: FigureSubject,
    measure: object,
    steps: object = None,
    episodes: object = None,
    changes: Sequence[object] = (),
    **arguments: Any,
) -> Value:
    """Return a measure of one run under the setup's seed, after so many steps or episodes."""
    goal, journal = _goal(steps, episodes), _journal(subject, changes)
    key = "run", id(subject), goal, journal
    if key not in subject.known:
        made = Run(subject.recipe, None, evaluate=False)
        train(made, goal, _bounded(made, goal, 1), journal)
        subject.known[key] = made
    return measured(subject.known[key], _name(measure), arguments)


def attempt(subject: FigureSubject, page: object, name: object, measure: object, **arguments: Any) -> Value:
    """Return a measure at the end of an attempt, by its page and its name."""
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
    key = "attempt", id(lesson), wanted, called
    if key not in subject.known:
        subject.known[key] = attempted_run(lesson, wanted, attempts[called])
    return measured(subject.known[key], _name(measure), arguments)


def mean(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> SeedMean:
    """Return the mean of a measure over seeds 0, 1, …, with its standard error: written ``m ± e``."""
    values = _values(subject, measure, _many(seeds), arguments)
    return SeedMean(statistics.fmean(values), statistics.stdev(values) / math.sqrt(len(values)))


def error_of_mean(
    subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any
) -> float:
    """Return the standard error of that mean."""
    return mean(subject, measure, seeds, **arguments).error


def median(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the median of a measure over seeds 0, 1, …"""
    return statistics.median(_values(subject, measure, _many(seeds), arguments))


def least(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the least value of a measure over seeds 0, 1, …"""
    return min(_values(subject, measure, _many(seeds), arguments))


def greatest(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the greatest value of a measure over seeds 0, 1, …"""
    return max(_values(subject, measure, _many(seeds), arguments))


def share(subject: FigureSubject, measure: object, seeds: object = LEAST_SEEDS, **arguments: Any) -> float:
    """Return the share of seeds 0, 1, … in which a measure is ``at_least``, ``equals`` … what is given."""
    many = _many(seeds)
    return _holding(subject, measure, many, arguments) / many


def count(subject: FigureSubject, measure: object, seeds: object, **arguments: Any) -> int:
    """Return in how many of the seeds 0, 1, … that is so: of these seeds alone, be they few."""
    return _holding(subject, measure, whole(seeds, "seeds", 1, MOST_SEEDS), arguments)


def ahead(
    subject: FigureSubject,
    measure: object,
    these: object,
    those: object,
    seeds: object = LEAST_SEEDS,
    **arguments: Any,
) -> float:
    """Return the share of seeds in which a measure is greater with settings ``these`` than with ``those``."""
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
    """Return in how many seeds all the tests among ``arguments`` hold; what has no value passes none."""
    bounds = {name: arguments.pop(name) for name in TESTS if name in arguments}
    if not bounds:
        raise FigureError("no test", f"one of {', '.join(TESTS)}")
    every = _measured(subject, measure, seeds, arguments)
    try:
        return sum(
            value is not None and all(_TESTS[name](value, bound) for name, bound in bounds.items())
            for value in every
        )
    except TypeError as fault:  # a word, held against a number
        raise FigureError(
            f"{name_of(measure)} held against {shown(list(bounds.values()))}", "its kind"
        ) from fault


def _values(subject: FigureSubject, measure: object, seeds: int, arguments: dict[str, Any]) -> list[float]:
    every = _measured(subject, measure, seeds, arguments)
    missing = [seed for seed, value in enumerate(every) if not isinstance(value, int | float)]
    if missing:
        raise FigureError(
            f"no number of {name_of(measure)} under seed {missing[0]}", "a number under every seed"
        )
    return [float(value) for value in every if value is not None]


def _measured(
    subject: FigureSubject, measure: object, seeds: int, arguments: dict[str, Any]
) -> list[Value | None]:
    """Return the measure under each of the seeds 0 … seeds - 1."""
    rest = dict(arguments)
    goal = _goal(rest.pop("steps", None), rest.pop("episodes", None))
    journal = _journal(subject, rest.pop("changes", ()))
    name = _name(measure)
    key = "seeds", id(subject), goal, journal, seeds, name, repr(sorted(rest.items()))
    if key not in subject.known:
        subject.known[key] = measured_of_each(_runs(subject, goal, journal, seeds), name, rest)
    found: list[Value | None] = subject.known[key]
    return found


def _runs(subject: FigureSubject, goal: Goal, journal: tuple[JournalEntry, ...], seeds: int) -> list[Run]:
    """Return the runs of the seeds, on all cores; those of the last questions are kept for the next."""
    key = id(subject), goal, journal, seeds
    kept: dict[Any, list[Run]] = subject.known.setdefault("runs", {})
    if key in kept:
        return kept[key]
    seeded = SeededRuns(subject.with_seed(0), journal)
    _bounded(seeded.first, goal, seeds)  # before anything takes long
    seeded.get_machine_code(seeds, goal, no_compiling)

    def trained(seed: int) -> Run:
        made = seeded.new_run(seed)
        seeded.train(made, goal, _bounded(made, goal, seeds))
        return made

    with ThreadPoolExecutor(min(cores(), seeds), thread_name_prefix="figure") as pool:
        runs = list(pool.map(trained, range(seeds)))
    while len(kept) >= MOST_KEPT:
        kept.pop(next(iter(kept)))
    kept[key] = runs
    return runs


def _bounded(run: Run, goal: Goal, seeds: int) -> OnProgress:
    """Return what ends ``run``, one of so many, where all of them would take too many steps.

    Raises FigureError, at once where ``goal`` says so already.
    """
    in_all = MOST_STEPS if run.learner.rewindable else MOST_STEPPED
    most = in_all // seeds
    found = f"a run of more than {most:,} steps"
    expected = f"fewer: all runs of a figure together take at most {in_all:,}"
    if (goal.steps or 0) > most:
        raise FigureError(found, expected)

    def on_progress(done: int, wanted: int) -> None:
        if run.step > most:
            raise FigureError(found, expected)

    return on_progress


def _many(seeds: object) -> int:
    return whole(seeds, "seeds", LEAST_SEEDS, MOST_SEEDS)


def _name(measure: object) -> str:
    if not isinstance(measure, str):
        raise FigureError(shown(measure), "the name of a measure, in quotes")
    return measure


def _goal(steps: object, episodes: object) -> Goal:
    if (steps is None) == (episodes is None):
        raise FigureError("both or neither of steps and episodes", "how far a run goes: one of them")
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
