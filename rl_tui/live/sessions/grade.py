"""Grading of sessions: the tasks that their replayed runs pass. Claims without a run do not count."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.findings import shown
from rl_tui.lessons.catalogue import find_lesson
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import ConditionView, Given, LessonRecord, TaskView
from rl_tui.lessons.judging.conditions import JudgedTask, elsewhere, judged_task, verdict
from rl_tui.lessons.judging.journal_reader import RunDigest
from rl_tui.lessons.judging.moment import Kept
from rl_tui.lessons.judging.seed_panel import (
    MOST_STEPS,
    PanelsAtOnce,
    check_world_stays,
    judged_claim,
    judged_program,
    replayed,
)
from rl_tui.lessons.judging.verdicts import ConditionVerdict, Panels, same_panel
from rl_tui.lessons.lesson import Lesson
from rl_tui.live.sessions.session import SUFFIX, SessionError, files_in, read_session
from rl_tui.runs.recipe import JournalEntry, Recipe, TakeAction, begin
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, train

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Condition
    from rl_tui.lessons.file.view import Passed
    from rl_tui.live.record import Record
    from rl_tui.runs.timeline.branches import Branch


# Predictions


_MOST_ENTRIES: Final = 1_000_000
"""Most changes examined over all runs; predictions locked by later ones remain unknown."""


class PredictionScore(NamedTuple):
    """Predictions `made`, `right`, and `locked`.

    A locked one was given at a step that a run in the session reached with the same changes, or at which its
    setup begins.
    """

    right: int = 0
    made: int = 0
    locked: int = 0


NO_PREDICTIONS: Final = PredictionScore()


class _Known(NamedTuple):
    recipe: Recipe
    journal: Sequence[JournalEntry]
    end: int


def predictions_in(taken: LessonRecord, lesson: Lesson, record: Record) -> PredictionScore:
    """Score first predictions. Raises UserError if a setup cannot be played."""
    asked = {page.id: page.prediction for page in lesson.counted_predictions if page.prediction is not None}
    made = [given for page in asked if (given := taken.given_on(page)) is not None]
    right = sum(asked[given.page].is_right(given.answer) for given in made)
    known = [_Known(each.recipe, each.journal, each.step) for each in taken.passed]
    known += [
        _Known(lane.recipe, branch.journal, branch.end) for lane in record.lanes for branch in lane.branches
    ]
    setups = dict.fromkeys(lesson.setup_of(given.page) for given in made)
    locked = sum(
        _locked(lesson, setup, [given for given in made if lesson.setup_of(given.page) == setup], known)
        for setup in setups
    )
    return PredictionScore(right, len(made), locked)


def _locked(lesson: Lesson, setup: str, made: Sequence[Given], known: Sequence[_Known]) -> int:
    begins = recipe_of(lesson, setup)
    names = begin(begins).world.space.action_names
    steps = sorted({given.step for given in made if given.step >= 0})
    found = set(_digests(_Known(begins, (), max(steps, default=0)), steps, names))
    entries = 0
    for run in known:
        entries += len(run.journal)
        if entries <= _MOST_ENTRIES and not elsewhere(begins, run.recipe) and _is_possible(run, names):
            found.update(_digests(run, steps, names))
    return sum((given.step, given.digest) in found for given in made)


def _is_possible(run: _Known, names: Sequence[str]) -> bool:
    taken = (entry.change.action for entry in run.journal if isinstance(entry.change, TakeAction))
    return all(action in names if isinstance(action, str) else action < len(names) for action in taken)


def _digests(run: _Known, steps: Sequence[int], names: Sequence[str]) -> Iterator[tuple[int, str]]:
    digest, place = RunDigest(run.recipe), 0
    for step in steps:
        if step > run.end:
            return
        while place < len(run.journal) and run.journal[place].step < step:
            digest.add(run.journal[place], names)
            place += 1
        yield step, digest.at(step)


# Tasks


PROVES: Final = "A session proves the run, not who made it."
_MOST_STEPS_IN_ALL: Final = 100_000_000
"""Most steps replayed for evidence and branches together."""
_MOST_MOMENTS: Final = 1_000
"""Most actions of the user in a branch after which its run is checked, and half of the most in all."""
_MOST_PANELS: Final = 30
"""Most settings of a session that are tried under many seeds. Each takes about a hundred runs."""
_MOST_REMARKS: Final = 10
_MOST_SESSIONS: Final = 1_000


@dataclass(frozen=True, slots=True)
class GradedTask:
    """A task's result, with the id and title of its page."""

    id: str
    title: str
    passed: bool
    conditions: tuple[ConditionView, ...]


