"""The record of a playground, which restores its position."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from rl_tui.live.pace.until import Breakpoints
from rl_tui.runs.answers.policy_values import DrawnPolicy

if TYPE_CHECKING:
    from rl_tui.lessons.file.view import LessonRecord
    from rl_tui.runs.run import Run
    from rl_tui.runs.timeline.branches import RunRecord
    from rl_tui.worlds.mdp.space import FloatArray, IntArray


@dataclass(frozen=True, slots=True, eq=False)
class LearnedTable:
    """Estimates of a run at one step."""

    q: FloatArray
    """Estimates, `[P]`."""
    visits: IntArray
    """Updates or visits of each pair, `[P]`."""
    episodes: int
    """Finished episodes."""
    state: int
    """State of the agent."""


@dataclass(frozen=True, slots=True)
class Record:
    """The runs of a playground and its settings."""

    lanes: tuple[RunRecord, ...]
    """All runs, at least one."""
    shown: int = 0
    """Number of the visible run."""
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    """Breakpoints of the visible run."""
    speed: float | None = None
    """Steps per second, or None for full speed."""
    drawn: DrawnPolicy = field(default_factory=DrawnPolicy)
    """The policy drawn by the user."""
    answer_is_hidden: bool | None = None
    """True if exact answers are hidden, or None if the scenario decides."""
    lesson: LessonRecord | None = None
    """Lesson with its progress, or None."""
    table: LearnedTable | None = field(default=None, compare=False)
    """Estimates of the visible run at its position, or None if unknown. They are shown until the replay is
    done. They are not used for learning, and may not fit the world.
    """


def table_of(run: Run) -> LearnedTable:
    """Return the current estimates of `run`."""
    learner = run.learner
    return LearnedTable(learner.q, learner.visits, learner.episodes, learner.state)


class RecordSink(Protocol):
    """Saves records. The player's thread offers them, and must not wait."""

    def offer(self, record: Record, table: LearnedTable | None = None) -> None:
        """Take `record` as the newest, perhaps with its live table."""
        ...

    def begin_anew(self, record: Record) -> None:
        """Begin another session, and leave the current one saved."""
        ...

    def close(self) -> None:
        """Save the last record and end."""
        ...
