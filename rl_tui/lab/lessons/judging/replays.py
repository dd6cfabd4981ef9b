"""Runs made again: of an attempt that a lesson records, of the evidence of a pass."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.experiments.training import Goal, train
from rl_tui.lab.lessons.setups import scenario_for
from rl_tui.lab.run.changes import journal_of, read_change
from rl_tui.lab.run.library import recipe_for
from rl_tui.lab.run.recipe import JournalEntry, OrderSweep, Recipe, TakeAction, WorldChange, begin
from rl_tui.lab.run.run import Run

if TYPE_CHECKING:
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.lessons.schema import Attempt

MOST_STEPS: Final = 20_000_000
"""Of an attempt, of evidence or of a branch: what goes further is not replayed."""


OnEnd = Callable[[Run, int], None]
"""Hears of a run that went as far as it does, and how many steps of it count at most."""


def ignore_end(run: Run, most: int) -> None:
    """Ignore how far a run went."""


def attempted_run(
    lesson: Lesson, page: str, attempt: Attempt, seed: int | None = None, on_end: OnEnd = ignore_end
) -> Run:
    """Return the run that ``attempt`` comes to: as far as it says, else until all its changes are made.

    ``on_end`` hears of it even if it fails, and may raise. Raises UserError where a setting or a change does
    not fit, a step breaks the run down, or it goes too far.
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
            raise UserError(f"it goes on for more than {MOST_STEPS:,} steps")

    try:
        train(run, goal, on_progress, journal)
    finally:
        on_end(run, MOST_STEPS)
    return run


def replayed(recipe: Recipe, journal: tuple[JournalEntry, ...], step: int) -> Run:
    """Return the run of ``recipe`` and ``journal`` at ``step``; raises UserError where that breaks it."""
    check_world_stays(journal)
    run = _new_run(recipe)
    train(run, Goal(steps=step), journal=journal)
    return run


def check_world_stays(journal: Iterable[JournalEntry]) -> None:
    """Raise UserError where ``journal`` changes the world: a task is about the one that its lesson gives."""
    if any(isinstance(entry.change, WorldChange) for entry in journal):
        raise UserError("a lesson's world stays as it is, and here it was changed")


def _new_run(recipe: Recipe) -> Run:
    beginning = begin(recipe)
    return Run(recipe, beginning, evaluate=False, episode_limit=beginning.world.budget)


def _step_after(entry: JournalEntry) -> int:
    """Return the step at which ``entry`` has had its effect."""
    return entry.step + isinstance(entry.change, TakeAction | OrderSweep)
