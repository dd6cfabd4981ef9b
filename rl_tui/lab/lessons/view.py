"""What a snapshot tells of a lesson."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from rl_tui.lab.lessons.record import LessonRecord, Passed


class ConditionView(NamedTuple):
    """One condition: ``holds`` is None while that is not known; ``found`` is the measure, in words."""

    text: str
    holds: bool | None
    found: str = ""


@dataclass(frozen=True, slots=True)
class TaskView:
    """How the task of the open page stands at this moment."""

    conditions: tuple[ConditionView, ...]
    """Each condition, in the order of the file."""
    passed: Passed | None = None
    """The evidence, where all hold now; None where they do not."""
    waits: str = ""
    """What is being worked out, in words; mostly empty."""
    awaited: Passed | None = None
    """The evidence, where all hold now but for what is being worked out."""
    remarks: tuple[str, ...] = ()
    """What was found of a program that was watched, besides: sentences for who wrote it."""


@dataclass(frozen=True, slots=True)
class LessonView:
    """A lesson beside the run."""

    record: LessonRecord
    """How far the learner has come, the lesson itself in it."""
    task: TaskView | None = None
    """The task of the open page; None where that sets none."""
    digest: str = ""
    """That of the run as it stands: what a prediction is locked with."""
    in_run: float | str | bool | None = None
    """What the open page's prediction shows of the run at the step where its truth is due, or in words why
    there is nothing; None before that, and where it shows nothing."""
