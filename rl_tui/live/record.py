"""The record of a playground, from which its position can be restored, and the interface for saving it."""

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
    """Saves the records of a playground, to a file or nowhere. The player's thread offers each new record,
    and must not wait.
    """

    def offer(self, record: Record, table: LearnedTable | None = None) -> None:
        """Take `record` as the newest. `table` is the live one at its position, if available."""
        ...

    def begin_anew(self, record: Record) -> None:
        """Take `record` as the beginning of another session. The current one remains as it was saved."""
        ...

    def close(self) -> None:
        """Save the last record and end."""
        ...
