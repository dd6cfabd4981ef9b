"""The judge beside a living run: what of a task holds now, as the replay would find it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rl_tui.lab.lessons.record import LessonRecord, run_digest
from rl_tui.lab.lessons.view import ConditionView, LessonView, TaskView

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run


class TaskJudge:
    """Judges the open page's task at each snapshot; ``on_news`` is called when what takes long is known.

    With ``automatic`` off no answer depends on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._on_news = on_news
        self._automatic = automatic

    def view(self, lesson: LessonRecord, run: Run) -> LessonView:
        """Return how ``lesson`` stands beside ``run`` at this step."""
        names = run.world.space.action_names
        return LessonView(
            lesson, self._task(lesson, run), run_digest(run.recipe, run.journal, run.step, names)
        )

    def _task(self, lesson: LessonRecord, run: Run) -> TaskView | None:
        task = lesson.lesson.page(lesson.page).task
        if task is None:
            return None
        return TaskView(tuple(ConditionView(each.text, None) for each in task.conditions))

    def close(self) -> None:
        """End what is worked out in a process of its own, from any thread."""
