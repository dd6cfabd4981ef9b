"""A learner's program, watched beside the run on screen: one at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rl_tui.lab.lessons.record import Passed
from rl_tui.lab.lessons.view import ConditionView, TaskView
from rl_tui.lab.workers.answering_process import AnsweringProcess

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.conditions import JudgedTask
    from rl_tui.lab.lessons.schema import Condition

WORKER: Final = "rl_tui.lab.lessons.programs.program_worker"
"""What runs in the process."""


@dataclass(frozen=True, slots=True)
class ProgramTask:
    """What is asked: the program in the file ``path``, held to ``conditions``."""

    path: Path
    conditions: tuple[Condition, ...]


class LiveProgram:
    """Has a program watched and judged in a process of its own, and tells how it stands.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`begin`
    watches it itself to its end, so that what is known does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._on_news = on_news
        self._automatic = automatic
        self._lock = threading.Lock()  # guards the process and whether there may be one
        self._process: _Watching | None = None
        self._is_closed = False
        self._found: dict[str, Any] = {}
        self._name = ""

    def begin(self, path: Path, judged: JudgedTask) -> None:
        """Watch the program in the file ``path`` for a task, in place of any other."""
        self.end()
        task = ProgramTask(path, judged.task.conditions)
        self._name = path.name
        if not self._automatic:
            from rl_tui.lab.lessons.programs.program_worker import judged_file

            self._found = judged_file(task)
            return
        try:
            with self._lock:
                if not self._is_closed:
                    self._process = _Watching(task, self._on_news)
        except OSError as error:
            self._found = {"fault": f"no process can be started to watch it ({error})"}

    def view(self, judged: JudgedTask, *, has_passed: bool) -> TaskView:
        """Return how the task stands by what is known of the program; ``has_passed`` says that one has."""
        conditions, process = judged.task.conditions, self._process
        found = self._found if process is None else process.found
        if "verdicts" in found:
            views = tuple(
                ConditionView(each.text, holds, said)
                for each, (holds, said) in zip(conditions, found["verdicts"], strict=True)
            )
            passed = None
            if all(each.holds for each in views) and judged.task.proof is None:
                passed = Passed(judged.page, judged.setup, program=found["code"])
            return TaskView(views, passed, remarks=tuple(found["remarks"]))
        holds = True if has_passed else None
        remarks = (found["fault"],) if "fault" in found else ()
        waits = ""
        if process is not None and not found:
            waits = f"{self._name} is watched: {process.progress}"
            waits = " · ".join(filter(None, (waits, process.how_long)))
        views = tuple(ConditionView(each.text, holds) for each in conditions)
        return TaskView(views, waits=waits, remarks=remarks)

    def end(self) -> None:
        """End it, and forget what is known of it."""
        with self._lock:
            process, self._process = self._process, None
        self._found = {}
        if process is not None:
            process.end()

    def close(self) -> None:
        """End it, from any thread, and begin nothing any more."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.end()


class _Watching(AnsweringProcess):
    """Watches the program of ``task``; what came of it is ``found``, empty before its end."""

    def __init__(self, task: ProgramTask, on_news: Callable[[], None]) -> None:
        self.found: dict[str, Any] = {}
        self.progress = "it begins"
        super().__init__(WORKER, task, self._take_in, self._has_ended, on_news, "program of a task")

    def _take_in(self, document: Any) -> None:
        if "steps" in document:
            self.progress = f"{document['steps']:,} steps, {document['episodes']:,} episodes"
        else:
            self.found = dict(document)

    def _has_ended(self) -> None:
        if not self.found:
            self.found = {"fault": "what watches it ended by itself"}
