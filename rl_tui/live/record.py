"""All that is needed to come back to where a playground was, small; and what keeps it."""

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
    """What a run has learned at one step."""

    q: FloatArray
    """[P], the estimates."""
    visits: IntArray
    """[P], how often each pair was updated or taken."""
    episodes: int
    """Finished episodes."""
    state: int
    """The state in which the agent is."""


@dataclass(frozen=True, slots=True)
class Record:
    """The runs of a playground, and what a person had set there."""

    lanes: tuple[RunRecord, ...]
    """The runs side by side, at least one."""
    shown: int = 0
    """The number of the run shown."""
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    """Where the run shown is to stop."""
    speed: float | None = None
    """The wanted steps a second, None for as fast as it goes."""
    drawn: DrawnPolicy = field(default_factory=DrawnPolicy)
    """The policy that a person drew."""
    answer_is_hidden: bool | None = None
    """Whether what would give the answer away is hidden; None: as the scenario says."""
    lesson: LessonRecord | None = None
    """The lesson that is taken, and how far; None: there is none."""
    table: LearnedTable | None = field(default=None, compare=False)
    """What the run shown had learned where it was left, None where that is not known. It is shown until the
    run is there again; nothing is learned from it, and it need not fit the world."""


def table_of(run: Run) -> LearnedTable:
    """Return what ``run`` has learned, as it stands."""
    learner = run.learner
    return LearnedTable(learner.q, learner.visits, learner.episodes, learner.state)


class RecordSink(Protocol):
    """What keeps the records of a playground: a file, or nothing at all.

    It is offered the newest record again and again, from the player's thread, and must not hold it up.
    """

    def offer(self, record: Record, table: LearnedTable | None = None) -> None:
        """Take ``record`` as the newest; ``table`` is the live one where it stands, if that is at hand."""

    def begin_anew(self, record: Record) -> None:
        """Take ``record`` as the beginning of another session; the one until now stays as it is."""

    def close(self) -> None:
        """Keep what was offered last; nothing will be offered any more."""
