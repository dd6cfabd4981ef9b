"""A learner's program, watched beside the run on screen: one at a time."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rl_tui.lessons.file.view import ConditionView, Passed, TaskView
from rl_tui.runs.background.background import Background
from rl_tui.runs.background.child import bound_processor_time

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Condition
    from rl_tui.lessons.judging.conditions import JudgedTask
    from rl_tui.lessons.judging.verdicts import ConditionVerdict

WORK: Final = "rl_tui.lessons.judging.live_program:work"
"""What runs in the process."""
MOST_SECONDS: Final = 300
"""Of a processor, for judging what was seen; the program has limits of its own."""
_TELLS_EVERY: Final = 0.25  # seconds


@dataclass(frozen=True, slots=True)
class ProgramTask:
    """What is asked: the program in the file ``path``, held to ``conditions``."""

    path: Path
    conditions: tuple[Condition, ...]


@dataclass(frozen=True, slots=True)
class FoundProgram:
    """What is known of the program: its ``progress``, at the end the ``verdicts``, or a ``fault``."""

    progress: str = "it begins"
    fault: str = ""
    """Why it cannot be judged; empty where it can."""
    verdicts: tuple[ConditionVerdict, ...] | None = None
    """One for each condition, None before its end."""
    code: str = ""
    remarks: tuple[str, ...] = ()


class LiveProgram:
    """Has a program watched and judged in a process of its own, and tells how it stands.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`begin`
    watches it itself to its end, so that what is known does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[ProgramTask, FoundProgram](WORK, on_news)
        self._found = FoundProgram()
        self._name = ""

    def begin(self, path: Path, judged: JudgedTask) -> None:
        """Watch the program in the file ``path`` for a task, in place of any other."""
        self.end()
        task = ProgramTask(path, judged.task.conditions)
        self._name = path.name
        if not self._automatic:
            self._found = judged_file(task)
            return
        try:
            self._background.begin(task, FoundProgram())
        except OSError as error:
            self._found = FoundProgram(fault=f"no process can be started to watch it ({error})")

    def view(self, judged: JudgedTask, *, has_passed: bool) -> TaskView:
        """Return how the task stands by what is known of the program; ``has_passed`` says that one has."""
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
        fault = found.fault or (process.why_failed("what watches it ended by itself") if process else "")
        remarks = (fault,) if fault else ()
        waits = ""
        if process is not None and not fault:
            waits = f"{self._name} is watched: {found.progress}"
            waits = " · ".join(filter(None, (waits, process.how_long)))
        views = tuple(ConditionView(each.text, holds) for each in conditions)
        return TaskView(views, waits=waits, remarks=remarks)

    def end(self) -> None:
        """End it, and forget what is known of it."""
        self._background.end()
        self._found = FoundProgram()

    def close(self) -> None:
        """End it, from any thread, and begin nothing any more."""
        self._background.close()


def work(task: ProgramTask, tell: Callable[[FoundProgram, float], None]) -> None:
    """Tell how many steps are seen, and how the program is judged; what a process of its own does."""
    bound_processor_time(MOST_SECONDS)
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
    """Return how the program of ``task`` is judged.

    ``on_steps`` is called with the steps and episodes that were seen, as they come.
    """
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
