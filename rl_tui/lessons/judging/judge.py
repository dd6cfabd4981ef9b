"""The judge beside a live run, which reaches the same verdict as a replay."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import NO_STEP, ConditionView, Given, LessonRecord, LessonView, Passed, TaskView
from rl_tui.lessons.judging.conditions import JudgedTask, judged_task, verdict
from rl_tui.lessons.judging.journal_reader import entries_before
from rl_tui.lessons.judging.measures import MEASURES, MissingError, NotYetError, Value
from rl_tui.lessons.judging.verdicts import (
    ConditionVerdict,
    KnownPanels,
    PanelProgress,
    PanelRequest,
    same_panel,
)
from rl_tui.runs.background.background import AnsweringProcess, Background
from rl_tui.runs.background.child import bound_processor_time

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Condition, Measured, Task
    from rl_tui.lessons.judging.moment import Kept
    from rl_tui.lessons.lesson import Lesson
    from rl_tui.runs.recipe import JournalEntry, Recipe
    from rl_tui.runs.run import Run


# A learner's program, watched beside the run: one at a time


_PROGRAM_WORK: Final = "rl_tui.lessons.judging.judge:work"
_MOST_SECONDS: Final = 300
"""CPU-time limit of the diagnosis in seconds. The program has its own limits."""
_TELLS_EVERY: Final = 0.25  # seconds


@dataclass(frozen=True, slots=True)
class ProgramTask:
    """A program file with its `conditions`."""

    path: Path
    conditions: tuple[Condition, ...]


@dataclass(frozen=True, slots=True)
class FoundProgram:
    """A watched program: `progress`, finally `verdicts`, or a `fault`."""

    progress: str = "it begins"
    fault: str = ""
    """Reason why it cannot be judged, else empty."""
    verdicts: tuple[ConditionVerdict, ...] | None = None
    """A verdict for each condition, or None before its end."""
    code: str = ""
    remarks: tuple[str, ...] = ()


class LiveProgram:
    """Watches and judges a program in a background process.

    `on_news` is called from any thread. Without `automatic`, `begin` watches it to its end, so that results
    do not depend on timing.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[ProgramTask, FoundProgram](_PROGRAM_WORK, on_news)
        self._found = FoundProgram()
        self._name = ""

    def begin(self, path: Path, judged: JudgedTask) -> None:
        """Watch the program in `path`, replacing any other."""
        self.end()
        task = ProgramTask(path, judged.task.conditions)
        self._name = path.name
        if not self._automatic:
            self._found = judged_file(task)
            return
        try:
            self._background.begin(task, FoundProgram())
        except OSError as error:
            self._found = FoundProgram(fault=f"cannot start a process to watch it ({error})")

    def view(self, judged: JudgedTask, *, has_passed: bool) -> TaskView:
        """Return the task's state, after a program `has_passed` or not."""
        conditions, process = judged.task.conditions, self._background.process
        found = self._found if process is None else process.known
        if found.verdicts is not None:
            views = tuple(
                ConditionView(each.text, holds, said)
                for each, (holds, said) in zip(conditions, found.verdicts, strict=True)
            )
            passed = None
            if all(each.holds for each in views) and judged.task.proof is None:
                passed = Passed(judged.page, judged.setup, program=found.code)
            return TaskView(views, passed, remarks=found.remarks)
        holds = True if has_passed else None
        fault = found.fault or (
            process.why_failed("the process that watched it ended too early") if process else ""
        )
        remarks = (fault,) if fault else ()
        waits = ""
        if process is not None and not fault:
            waits = f"{self._name} is watched: {found.progress}"
            waits = " · ".join(filter(None, (waits, process.how_long)))
        views = tuple(ConditionView(each.text, holds) for each in conditions)
        return TaskView(views, waits=waits, remarks=remarks)

    def end(self) -> None:
        """Stop and forget it."""
        self._background.end()
        self._found = FoundProgram()

    def close(self) -> None:
        """Stop it, and begin no other, from any thread."""
        self._background.close()


def work(task: ProgramTask, tell: Callable[[FoundProgram, float], None]) -> None:
    """Watch and judge a program in a background process."""
    bound_processor_time(_MOST_SECONDS)
    last = 0.0

    def on_steps(steps: int, episodes: int) -> None:
        nonlocal last
        if time.monotonic() - last > _TELLS_EVERY:
            last = time.monotonic()
            tell(FoundProgram(progress=f"{steps:,} steps, {episodes:,} episodes"), 0.0)

    tell(judged_file(task, on_steps), 1.0)


