"""The check of a lesson's tasks, by replaying the attempts recorded with them.

A task must pass its accepted attempts, fail its rejected ones, and not pass while the learner only
waits.
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
"""So many steps are judged one by one."""
EVERY_EPISODE: Final = 200
"""So many episodes are judged where they end: some conditions hold at no other step."""
ROUND: Final = (1_000, 10_000, 100_000)
MOST_STEPS: Final = 10_000_000
"""Further nobody waits."""
MOST_STEPPED: Final = 20_000
"""Nor so far where an environment is stepped for real, which takes its time."""


def waiting_findings(
    task: JudgedTask, where: Location, ends: Sequence[int], panels: Panels, on_end: OnEnd = ignore_end
) -> Iterator[Finding]:
    """Yield that the task is passed with its setup as it is and nothing done.

    It is judged at the start, at each of the first steps, at the end of each of the first episodes, after
    1,000 steps and more, after the usual number of episodes, and at the steps at which attempts ended:
    ``ends``. ``on_end`` hears of the run, and may raise.
    """
    beginning = begin(task.setup)
    run, kept = Run(task.setup, beginning, evaluate=False, episode_limit=beginning.world.budget), Kept()
    try:
        for _ in _moments(run, ends):
            if verdict(task, run, panels, kept).passed is not None:
                found = f"a pass after {run.step:,} steps in which nothing was done"
                yield Finding(where, found, "a task that cannot be passed by waiting")
                return
    except UserError:
        return  # it breaks down, as where an episode never ends: nobody waits any longer
    finally:
        on_end(run, _most(run))


def _moments(run: Run, ends: Sequence[int]) -> Iterator[None]:
    """Advance ``run`` from one moment to the next at which it is to be judged."""
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
    """Return how far anybody waits."""
    return MOST_STEPS if run.learner.rewindable else MOST_STEPPED


class _TooLongError(Exception):
    """Nobody waits so long."""


def _goes_on(run: Run, goal: Goal, most: int) -> bool:
    """Advance ``run`` to ``goal``, and return whether it got there within ``most`` steps."""

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
"""Hears the name of each attempt before it is replayed."""


class UndecidedPanels:
    """Leaves open what many seeds would decide."""

    waits = ""

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return that nothing is known of any condition."""
        return [ConditionVerdict(None, _LEFT_OUT) for _ in conditions]


class _Judged(NamedTuple):
    """How an attempt was judged, and the step at which it ended."""

    view: TaskView
    step: int

    @property
    def is_undecided(self) -> bool:
        """Whether only conditions are in the way that were left open."""
        return any(each.found == _LEFT_OUT for each in self.view.conditions)


class TaskCheck:
    """Checks the task of one ``page``, whose place among the pages is ``number``."""

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
        """Yield what a learner or a teacher will miss."""
        task = self._task
        if not task.hints:
            yield Finding(
                (*self._where, "hints"), "no hint", "one at least, for who does not know how to go on"
            )
        if not task.solution:
            yield Finding((*self._where, "solution"), "no solution", "what is shown after the last hint")
        if len(task.rejects) < LEAST_REJECTS:
            found = f"{len(task.rejects)} wrong attempts"
            yield Finding(
                (*self._where, "rejects"), found, f"{LEAST_REJECTS} or more that the task is held to"
            )

    def findings(self, figures: LessonFigures, on_attempt: OnAttempt) -> Iterator[Finding]:
        """Yield what is wrong with the task."""
        if self._task.proof is not None:
            yield from self._proof_findings(self._task.proof, figures)
        if self._task.program is not None and self._quick:
            return
        if not self._task.accepts:
            yield Finding((*self._where, "accepts"), "no attempt", "one at least that passes")
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
        """Yield that what the learner begins with passes as it is."""
        if self._judged_program(program.skeleton).view.passed is not None:
            where = (*self._where, "program", "skeleton")
            yield Finding(where, "a program that passes", "one in which something is missing")

    def findings_over_seeds(self, on_attempt: OnAttempt) -> Iterator[Finding]:
        """Yield which attempts do not hold under all of 100 seeds in place of the setup's own."""
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
                    found = f"{shown(attempt.name)}, which passes under {passed} of {SEEDS_OF_VARIANTS} seeds"
                    yield Finding((*self._where, key, place), found, f"under {wanted or 'none'} of them")

    def _attempt_findings(self, attempt: Attempt, where: Location, ends: list[int]) -> Iterator[Finding]:
        """Yield that an attempt is judged as it should not be; ``ends`` takes the step at which it ended."""
        try:
            judged = self._judged(attempt)
        except StepBudgetError as fault:
            yield _too_long(where, shown(attempt.name), fault)
            return
        except UserError as fault:
            yield Finding(where, f"{shown(attempt.name)}: {fault}", "an attempt that can be replayed")
            return
        ends.append(judged.step)
        has_passed = judged.view.passed is not None
        if has_passed and where[-2] == "rejects":
            yield Finding(where, f"{shown(attempt.name)}, which passes", "an attempt that the task refuses")
        if where[-2] == "accepts" and not has_passed and not (self._quick and judged.is_undecided):
            yield Finding(
                where, f"{shown(attempt.name)}, refused: {_why(judged.view)}", "an attempt that passes"
            )

    def _judged_program(self, code: str) -> _Judged:
        return _Judged(judged_program(judged_task(self._lesson, self._page.id), code), 0)

    def _passes(self, attempt: Attempt, seed: int) -> bool:
        """Return whether an attempt passes under ``seed``; one that breaks down there does not.

        Raises StepBudgetError where its runs take too many steps.
        """
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
        """Yield that the best there is would do, so that nothing is proved."""
        condition = self._task.conditions[proof.condition]
        try:
            best = figures.value(proof.best)
        except UserError:
            return  # told of the figure itself
        if is_met(condition, best):
            found = f"{proof.best}, {in_digits_of(best, '')}, with which {shown(condition.text)} holds"
            yield Finding((*self._where, "proof", "best"), found, "a best with which it does not hold")


def _too_long(where: Location, what: str, fault: StepBudgetError) -> Finding:
    return Finding(where, f"{what}: {fault.found}", fault.expected)


def _why(view: TaskView) -> str:
    """Return the first condition that does not hold, and what was found; of a program what is wrong first."""
    if view.remarks:
        return view.remarks[0]
    for condition in view.conditions:
        if not condition.holds:
            return f"{shown(condition.text)} does not hold ({condition.found or 'nothing'})"
    return "it is no claim" if view.conditions else "nothing holds"


def _is_by_hand(attempt: Attempt) -> bool:
    return any(isinstance(read_change(each).change, TakeAction) for each in attempt.changes)
