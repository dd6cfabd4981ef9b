"""The check of a lesson's tasks.

A task must pass its accepted attempts, fail its rejected ones, and not pass while the learner only waits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, Location, shown
from rl_tui.lessons.figures.step_budget import StepBudgetError
from rl_tui.lessons.figures.written import in_digits_of
from rl_tui.lessons.judging.conditions import JudgedTask, judged_task, verdict
from rl_tui.lessons.judging.moment import Kept
from rl_tui.lessons.judging.seed_panel import (
    OnEnd,
    PanelsAtOnce,
    attempted_run,
    ignore_end,
    judged_claim,
    judged_program,
)
from rl_tui.lessons.judging.verdicts import ConditionVerdict, Panels, is_met
from rl_tui.runs.changes import read_change
from rl_tui.runs.library import episodes_of
from rl_tui.runs.recipe import TakeAction, begin
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, train

if TYPE_CHECKING:
    from rl_tui.lessons.figures.figures import LessonFigures
    from rl_tui.lessons.figures.step_budget import StepBudget
    from rl_tui.lessons.file.schema import Attempt, Condition, ImpossibilityProof, Page, ProgramToWrite, Task
    from rl_tui.lessons.file.view import TaskView
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.runs.recipe import Recipe


# Tasks that pass by waiting


EVERY_STEP: Final = 100
"""Number of first steps that are each judged."""
EVERY_EPISODE: Final = 200
"""Number of first episodes that are judged at their end, where some conditions can only be met."""
ROUND: Final = (1_000, 10_000, 100_000)
MOST_STEPS: Final = 10_000_000
"""Limit of waiting in steps."""
MOST_STEPPED: Final = 20_000
"""The limit for a simulated environment, which is slow."""


def waiting_findings(
    task: JudgedTask, where: Location, ends: Sequence[int], panels: Panels, on_end: OnEnd = ignore_end
) -> Iterator[Finding]:
    """Yield an error if the task is passed without any action.

    It is judged at the first steps, at the end of the first episodes, after 1,000 steps and more, and at
    `ends`.
    """
    beginning = begin(task.setup)
    run, kept = Run(task.setup, beginning, evaluate=False, episode_limit=beginning.world.budget), Kept()
    try:
        for _ in _moments(run, ends):
            if verdict(task, run, panels, kept).passed is not None:
                found = f"a run without changes passes after {run.step:,} steps; add a stricter condition"
                yield Finding(where, found)
                return
    except UserError:
        return  # a breakdown, such as an endless episode, ends the waiting
    finally:
        on_end(run, _most(run))


def _moments(run: Run, ends: Sequence[int]) -> Iterator[None]:
    yield
    episodes = episodes_of(run.recipe.scenario)
    most = _most(run)
    wanted = {*range(1, EVERY_STEP + 1), *ROUND, *ends}
    targets = sorted(each for each in wanted if each <= most)
    while not run.over:
        target = next((each for each in targets if each > run.step), None)
        if target is None:
            break
        if run.learner.episodes < EVERY_EPISODE:
            run.advance(steps=target - run.step, episodes=1)
        else:
            train(run, Goal(steps=target))
        yield
    if run.learner.episodes < episodes and not run.over and _goes_on(run, Goal(episodes=episodes), most):
        yield


def _most(run: Run) -> int:
    return MOST_STEPS if run.learner.rewindable else MOST_STEPPED


class _TooLongError(Exception):
    pass


def _goes_on(run: Run, goal: Goal, most: int) -> bool:
    """Return False if `goal` takes more than `most` steps."""

    def on_progress(done: int, wanted: int) -> None:
        if run.step > most:
            raise _TooLongError

    try:
        train(run, goal, on_progress)
    except _TooLongError:
        return False
    return True


# Recorded attempts


LEAST_REJECTS: Final = 3
SEEDS_OF_VARIANTS: Final = 100
_LEFT_OUT: Final = "left out"

OnAttempt = Callable[[str], None]
"""Called with the name of each attempt before it is replayed."""


class UndecidedPanels:
    """Leaves conditions over seeds undecided."""

    waits = ""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return that every condition is unknown."""
        return [ConditionVerdict(None, _LEFT_OUT) for _ in conditions]


class _Judged(NamedTuple):
    view: TaskView
    step: int

    @property
    def is_undecided(self) -> bool:
        return any(each.found == _LEFT_OUT for each in self.view.conditions)