def judged_file(
    task: ProgramTask, on_steps: Callable[[int, int], None] = lambda steps, episodes: None
) -> FoundProgram:
    """Judge a program. `on_steps` receives steps and episodes."""
    from rl_tui.common.errors import UserError
    from rl_tui.lessons.judging.conditions import program_verdicts, remarks_on
    from rl_tui.lessons.judging.seen_program import read_code, watched_code

    try:
        code = read_code(task.path)
    except UserError as fault:
        return FoundProgram(fault=str(fault))
    seen = watched_code(code, task.path.name, on_steps)
    verdicts = tuple(program_verdicts(task.conditions, seen))
    return FoundProgram(code=code, verdicts=verdicts, remarks=remarks_on(seen))


# The number behind a prediction


FARTHEST: Final = 20_000
"""A run beyond this step is not replayed to an earlier one."""


class _Known(NamedTuple):
    given: Given
    recipe: Recipe
    journal: tuple[JournalEntry, ...]
    value: Value | None


class InRun:
    """Computes a metric at a step, from the run or from a replay.

    The result is cached until the run reaches the step in another way.
    """

    def __init__(self) -> None:
        self._known: _Known | None = None

    def of(self, record: LessonRecord, run: Run, kept: Kept) -> Value | None:
        """Return the metric, why it has no value, or None if it is not due or requested."""
        ask, given = record.lesson.page(record.page).prediction, record.given_on(record.page)
        if ask is None or ask.shows is None or given is None or given.step == NO_STEP:
            return None
        known, due = self._known, given.step + ask.steps
        is_same = known is not None and known.given == given and known.recipe is run.recipe
        if run.step < due:
            return known.value if known is not None and is_same else None
        entries = entries_before(run.journal, due)
        if known is not None and is_same and known.journal == entries:
            return known.value
        try:
            setup = recipe_of(record.lesson, record.lesson.setup_of(record.page))
            value = _measured(ask.shows, run, setup, entries, due, kept)
        except NotYetError:
            return None
        except UserError as reason:
            value = str(reason)
        self._known = _Known(given, run.recipe, entries, value)
        return value


def _measured(
    shows: Measured, run: Run, setup: Recipe, entries: tuple[JournalEntry, ...], due: int, kept: Kept
) -> Value | None:
    from rl_tui.lessons.judging.moment import JudgedMoment, Kept
    from rl_tui.runs.run import Run

    if run.step > due:
        if due > FARTHEST:
            return None
        earlier = Run(run.recipe, evaluate=False)
        earlier.follow(entries, due)
        run, kept = earlier, Kept()
    try:
        return MEASURES[shows.measure].of(JudgedMoment(run, setup, kept), shows)
    except MissingError as reason:
        return str(reason)


# Many seeds beside a live run


if TYPE_CHECKING:
    _Process = AnsweringProcess[PanelRequest, PanelProgress]

_PANEL_WORK: Final = "rl_tui.lessons.judging.seed_panel:work"


