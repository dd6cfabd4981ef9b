"""Attempts at a task, recorded in a lesson or a session: made again and judged."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rl_tui.lab.lessons.judging.conditions import JudgedTask, judged_task, program_verdict, verdict
from rl_tui.lab.lessons.judging.replays import attempted_run, replayed
from rl_tui.lab.lessons.judging.seed_panel import PanelsAtOnce
from rl_tui.lab.lessons.judging.verdicts import Panels
from rl_tui.lab.lessons.record import Passed
from rl_tui.lab.run.run import Run

if TYPE_CHECKING:
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.lessons.schema import Attempt
    from rl_tui.lab.lessons.view import TaskView


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
    return (
        judged_claim(judged, run, panels) if attempt.claim else verdict(judged, run, panels or PanelsAtOnce())
    )


def judged_program(judged: JudgedTask, code: str) -> TaskView:
    """Return how ``code``, which is run for it, is judged by a task that asks for a program."""
    from rl_tui.lab.lessons.programs.watching import watched_code

    name = "" if judged.task.program is None else judged.task.program.file
    return program_verdict(judged, code, watched_code(code, name))


def judged_claim(judged: JudgedTask, run: Run, panels: Panels | None = None) -> TaskView:
    """Return how the claim that the task cannot be done is judged, made where ``run`` stands."""
    view = verdict(judged, run, panels or PanelsAtOnce())
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
    run = replayed(evidence.recipe, evidence.journal, evidence.step)
    return verdict(judged, run, panels or PanelsAtOnce())