class TaskCheck:
    """Checks the task of `page`, with the index `number`."""

    def __init__(
        self, lesson: Lesson, number: int, page: Page, task: Task, budget: StepBudget, *, quick: bool
    ) -> None:
        self._lesson = lesson
        self._page = page
        self._task = task
        self._quick = quick
        self._where: Location = ("pages", number, "task")
        self._budget = budget
        self._panels: Panels = UndecidedPanels() if quick else PanelsAtOnce(budget.charge)

    def warnings(self) -> Iterator[Finding]:
        """Yield missing hints, solution or attempts."""
        task = self._task
        if not task.hints:
            yield Finding((*self._where, "hints"), "missing; add at least one hint")
        if not task.solution:
            yield Finding((*self._where, "solution"), "missing; add a text to show after the last hint")
        if len(task.rejects) < LEAST_REJECTS:
            found = f"{len(task.rejects)} attempts that must fail; give {LEAST_REJECTS} or more"
            yield Finding((*self._where, "rejects"), found)

    def findings(self, figures: LessonFigures, on_attempt: OnAttempt) -> Iterator[Finding]:
        """Yield the errors of the task."""
        if self._task.proof is not None:
            yield from self._proof_findings(self._task.proof, figures)
        if self._task.program is not None and self._quick:
            return
        if not self._task.accepts:
            yield Finding((*self._where, "accepts"), "missing; add at least one attempt that passes")
        ends = list[int]()
        for key, attempts in (("accepts", self._task.accepts), ("rejects", self._task.rejects)):
            for place, attempt in enumerate(attempts):
                on_attempt(attempt.name)
                yield from self._attempt_findings(attempt, (*self._where, key, place), ends)
        if self._task.program is not None:
            on_attempt("the skeleton")
            yield from self._skeleton_findings(self._task.program)
            return
        on_attempt("waiting")
        task = judged_task(self._lesson, self._page.id)
        try:
            yield from waiting_findings(task, self._where, ends, self._panels, self._budget.charge)
        except StepBudgetError as fault:
            yield _too_long(self._where, "waiting", fault)

    def _skeleton_findings(self, program: ProgramToWrite) -> Iterator[Finding]:
        if self._judged_program(program.skeleton).view.passed is not None:
            where = (*self._where, "program", "skeleton")
            yield Finding(where, "the skeleton already passes; leave out a part")

    def findings_over_seeds(self, on_attempt: OnAttempt) -> Iterator[Finding]:
        """Yield attempts with a wrong verdict under 100 seeds."""
        for key, attempts in (("accepts", self._task.accepts), ("rejects", self._task.rejects)):
            for place, attempt in enumerate(attempts):
                if attempt.claim or self._task.program is not None or _is_by_hand(attempt):
                    continue
                on_attempt(attempt.name)
                try:
                    passed = sum(self._passes(attempt, seed) for seed in range(SEEDS_OF_VARIANTS))
                except StepBudgetError as fault:
                    yield _too_long((*self._where, key, place), shown(attempt.name), fault)
                    return
                wanted = SEEDS_OF_VARIANTS if key == "accepts" else 0
                if passed != wanted:
                    found = f"{shown(attempt.name)} passes under {passed} of {SEEDS_OF_VARIANTS} seeds"
                    must = "all" if wanted else "none"
                    yield Finding((*self._where, key, place), f"{found}; it must pass under {must} of them")

    def _attempt_findings(self, attempt: Attempt, where: Location, ends: list[int]) -> Iterator[Finding]:
        try:
            judged = self._judged(attempt)
        except StepBudgetError as fault:
            yield _too_long(where, shown(attempt.name), fault)
            return
        except UserError as fault:
            yield Finding(where, f"{shown(attempt.name)} cannot be replayed: {fault}")
            return
        ends.append(judged.step)
        has_passed = judged.view.passed is not None
        if has_passed and where[-2] == "rejects":
            yield Finding(where, f"{shown(attempt.name)} passes; give an attempt that fails")
        if where[-2] == "accepts" and not has_passed and not (self._quick and judged.is_undecided):
            why = _why(judged.view)
            yield Finding(where, f"{shown(attempt.name)} fails: {why}; give an attempt that passes")

    def _judged_program(self, code: str) -> _Judged:
        return _Judged(judged_program(judged_task(self._lesson, self._page.id), code), 0)

    def _passes(self, attempt: Attempt, seed: int) -> bool:
        """Return False if an attempt breaks down. Raises StepBudgetError."""
        try:
            return self._judged(attempt, seed).view.passed is not None
        except UserError:
            return False

    def _judged(self, attempt: Attempt, seed: int | None = None) -> _Judged:
        if self._task.program is not None and not attempt.claim:
            return self._judged_program(attempt.program)
        self._budget.check_any_left()
        task = judged_task(self._lesson, self._page.id, seed)
        run = attempted_run(self._lesson, self._page.id, attempt, seed, self._budget.charge)
        judge = judged_claim if attempt.claim else verdict
        return _Judged(judge(task, run, self._panels), run.step)

    def _proof_findings(self, proof: ImpossibilityProof, figures: LessonFigures) -> Iterator[Finding]:
        """Yield an error if the best possible value meets the condition, so that nothing is proved."""
        condition = self._task.conditions[proof.condition]
        try:
            best = figures.value(proof.best)
        except UserError:
            return  # reported for the figure itself
        if is_met(condition, best):
            found = f"{shown(condition.text)} holds for {proof.best}, {in_digits_of(best, '')}"
            fix = "give a best value for which the condition fails"
            yield Finding((*self._where, "proof", "best"), f"{found}; {fix}")


def _too_long(where: Location, what: str, fault: StepBudgetError) -> Finding:
    return Finding(where, f"{what}: {fault.found}", fault.expected)


def _why(view: TaskView) -> str:
    if view.remarks:
        return view.remarks[0]
    for condition in view.conditions:
        if not condition.holds:
            return f"{shown(condition.text)} does not hold ({condition.found or 'nothing'})"
    return "it is not a claim" if view.conditions else "nothing holds"


def _is_by_hand(attempt: Attempt) -> bool:
    return any(isinstance(read_change(each).change, TakeAction) for each in attempt.changes)
