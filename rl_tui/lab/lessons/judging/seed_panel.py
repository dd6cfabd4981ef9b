"""Conditions that many seeds decide, worked out: the same settings under seed 0, 1, 2 …"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.experiments.seeded_runs import SeededRuns, no_compiling
from rl_tui.lab.experiments.training import Goal
from rl_tui.lab.lessons.judging.condition_faults import MOST_STEPS_OF_A_SEED
from rl_tui.lab.lessons.judging.measures import MEASURES, MissingError, Value
from rl_tui.lab.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.lab.lessons.judging.panel_request import KnownPanels, PanelProgress, PanelRequest, SeedValues
from rl_tui.lab.lessons.judging.replays import OnEnd, ignore_end
from rl_tui.lab.lessons.judging.verdicts import ConditionVerdict, found_in_words, is_met
from rl_tui.lab.workers.answering import bound_processor_time, let_others_go_first

if TYPE_CHECKING:
    from rl_tui.lab.lessons.schema import Condition
    from rl_tui.lab.run.recipe import Recipe
    from rl_tui.lab.run.run import Run


MOST_SECONDS: Final = 300
"""Of a processor, in a process of its own."""
OnSeed = Callable[[int, int, SeedValues], None]


def no_news(done: int, wanted: int, values: SeedValues) -> None:
    """Ignore how many seeds are done."""


class _TooLongError(Exception):
    """A seed has come to more steps than it may take."""


def work(request: PanelRequest, tell: Callable[[PanelProgress, float], None]) -> None:
    """Tell what came of each seed, and the verdicts at the end; what a process of its own does."""
    bound_processor_time(MOST_SECONDS)
    known = len(request.known)
    seeds = list(request.known)

    def on_seed(done: int, wanted: int, values: SeedValues) -> None:
        if done == known + 1:  # until then it may have waited for machine code
            let_others_go_first()
        seeds.append(values)
        tell(PanelProgress(tuple(seeds), wanted), (done - known) / (wanted - known))

    verdicts = worked_out(request.recipe, request.conditions, on_seed, request.known)
    tell(PanelProgress(tuple(seeds), len(seeds), verdicts), 1.0)


def worked_out(
    recipe: Recipe,
    conditions: Sequence[Condition],
    on_seed: OnSeed = no_news,
    known: Sequence[SeedValues] = (),
    on_end: OnEnd = ignore_end,
) -> tuple[ConditionVerdict, ...]:
    """Return the verdict on each of ``conditions`` for runs of ``recipe`` under the seeds from 0.

    Those that go equally far share their runs. ``on_seed`` hears how many seeds of how many are done, and
    what came of the last one; ``known`` is what it heard of the first ones before, which are not run again.
    ``on_end`` hears of each run, and may raise. Raises UserError where the world cannot be built.
    """
    begun = replace(recipe, seed=0)
    order = sorted(range(len(conditions)), key=lambda place: _extent(conditions[place]))
    groups = [list(each) for _, each in groupby(order, key=lambda place: _extent(conditions[place]))]
    wanted = sum(conditions[group[0]].seeds for group in groups)
    found = dict[int, ConditionVerdict]()
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
            values.append(_of_seed(runs, seed, goal, [conditions[place] for place in group], on_end))
            done += 1
            on_seed(done, wanted, values[-1])
        for number, place in enumerate(group):
            found[place] = _over_seeds(conditions[place], [each[number] for each in values])
    return tuple(found[place] for place in range(len(conditions)))


def _extent(condition: Condition) -> tuple[int, int, int]:
    return condition.seeds, condition.episodes or 0, condition.steps or 0


def _of_seed(
    runs: SeededRuns, seed: int, goal: Goal, conditions: Sequence[Condition], on_end: OnEnd
) -> SeedValues:
    """Return what each of ``conditions`` measures of one seed; None where that has no value."""
    run = runs.new_run(seed)

    def on_progress(done: int, wanted: int) -> None:
        if run.step > MOST_STEPS_OF_A_SEED:
            raise _TooLongError

    try:
        runs.train(run, goal, on_progress)
    except (_TooLongError, UserError):
        return [None] * len(conditions)
    finally:
        on_end(run, MOST_STEPS_OF_A_SEED)
    if (
        run.step > MOST_STEPS_OF_A_SEED
    ):  # it depends on how the work was cut whether that was noticed on the way
        return [None] * len(conditions)
    kept = Kept()
    return [_measured(run, condition, kept) for condition in conditions]


def _measured(run: Run, condition: Condition, kept: Kept) -> Value | None:
    try:
        value = MEASURES[condition.measure].of(JudgedMoment(run, run.recipe, kept), condition)
    except MissingError:
        return None
    return value if isinstance(value, str | bool) else float(value)


def _over_seeds(condition: Condition, values: Sequence[Value | None]) -> ConditionVerdict:
    known = [value for value in values if value is not None]
    if not condition.mean:
        held = sum(is_met(condition, value) for value in known)
        return ConditionVerdict(held >= condition.hold, f"{held} of {condition.seeds} seeds")
    numbers = [value for value in known if not isinstance(value, str | bool)]
    if len(numbers) < len(values):
        return ConditionVerdict(
            False, f"{len(values) - len(numbers)} of {condition.seeds} seeds have no value"
        )
    mean = sum(numbers) / len(numbers)
    return ConditionVerdict(
        is_met(condition, mean), f"mean {found_in_words(condition, mean)} of {condition.seeds} seeds"
    )


class PanelsAtOnce:
    """Works them out where they are asked for, and remembers them; ``on_end`` hears of each run for that."""

    def __init__(self, on_end: OnEnd = ignore_end) -> None:
        self._known = KnownPanels()
        self._on_end = on_end

    waits = ""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return the verdict on each of ``conditions`` for runs of ``recipe``."""
        known = self._known.of(recipe, conditions)
        if known is None:
            known = worked_out(recipe, conditions, on_end=self._on_end)
            self._known.keep(recipe, conditions, known)
        return known
