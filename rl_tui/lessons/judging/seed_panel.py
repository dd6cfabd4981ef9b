"""Judging by new runs: replayed attempts, and conditions over many seeds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.setups import scenario_for
from rl_tui.lessons.file.view import Passed
from rl_tui.lessons.judging.condition_faults import MOST_STEPS_OF_A_SEED
from rl_tui.lessons.judging.conditions import JudgedTask, judged_task, program_verdict, verdict
from rl_tui.lessons.judging.measures import MEASURES, MissingError, Value
from rl_tui.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.lessons.judging.verdicts import (
    ConditionVerdict,
    KnownPanels,
    PanelProgress,
    PanelRequest,
    Panels,
    SeedValues,
    found_in_words,
    is_met,
)
from rl_tui.runs.background.child import bound_processor_time, let_others_go_first
from rl_tui.runs.changes import journal_of, read_change
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import JournalEntry, OrderSweep, Recipe, TakeAction, WorldChange, begin
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns, no_compiling, train

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Attempt, Condition
    from rl_tui.lessons.file.view import TaskView
    from rl_tui.lessons.lesson import Lesson


# Replayed runs


MOST_STEPS: Final = 20_000_000
"""Most steps of a replay, for attempts, evidence and branches."""


OnEnd = Callable[[Run, int], None]
"""Called with a finished run, and the number of its steps that count at most."""


def ignore_end(run: Run, most: int) -> None:
    """Ignore a finished run."""


def attempted_run(
    lesson: Lesson, page: str, attempt: Attempt, seed: int | None = None, on_end: OnEnd = ignore_end
) -> Run:
    """Replay an attempt, to its given length or until all its changes are made.

    `seed` replaces the setup's. `on_end` is called even if the run fails, and may raise. Raises UserError if
    the attempt does not fit, breaks down or is too long.
    """
    name = lesson.setup_of(page)
    setup = lesson.setups[name]
    recipe = recipe_for(
        scenario_for(lesson, name),
        {**setup.settings, **attempt.settings},
        setup.seed if seed is None else seed,
    )
    run = _new_run(recipe)
    try:
        changes = [read_change(each) for each in attempt.changes]
    except ValueError as fault:
        raise UserError(str(fault)) from fault
    journal = journal_of(changes, run.world.space.action_names)
    check_world_stays(journal)
    goal = Goal(steps=attempt.steps, episodes=attempt.episodes)
    if attempt.episodes is None and attempt.steps is None:
        goal = Goal(steps=max(map(_step_after, journal), default=0))

    def on_progress(done: int, wanted: int) -> None:
        if max(run.step, goal.steps or 0) > MOST_STEPS:
            raise UserError(f"it takes more than {MOST_STEPS:,} steps")

    try:
        train(run, goal, on_progress, journal)
    finally:
        on_end(run, MOST_STEPS)
    return run


def replayed(recipe: Recipe, journal: tuple[JournalEntry, ...], step: int) -> Run:
    """Replay a run to `step`. Raises UserError if it breaks down."""
    check_world_stays(journal)
    run = _new_run(recipe)
    train(run, Goal(steps=step), journal=journal)
    return run


def check_world_stays(journal: Iterable[JournalEntry]) -> None:
    """Raise UserError for a change of the lesson's world."""
    if any(isinstance(entry.change, WorldChange) for entry in journal):
        raise UserError("the world was changed, but this task needs the world of the lesson")


def _new_run(recipe: Recipe) -> Run:
    beginning = begin(recipe)
    return Run(recipe, beginning, evaluate=False, episode_limit=beginning.world.budget)


def _step_after(entry: JournalEntry) -> int:
    return entry.step + isinstance(entry.change, TakeAction | OrderSweep)


# Judging over many seeds


MOST_SECONDS: Final = 300
"""CPU-time limit of the process in seconds."""
OnSeed = Callable[[int, int, SeedValues], None]


def no_news(done: int, wanted: int, values: SeedValues) -> None:
    """Ignore progress."""


class _TooLongError(Exception):
    pass


def work(request: PanelRequest, tell: Callable[[PanelProgress, float], None]) -> None:
    """Report each seed and the verdicts in a background process."""
    bound_processor_time(MOST_SECONDS)
    known = len(request.known)
    seeds = list(request.known)

    def on_seed(done: int, wanted: int, values: SeedValues) -> None:
        if done == known + 1:  # before that, it may have waited for machine code
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
    """Check conditions over seeds from 0. Raises UserError if the world cannot be built.

    Conditions of equal length share their runs. `on_seed` receives (seeds done, seeds wanted, values of the
    last seed), `known` has values of the first seeds, and `on_end` is called with each run, and may raise.
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
    ):  # checked again, because the chunks of work decide if it was noticed on the way
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
    """Computes and caches conditions over seeds."""

    def __init__(self, on_end: OnEnd = ignore_end) -> None:
        self._known = KnownPanels()
        self._on_end = on_end

    waits = ""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return the verdict on each condition."""
        known = self._known.of(recipe, conditions)
        if known is None:
            known = worked_out(recipe, conditions, on_end=self._on_end)
            self._known.keep(recipe, conditions, known)
        return known


# Attempts at a task


def passes(
    lesson: Lesson, page: str, attempt: Attempt, seed: int | None = None, panels: Panels | None = None
) -> TaskView:
    """Judge `attempt` at the task of `page`. Raises UserError if it cannot be replayed.

    `passed` of the result is None if it fails. `seed` replaces the setup's. A program is watched, without a
    sandbox.
    """
    judged = judged_task(lesson, page, seed)
    if judged.task.program is not None and not attempt.claim:
        return judged_program(judged, attempt.program)
    run = attempted_run(lesson, page, attempt, seed)
    return (
        judged_claim(judged, run, panels) if attempt.claim else verdict(judged, run, panels or PanelsAtOnce())
    )


def judged_program(judged: JudgedTask, code: str) -> TaskView:
    """Run `code`, and judge it by a task."""
    from rl_tui.lessons.judging.seen_program import watched_code

    name = "" if judged.task.program is None else judged.task.program.file
    return program_verdict(judged, code, watched_code(code, name))


def judged_claim(judged: JudgedTask, run: Run, panels: Panels | None = None) -> TaskView:
    """Judge the claim that the task is impossible."""
    view = verdict(judged, run, panels or PanelsAtOnce())
    is_right = judged.task.proof is not None
    return replace(view, passed=Passed(judged.page, judged.setup, claim=True) if is_right else None)


def evidence_holds(
    lesson: Lesson, evidence: Passed, seed: int | None = None, panels: Panels | None = None
) -> TaskView:
    """Judge a task by repeating its evidence. Raises as `passes` and `judged_task` do."""
    judged = judged_task(lesson, evidence.page, seed)
    if evidence.claim:
        return judged_claim(judged, Run(judged.setup, evaluate=False), panels)
    if judged.task.program is not None:
        return judged_program(judged, evidence.program)
    run = replayed(evidence.recipe, evidence.journal, evidence.step)
    return verdict(judged, run, panels or PanelsAtOnce())