class LivePanels:
    """Computes conditions over seeds in a background process, and caches results.

    `on_news` is called from any thread. Without `automatic`, `of` computes them, so that results do not
    depend on timing.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[PanelRequest, PanelProgress](_PANEL_WORK, on_news)
        self._known = KnownPanels()

    def of(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> Sequence[ConditionVerdict]:
        """Return the known verdicts, and compute the others."""
        found = self._known.of(recipe, conditions)
        if found is not None:
            return found
        if not self._automatic:
            return self._worked_out_here(recipe, conditions)
        process = self._background.process
        if process is None or not same_panel(*_panel(process), recipe, conditions):
            process = self._begin(recipe, conditions)
        if process is None:
            return [ConditionVerdict(None, "cannot start a process for the computation")] * len(conditions)
        verdicts = process.known.verdicts
        if verdicts is not None:
            self._known.keep(recipe, conditions, verdicts)
            return verdicts
        return [ConditionVerdict(None, process.failed or self.waits)] * len(conditions)

    @property
    def waits(self) -> str:
        """Progress with the time left, or ""."""
        process = self._background.process
        if process is None or (known := process.known).verdicts is not None or process.failed:
            return ""
        done, wanted = len(known.seeds), known.wanted
        said = f"{done} of {wanted} seeds" if wanted else f"{done} seeds so far"
        return " · ".join(filter(None, (f"judging: {said}", process.how_long)))

    def end(self) -> None:
        """Stop. Cached results let it continue."""
        process = self._background.process
        self._background.end()
        if process is not None and (verdicts := process.known.verdicts) is not None:
            self._known.keep(*_panel(process), verdicts)
        elif process is not None:
            self._known.keep_seeds(*_panel(process), process.known.seeds)

    def close(self) -> None:
        """Stop it, and begin no other, from any thread."""
        self._background.close()

    def _worked_out_here(
        self, recipe: Recipe, conditions: tuple[Condition, ...]
    ) -> Sequence[ConditionVerdict]:
        from rl_tui.lessons.judging.seed_panel import worked_out

        try:
            found = worked_out(recipe, conditions)
        except UserError as reason:
            return [ConditionVerdict(None, str(reason))] * len(conditions)
        self._known.keep(recipe, conditions, found)
        return found

    def _begin(self, recipe: Recipe, conditions: tuple[Condition, ...]) -> _Process | None:
        self.end()
        seeds = self._known.seeds_of(recipe, conditions)
        try:
            return self._background.begin(PanelRequest(recipe, conditions, seeds), PanelProgress(seeds))
        except OSError:
            return None


def _panel(process: _Process) -> tuple[Recipe, tuple[Condition, ...]]:
    return process.request.recipe, process.request.conditions


# The judge


class TaskJudge:
    """Judges the open page's task at each snapshot.

    Once all conditions are met at a judged step, the task stays passed with this evidence, also while seeds
    are pending. `on_news` is called for slow results. Without `automatic`, no answer depends on timing.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._on_news = on_news
        self._automatic = automatic
        self._panels = LivePanels(on_news, automatic=automatic)
        self._program = LiveProgram(on_news, automatic=automatic)
        self._kept: Kept | None = None
        self._in_run = InRun()
        self._lesson: Lesson | None = None
        self._page = ""
        self._judged: JudgedTask | None = None
        self._refused = ""
        self._passed: Passed | None = None
        self._awaited: tuple[Passed, Recipe] | None = None  # with the settings of its first step

    def view(self, record: LessonRecord, run: Run) -> LessonView:
        """Return the lesson's state next to `run`."""
        kept = self._kept = self._kept or self._new_kept()
        kept.journal.read(run.recipe, run.journal, run.step, run.world.space.action_names)
        task, digest = self._task(record, run, kept), kept.journal.digest
        return LessonView(record, task, digest, self._in_run.of(record, run, kept))

    def watch(self, record: LessonRecord, path: Path) -> None:
        """Watch the program in `path`, if the open page needs one."""
        task = record.lesson.page(record.page).task
        if task is None or task.program is None:
            return
        self._open_page_of(record)
        if self._judged is not None:
            self._program.begin(path, self._judged)

    def close(self) -> None:
        """Stop background processes, from any thread."""
        self._panels.close()
        self._program.close()

    def _new_kept(self) -> Kept:
        from rl_tui.lessons.judging.moment import Kept, exact_at_once
        from rl_tui.runs.exact_answers import RunAnswers

        return Kept(RunAnswers(self._on_news).at if self._automatic else exact_at_once)

    def _task(self, record: LessonRecord, run: Run, kept: Kept) -> TaskView | None:
        task = record.lesson.page(record.page).task
        self._open_page_of(record)
        if task is None:
            return None
        if self._judged is None:
            return TaskView(tuple(ConditionView(each.text, None, self._refused) for each in task.conditions))
        has_passed = record.has_passed(record.page)
        if task.program is None:
            view = verdict(self._judged, run, self._panels, kept)
        else:
            view = self._program.view(self._judged, has_passed=has_passed)
        if has_passed:
            return view
        self._passed = self._passed or view.passed
        if view.awaited is not None:
            self._awaited = view.awaited, kept.journal.start
        elif self._awaited is not None and self._passed is None and not view.waits:
            view = self._with_awaited(view, task, *self._awaited)
        return replace(view, passed=self._passed)

    def _with_awaited(self, view: TaskView, task: Task, evidence: Passed, start: Recipe) -> TaskView:
        found = self._panels.of(start, tuple(each for each in task.conditions if each.seeds))
        if all(each.holds for each in found):
            self._passed = evidence
        if not self._panels.waits:
            self._awaited = None
            return view
        return replace(view, waits=f"{self._panels.waits}, as of step {evidence.step:,}")

    def _open_page_of(self, record: LessonRecord) -> None:
        lesson, page = record.lesson, record.page
        if lesson is self._lesson and page == self._page:
            return
        self._panels.end()
        self._program.end()
        self._lesson, self._page, self._judged, self._refused = lesson, page, None, ""
        self._passed = self._awaited = None
        if lesson.page(page).task is None:
            return
        try:
            self._judged = judged_task(lesson, page)
        except UserError as reason:
            self._refused = str(reason)
