"""Attempts at a task, recorded in a lesson or a session, replayed and judged."""

from __future__ import annotations

from dataclasses import replace

from rl_tui.common.errors import UserError
from rl_tui.lab.experiments.training import Goal, train
from rl_tui.lab.lessons.judging.conditions import JudgedTask, Panels, judged_task, program_verdict, verdict
from rl_tui.lab.lessons.lesson import Lesson
from rl_tui.lab.lessons.record import Passed
from rl_tui.lab.lessons.schema import Attempt
from rl_tui.lab.lessons.setups import scenario_for
from rl_tui.lab.lessons.view import TaskView
from rl_tui.lab.run.changes import journal_of, read_change
from rl_tui.lab.run.library import recipe_for
from rl_tui.lab.run.recipe import JournalEntry, OrderSweep, Recipe, TakeAction, begin
from rl_tui.lab.run.run import Run


def passes(
    lesson: Lesson, page: str, attempt: Attempt, seed: int | None = None, panels: Panels | None = None
) -> TaskView:
    """Return how ``attempt`` at the task of ``page`` is judged; ``passed`` of it is None where it fails.

    ``seed`` is another one than the setup's, for attempt and task. Raises UserError where it cannot be
    replayed: its settings or changes do not fit. A program is watched, whatever it may do.
    """
    judged = judged_task(lesson, page, seed)
    if judged.task.program is not None and not attempt.claim:
        return judged_program(judged, attempt.program)
    run = attempted_run(lesson, page, attempt, seed)
    return judged_claim(judged, run, panels) if attempt.claim else verdict(judged, run, panels)


def judged_program(judged: JudgedTask, code: str) -> TaskView:
    """Return how ``code``, which is run for it, is judged by a task that asks for a program."""
    from rl_tui.lab.lessons.programs.watching import watched_code

    name = "" if judged.task.program is None else judged.task.program.file
    return program_verdict(judged, code, watched_code(code, name))


def judged_claim(judged: JudgedTask, run: Run, panels: Panels | None = None) -> TaskView:
    """Return how the claim that the task cannot be done is judged, made where ``run`` stands."""
    view = verdict(judged, run, panels)
    is_right = judged.task.proof is not None
    return replace(view, passed=Passed(judged.page, judged.setup, claim=True) if is_right else None)


def evidence_holds(
    lesson: Lesson, evidence: Passed, seed: int | None = None, panels: Panels | None = None
) -> TaskView:
    """Return how the task of ``evidence`` stands when what it says was done is done again.

    Raises as :func:`passes` and :func:`~rl_tui.lab.lessons.judging.conditions.judged_task` do.
    """
    judged = judged_task(lesson, evidence.page, seed)
    if evidence.claim:
        return judged_claim(judged, Run(judged.setup, evaluate=False), panels)
    if judged.task.program is not None:
        return judged_program(judged, evidence.program)
    return verdict(judged, replayed(evidence.recipe, evidence.journal, evidence.step), panels)


def attempted_run(lesson: Lesson, page: str, attempt: Attempt, seed: int | None = None) -> Run:
    """Return the run that ``attempt`` comes to: as far as it says, else until all its changes are made.

    Raises UserError where a setting or a change does not fit, or a step breaks the run down.
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
    goal = Goal(steps=attempt.steps, episodes=attempt.episodes)
    if attempt.episodes is None and attempt.steps is None:
        goal = Goal(steps=max(map(_step_after, journal), default=0))
    train(run, goal, journal=journal)
    return run


def replayed(recipe: Recipe, journal: tuple[JournalEntry, ...], step: int) -> Run:
    """Return the run of ``recipe`` and ``journal`` at ``step``; raises UserError as :func:`passes` does."""
    run = _new_run(recipe)
    train(run, Goal(steps=step), journal=journal)
    return run


def _new_run(recipe: Recipe) -> Run:
    beginning = begin(recipe)
    return Run(recipe, beginning, evaluate=False, episode_limit=beginning.world.budget)


def _step_after(entry: JournalEntry) -> int:
    """Return the step at which ``entry`` has had its effect."""
    return entry.step + isinstance(entry.change, TakeAction | OrderSweep)