@dataclass(frozen=True, slots=True)
class GradedSession:
    """A session's result. `remarks` say what was ignored."""

    path: Path
    tasks: tuple[GradedTask, ...] = ()
    predictions: PredictionScore = NO_PREDICTIONS
    remarks: tuple[str, ...] = ()
    fault: str = ""
    """Reason why nothing can be graded, usually empty."""

    @property
    def passed(self) -> bool:
        """True if all tasks are passed."""
        return not self.fault and all(task.passed for task in self.tasks)


class LessonGrading:
    """Grades sessions by the lesson `name`, an id or a file. Raises UserError without a lesson or task.

    With `runs_programs`, programs are run and watched, without a sandbox. Otherwise their tasks are not
    judged.
    """

    def __init__(self, name: str, *, runs_programs: bool = False) -> None:
        self._name = name
        self._runs_programs = runs_programs
        self._lessons = dict[str, Lesson]()
        self._panels = PanelsAtOnce()
        self.lesson = self._variant("")
        """The lesson, in its first variant if it has several."""

    def grade(self, path: Path) -> GradedSession:
        """Grade the session in `path`. Raises SessionError if unplayable."""
        record = read_session(path).record()
        remarks = list[str]()
        taken = record.lesson
        if taken is not None and taken.lesson.id != self.lesson.id:
            remarks.append(f"This is a session of the lesson {taken.lesson.id}, so only its runs are judged.")
            taken = None
        try:
            lesson = self._variant("" if taken is None else taken.lesson.variant)
        except ScenarioError as fault:
            raise SessionError(path, str(fault.faults[0])) from fault
        if lesson.variant:
            remarks.append(f"It is graded as variant {lesson.variant}.")
        tasks = [judged_task(lesson, page.id) for page in lesson.tasks]
        panels, steps = _FewPanels(self._panels), _MOST_STEPS_IN_ALL
        views = {task.page: _not_done(task, "not in the session") for task in tasks}
        for task in tasks:
            evidence = _evidence(taken, task.page)
            if evidence is not None:
                judged = self._judged(task, evidence, panels, min(MOST_STEPS, steps))
                views[task.page] = _better(judged, views[task.page])
                steps -= min(evidence.step, steps)
        search = _Search(views, panels)
        for lane in record.lanes:
            for branch in lane.branches:
                search.look_at(tasks, lane.recipe, branch)
        graded = tuple(_graded(lesson, task.page, views[task.page]) for task in tasks)
        predictions = NO_PREDICTIONS if taken is None else predictions_in(taken, lesson, record)
        remarks += [*search.remarks[:_MOST_REMARKS], *panels.remarks]
        if len(search.remarks) > _MOST_REMARKS:
            remarks.append(f"{len(search.remarks) - _MOST_REMARKS:,} more remarks are not shown.")
        return GradedSession(path, graded, predictions, tuple(remarks))

    def _judged(self, task: JudgedTask, evidence: Passed, panels: Panels, most_steps: int) -> TaskView:
        if task.task.program is None or evidence.claim:
            return _judged_evidence(task, evidence, panels, most_steps)
        if not self._runs_programs:
            return _not_done(task, "not judged: add --programs to run the program in the session")
        return judged_program(task, evidence.program)

    def _variant(self, variant: str) -> Lesson:
        if variant not in self._lessons:
            lesson = find_lesson(self._name, variant)
            _check(lesson)
            self._lessons[variant] = lesson
        return self._lessons[variant]


def sessions_to_grade(target: Path) -> list[Path]:
    """Return the file, or a folder's sessions by name. Raises UserError for none, or more than 1,000."""
    if not target.exists():
        raise UserError(
            f"{shown(str(target))}: no such file or folder; "
            f"expected a folder of sessions, or the {SUFFIX} file of one"
        )
    if not target.is_dir():
        return [target]
    files = files_in(target)
    if not files:
        raise UserError(f"{shown(str(target))}: found no session in this folder; expected {SUFFIX} files")
    if len(files) > _MOST_SESSIONS:
        raise UserError(
            f"{shown(str(target))}: found {len(files):,} {SUFFIX} files; expected at most {_MOST_SESSIONS:,}"
        )
    return files


def grade_report(lesson: Lesson, graded: GradedSession) -> dict[str, Any]:
    """Convert a result to JSON data."""
    report: dict[str, Any] = {
        "lesson": lesson.id,
        "passed": graded.passed,
        "tasks": [
            {
                "id": task.id,
                "passed": task.passed,
                "conditions": [{"text": each.text, "holds": each.holds is True} for each in task.conditions],
            }
            for task in graded.tasks
        ],
        "predictions": graded.predictions._asdict(),
        "remarks": list(graded.remarks),
    }
    return report | ({"error": graded.fault} if graded.fault else {})


