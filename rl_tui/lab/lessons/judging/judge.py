"""The judge beside a living run: what of a task holds now, as the replay would find it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rl_tui.common.errors import UserError
from rl_tui.lab.lessons.judging.conditions import JudgedTask, judged_task, verdict
from rl_tui.lab.lessons.judging.in_run import InRun
from rl_tui.lab.lessons.judging.live_panels import LivePanels
from rl_tui.lab.lessons.programs.live_program import LiveProgram
from rl_tui.lab.lessons.view import ConditionView, LessonView, TaskView

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.moment import Kept
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.lessons.record import LessonRecord, Passed
    from rl_tui.lab.lessons.schema import Task
    from rl_tui.lab.run.recipe import Recipe
    from rl_tui.lab.run.run import Run


class TaskJudge:
    """Judges the open page's task at each snapshot; ``on_news`` is called when what takes long is known.

    Once all its conditions held at a step that was judged, the task stays passed, by the evidence of that
    step, wherever the run goes; also where it went on while many seeds were still being worked out. With
    ``automatic`` off no answer depends on the time.
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
        self._awaited: tuple[Passed, Recipe] | None = None  # and the settings of its first step

    def view(self, record: LessonRecord, run: Run) -> LessonView:
        """Return how the lesson of ``record`` stands beside ``run`` at this step."""
        kept = self._kept = self._kept or self._new_kept()
        kept.journal.read(run.recipe, run.journal, run.step, run.world.space.action_names)
        task, digest = self._task(record, run, kept), kept.journal.digest
        return LessonView(record, task, digest, self._in_run.of(record, run, kept))

    def watch(self, record: LessonRecord, path: Path) -> None:
        """Watch the program in the file ``path`` for the open page's task, if that asks for one."""
        task = record.lesson.page(record.page).task
        if task is None or task.program is None:
            return
        self._open_page_of(record)
        if self._judged is not None:
            self._program.begin(path, self._judged)

    def close(self) -> None:
        """End what is worked out in processes of their own, from any thread."""
        self._panels.close()
        self._program.close()

    def _new_kept(self) -> Kept:
        from rl_tui.lab.lessons.judging.moment import Kept, exact_at_once
        from rl_tui.lab.run.exact_answers import RunAnswers

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
        """Return ``view`` of a run that has gone on, with what is known of the seeds asked for before."""
        found = self._panels.of(start, tuple(each for each in task.conditions if each.seeds))
        if all(each.holds for each in found):
            self._passed = evidence
        if not self._panels.waits:
            self._awaited = None
            return view
        return replace(view, waits=f"{self._panels.waits}, as of step {evidence.step:,}")

    def _open_page_of(self, record: LessonRecord) -> None:
        """Judge the task of the open page from here on, if that is another one."""
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
