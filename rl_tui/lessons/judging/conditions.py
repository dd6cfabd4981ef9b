"""The check of a task's conditions at one step, exact and equal for run and replay."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import ConditionView, Passed, TaskView
from rl_tui.lessons.judging.measures import MEASURES, MissingError, NoMomentError, NotYetError
from rl_tui.lessons.judging.verdicts import ConditionVerdict, Panels, found_in_words, is_met

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rl_tui.lessons.file.schema import Condition, Task
    from rl_tui.lessons.judging.moment import JudgedMoment, Kept
    from rl_tui.lessons.judging.seen_program import SeenProgram
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.run import Run


@dataclass(frozen=True, slots=True, eq=False)
class JudgedTask:
    """The task of a page with the recipe of its run."""

    page: str
    task: Task
    setup: Recipe


def judged_task(lesson: Lesson, page: str, seed: int | None = None) -> JudgedTask:
    """Return the task of a page. `seed` replaces the setup's.

    Raises KeyError without the page, ValueError without a task, UserError if the setup cannot be played.
    """
    task = lesson.page(page).task
    if task is None:
        raise ValueError(f"page {page} sets no task")
    recipe = recipe_of(lesson, lesson.setup_of(page))
    return JudgedTask(page, task, recipe if seed is None else replace(recipe, seed=seed))


def verdict(judged: JudgedTask, run: Run, panels: Panels, kept: Kept | None = None) -> TaskView:
    """Judge a task at the current step of `run`, as a replay to this step would.

    `panels` decides conditions over many seeds, once all others are met. `kept` caches between verdicts.
    """
    from rl_tui.lessons.judging.moment import JudgedMoment, Kept

    kept = kept or Kept()
    conditions = judged.task.conditions
    reason = elsewhere(judged.setup, run.recipe, kept)
    if reason:
        return TaskView(tuple(ConditionView(each.text, False, reason) for each in conditions))
    moment = JudgedMoment(run, judged.setup, kept)
    verdicts = {place: judged_at(moment, each) for place, each in enumerate(conditions) if not each.seeds}
    waits = ""
    by_seeds = {place: each for place, each in enumerate(conditions) if each.seeds}
    if by_seeds:
        spoilt = _spoilt(moment)
        if not run.step:
            verdicts |= dict.fromkeys(by_seeds, ConditionVerdict(None, "no step has been taken yet"))
        elif spoilt:
            verdicts |= dict.fromkeys(by_seeds, ConditionVerdict(False, spoilt))
        elif all(each.holds for each in verdicts.values()):
            found = panels.of(moment.journal.start, tuple(by_seeds.values()))
            verdicts |= dict(zip(by_seeds, found, strict=True))
            waits = panels.waits
        else:
            verdicts |= dict.fromkeys(by_seeds, ConditionVerdict(None, "computed once the others hold"))
    ordered = [verdicts[place] for place in range(len(conditions))]
    evidence = None
    if all(each.holds is not False for each in ordered) and judged.task.proof is None:
        evidence = Passed(judged.page, run.recipe, run.journal[: moment.journal.count], run.step)
    views = tuple(ConditionView(each.text, *found) for each, found in zip(conditions, ordered, strict=True))
    if all(each.holds for each in ordered):
        return TaskView(views, evidence, waits)
    return TaskView(views, None, waits, evidence if waits else None)


def judged_at(moment: JudgedMoment, condition: Condition) -> ConditionVerdict:
    """Check `condition` at `moment`, ignoring its seeds.

    It may be unknown before the first step, or before the first end of an episode.
    """
    try:
        value = MEASURES[condition.measure].of(moment, condition)
    except NoMomentError as reason:
        return ConditionVerdict(None, str(reason))
    except MissingError as reason:
        return ConditionVerdict(False, str(reason))
    except NotYetError:
        return ConditionVerdict(None, "being computed")
    return ConditionVerdict(is_met(condition, value), found_in_words(condition, value))


def program_verdict(judged: JudgedTask, program: str, seen: SeenProgram) -> TaskView:
    """Judge a task by a watched program."""
    conditions = judged.task.conditions
    verdicts = program_verdicts(conditions, seen)
    views = (ConditionView(each.text, *one) for each, one in zip(conditions, verdicts, strict=True))
    passed = None
    if all(each.holds for each in verdicts) and judged.task.proof is None:
        passed = Passed(judged.page, judged.setup, program=program)
    return TaskView(tuple(views), passed, remarks=remarks_on(seen))


def program_verdicts(conditions: Sequence[Condition], seen: SeenProgram) -> list[ConditionVerdict]:
    """Check each condition. A program with an error meets none."""
    if seen.error:
        return [ConditionVerdict(False) for _ in conditions]
    return [_of_program(each, seen) for each in conditions]


def remarks_on(seen: SeenProgram) -> tuple[str, ...]:
    """Return remarks, the error first."""
    return (seen.error, *seen.remarks) if seen.error else seen.remarks


def _of_program(condition: Condition, seen: SeenProgram) -> ConditionVerdict:
    of_program = MEASURES[condition.measure].of_program
    try:
        value = None if of_program is None else of_program(seen)
    except MissingError as reason:
        return ConditionVerdict(False, str(reason))
    if value is None:
        return ConditionVerdict(False, "a program has no such measure")
    return ConditionVerdict(is_met(condition, value), found_in_words(condition, value))


def elsewhere(setup: Recipe, recipe: Recipe, kept: Kept | None = None) -> str:
    """Return why a run does not fit the task, or ""."""
    from rl_tui.lessons.judging.moment import Kept

    if not (kept or Kept()).is_same_world(setup.scenario, recipe.scenario):
        return f"this is another world: the task is about {setup.scenario.id}"
    if setup.seed != recipe.seed:
        return f"this is seed {recipe.seed}: the task is about seed {setup.seed}"
    return ""


def _spoilt(moment: JudgedMoment) -> str:
    journal = moment.journal
    if journal.taken:
        return "you took steps yourself during this run: r r starts again"
    return "" if journal.is_as_begun else "you changed settings during this run: r r starts again"