def _check(lesson: Lesson) -> None:
    if not lesson.tasks:
        raise UserError(f"the lesson {lesson.id} sets no task, so nothing can be graded")


def _evidence(taken: LessonRecord | None, page: str) -> Passed | None:
    return None if taken is None else next((each for each in taken.passed if each.page == page), None)


def _judged_evidence(task: JudgedTask, evidence: Passed, panels: Panels, most_steps: int) -> TaskView:
    if evidence.claim:
        return judged_claim(task, Run(task.setup, evaluate=False), panels)
    reason = elsewhere(task.setup, evidence.recipe)
    if evidence.step > most_steps:
        reason = f"its recorded run has {evidence.step:,} steps; at most {most_steps:,} are replayed"
    if reason:
        return _not_done(task, reason)
    recipe = replace(evidence.recipe, scenario=task.setup.scenario)
    try:
        run = replayed(recipe, evidence.journal, evidence.step)
    except UserError as fault:
        return _not_done(task, f"its recorded run cannot be replayed: {fault}")
    if run.step != evidence.step:
        return _not_done(task, f"its recorded run ends at step {run.step:,}, not {evidence.step:,}")
    return verdict(task, run, panels)


class _FewPanels:
    waits = ""

    def __init__(self, panels: Panels) -> None:
        self._panels = panels
        self._asked: list[tuple[Recipe, tuple[Condition, ...]]] = []
        self._left_out = False

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        if not any(same_panel(*asked, recipe, conditions) for asked in self._asked):
            if len(self._asked) >= _MOST_PANELS:
                self._left_out = True
                return [ConditionVerdict(None, "too many settings were tried")] * len(conditions)
            self._asked.append((recipe, conditions))
        return self._panels.of(recipe, conditions)

    @property
    def remarks(self) -> list[str]:
        said = f"Only the first {_MOST_PANELS} settings were tried under many seeds. The session has more."
        return [said] if self._left_out else []


class _Search:
    def __init__(self, views: dict[str, TaskView], panels: Panels) -> None:
        self._views = views
        self._panels = panels
        self._steps = _MOST_STEPS_IN_ALL
        self._moments = 2 * _MOST_MOMENTS
        self.remarks = list[str]()

    def look_at(self, tasks: Sequence[JudgedTask], recipe: Recipe, branch: Branch) -> None:
        wanted = [
            task
            for task in tasks
            if self._views[task.page].passed is None
            and task.task.program is None
            and not elsewhere(task.setup, recipe)
        ]
        moments = list(_moments(branch))
        if not wanted:
            return
        if branch.end > min(MOST_STEPS, self._steps) or len(moments) > self._moments:
            self.remarks.append(f"{branch.name} was not judged: it has too many steps.")
            return
        self._steps -= branch.end
        self._moments -= len(moments)
        try:
            check_world_stays(branch.journal)
            self._judge(wanted, replace(recipe, scenario=wanted[0].setup.scenario), branch, moments)
        except UserError as fault:
            self.remarks.append(f"{branch.name} cannot be replayed: {fault}")

    def _judge(
        self, tasks: Sequence[JudgedTask], recipe: Recipe, branch: Branch, moments: Sequence[int]
    ) -> None:
        beginning = begin(recipe)
        run = Run(recipe, beginning, evaluate=False, episode_limit=beginning.world.budget)
        kept = Kept()
        for step in moments:
            train(run, Goal(steps=step), journal=branch.journal)
            if run.step != step:
                return
            for task in tasks:
                best = self._views[task.page]
                if best.passed is None:
                    self._views[task.page] = _better(verdict(task, run, self._panels, kept), best)


def _moments(branch: Branch) -> Iterator[int]:
    by_hand = [
        entry.step + 1
        for entry in branch.journal
        if isinstance(entry.change, TakeAction) and entry.step < branch.end
    ]
    yield from sorted({branch.here, branch.end, *by_hand[:_MOST_MOMENTS]})


def _not_done(task: JudgedTask, reason: str) -> TaskView:
    return TaskView(tuple(ConditionView(each.text, False, reason) for each in task.task.conditions))


def _better(view: TaskView, best: TaskView) -> TaskView:
    def rank(each: TaskView) -> tuple[bool, int]:
        return each.passed is not None, sum(condition.holds is True for condition in each.conditions)

    return best if rank(best) > rank(view) else view


def _graded(lesson: Lesson, page: str, view: TaskView) -> GradedTask:
    return GradedTask(page, lesson.page(page).title, view.passed is not None, view.conditions)
