"""Conditions that many seeds decide, worked out: the same settings under seed 0, 1, 2 …"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Final, TypeVar

from rl_tui.common.errors import UserError
from rl_tui.lab.experiments.seeded_runs import SeededRuns, no_compiling
from rl_tui.lab.experiments.training import Goal
from rl_tui.lab.lessons.judging.condition_faults import MOST_STEPS_OF_A_SEED
from rl_tui.lab.lessons.judging.conditions import Verdict, in_words, is_met
from rl_tui.lab.lessons.judging.measures import MEASURES, MissingError, Value
from rl_tui.lab.lessons.judging.moment import Kept, Moment
from rl_tui.lab.lessons.schema import Condition
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.run.run import Run

KEPT: Final = 64
"""Settings of which the verdicts are remembered."""

SeedValues = list[Value | None]
"""What each of the conditions that share a run measures of one seed; None where that has no value."""
OnSeed = Callable[[int, int, SeedValues], None]


def no_news(done: int, wanted: int, values: SeedValues) -> None:
    """Ignore how many seeds are done."""


class _TooLongError(Exception):
    """A seed has come to more steps than it may take."""


def worked_out(
    recipe: Recipe,
    conditions: Sequence[Condition],
    on_seed: OnSeed = no_news,
    known: Sequence[SeedValues] = (),
) -> tuple[Verdict, ...]:
    """Return the verdict on each of ``conditions`` for runs of ``recipe`` under the seeds from 0.

    Those that go equally far share their runs. ``on_seed`` hears how many seeds of how many are done, and
    what came of the last one; ``known`` is what it heard of the first ones before, which are not run again.
    Raises UserError where the world cannot be built.
    """
    begun = replace(recipe, seed=0)
    order = sorted(range(len(conditions)), key=lambda place: _extent(conditions[place]))
    groups = [list(each) for _, each in groupby(order, key=lambda place: _extent(conditions[place]))]
    wanted = sum(conditions[group[0]].seeds for group in groups)
    found = dict[int, Verdict]()
    done = 0
    for group in groups:
        first = conditions[group[0]]
        goal = Goal(steps=first.steps, episodes=first.episodes)
        runs = SeededRuns(begun)
        values = list(known[done : done + first.seeds])
        done += len(values)
        if len(values) < first.seeds:
            runs.get_machine_code(first.seeds - len(values), goal, no_compiling)
        for seed in range(len(values), first.seeds):
            values.append(_of_seed(runs, seed, goal, [conditions[place] for place in group]))
            done += 1
            on_seed(done, wanted, values[-1])
        for number, place in enumerate(group):
            found[place] = _over_seeds(conditions[place], [each[number] for each in values])
    return tuple(found[place] for place in range(len(conditions)))


def _extent(condition: Condition) -> tuple[int, int, int]:
    return condition.seeds, condition.episodes or 0, condition.steps or 0


def _of_seed(runs: SeededRuns, seed: int, goal: Goal, conditions: Sequence[Condition]) -> SeedValues:
    """Return what each of ``conditions`` measures of one seed; None where that has no value."""
    run = runs.new_run(seed)

    def on_progress(done: int, wanted: int) -> None:
        if run.step > MOST_STEPS_OF_A_SEED:
            raise _TooLongError

    try:
        runs.train(run, goal, on_progress)
    except (_TooLongError, UserError):
        return [None] * len(conditions)
    if (
        run.step > MOST_STEPS_OF_A_SEED
    ):  # it depends on how the work was cut whether that was noticed on the way
        return [None] * len(conditions)
    kept = Kept()
    return [_measured(run, condition, kept) for condition in conditions]


def _measured(run: Run, condition: Condition, kept: Kept) -> Value | None:
    try:
        value = MEASURES[condition.measure].of(Moment(run, run.recipe, kept), condition)
    except MissingError:
        return None
    return value if isinstance(value, str | bool) else float(value)


def _over_seeds(condition: Condition, values: Sequence[Value | None]) -> Verdict:
    known = [value for value in values if value is not None]
    if not condition.mean:
        held = sum(is_met(condition, value) for value in known)
        return Verdict(held >= condition.hold, f"{held} of {condition.seeds} seeds")
    numbers = [value for value in known if not isinstance(value, str | bool)]
    if len(numbers) < len(values):
        return Verdict(False, f"{len(values) - len(numbers)} of {condition.seeds} seeds have no value")
    mean = sum(numbers) / len(numbers)
    return Verdict(is_met(condition, mean), f"mean {in_words(mean)} of {condition.seeds} seeds")


class PanelsAtOnce:
    """Works them out where they are asked for, and remembers them."""

    def __init__(self) -> None:
        self._known = KnownPanels()

    waits = ""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[Verdict]:
        """Return the verdict on each of ``conditions`` for runs of ``recipe``."""
        known = self._known.of(recipe, conditions)
        if known is None:
            known = worked_out(recipe, conditions)
            self._known.keep(recipe, conditions, known)
        return known


class KnownPanels:
    """The verdicts of the last settings that were asked for, and the seeds that are done where they lack."""

    def __init__(self) -> None:
        self._verdicts: list[tuple[_Panel, tuple[Verdict, ...]]] = []
        self._seeds: list[tuple[_Panel, tuple[SeedValues, ...]]] = []

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[Verdict, ...] | None:
        """Return what is known of ``conditions`` for runs of ``recipe``, None where that is nothing."""
        return _of(self._verdicts, (recipe, conditions))

    def keep(self, recipe: Recipe, conditions: tuple[Condition, ...], verdicts: tuple[Verdict, ...]) -> None:
        """Remember ``verdicts``; of very many, the oldest are forgotten."""
        self._verdicts = [*self._verdicts, ((recipe, conditions), verdicts)][-KEPT:]

    def seeds_of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> tuple[SeedValues, ...]:
        """Return what came of the seeds that were done when the work on them ended."""
        return _of(self._seeds, (recipe, conditions)) or ()

    def keep_seeds(
        self, recipe: Recipe, conditions: tuple[Condition, ...], seeds: tuple[SeedValues, ...]
    ) -> None:
        """Remember what came of the first seeds."""
        others = [each for each in self._seeds if not same_panel(*each[0], recipe, conditions)]
        self._seeds = [*others, ((recipe, conditions), seeds)][-KEPT:]


_Panel = tuple[Recipe, tuple[Condition, ...]]
_Of = TypeVar("_Of")


def _of(kept: Sequence[tuple[_Panel, _Of]], panel: _Panel) -> _Of | None:
    return next((known for other, known in kept if same_panel(*other, *panel)), None)


def same_panel(one: Recipe, its: tuple[Condition, ...], other: Recipe, others: tuple[Condition, ...]) -> bool:
    """Return whether both ask for the same runs and the same conditions, whatever seed the recipes have."""
    return (
        one.algorithm == other.algorithm
        and one.hyperparameters == other.hyperparameters
        and (one.scenario is other.scenario or one.scenario.section == other.scenario.section)
        and (its is others or its == others)
    )
