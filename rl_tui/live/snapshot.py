"""A frozen picture of a run, and the source of every number on screen."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.agents.catalogue import Algorithm, algorithm_row
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.state import ENDED, State
from rl_tui.live.world_editor import EditorView
from rl_tui.runs.answers.view import AnswersView
from rl_tui.runs.timeline.branches import Timeline
from rl_tui.runs.timeline.lane_view import RunGroupView

if TYPE_CHECKING:
    from rl_tui.agents.catalogue import SweepPhase
    from rl_tui.agents.hyperparameters import Hyperparameters
    from rl_tui.agents.last_step import Author
    from rl_tui.agents.learner_counters import Counters
    from rl_tui.lessons.file.view import LessonView
    from rl_tui.live.program_view import ProgramView
    from rl_tui.live.viewport import CopiedPart
    from rl_tui.runs.exact_answers import Answer
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.results import RunResults
    from rl_tui.runs.run import WorldChanged
    from rl_tui.runs.timeline.table_samples import CellHistory, ErrorHistory
    from rl_tui.runs.timeline.trail import Trail
    from rl_tui.studies.many_seeds.figures import SeedStudy
    from rl_tui.studies.world_check.world_checks import WorldCheckView
    from rl_tui.worlds.mdp.space import FloatArray, IntArray
    from rl_tui.worlds.world import World


# The snapshot


class Phase(StrEnum):
    """The activity of a run."""

    PREPARING = "preparing"  # the world is being built
    PAUSED = "paused"
    RUNNING = "running"
    SEEKING = "seeking"  # another step is sought; the last one is shown until then
    SPENT = "spent"  # the budget is used up
    DONE = "done"  # a planner has converged; see PlaybackView.message
    STOPPED = "stopped"  # estimates diverged; PlaybackView.message names the step


PHASES: Final = {
    State.BUILDING: Phase.PREPARING,
    State.UNTIL: Phase.RUNNING,
    **{state: Phase[state.name] for state in (State.SEEKING, State.RUNNING, State.PAUSED, *ENDED)},
}
"""Phase of each state. While training or rebuilding, the next state's phase is reported."""


@dataclass(frozen=True, slots=True, eq=False)
class AgentView:
    """The agent and its estimates, of P pairs and S states."""

    algorithm: str
    """Id of the current algorithm."""
    hyperparameters: Hyperparameters
    """Current hyperparameters."""
    q: FloatArray
    """Estimates, `[P]`, in a large world 0 outside of `part`, see `holds`."""
    visits: IntArray
    """Updates or visits of each pair, `[P]`, in a large world as `q`."""
    part: CopiedPart | None = None
    """The visible part of a large world, or None if everything was copied."""
    tables: tuple[FloatArray, ...] = ()
    """The two tables of Double Q-learning, `[P]` each, whose mean is `q`, else empty, also with a `part`."""
    values: FloatArray = field(default_factory=lambda: np.empty(0))
    """V of a planner, `[S]`, else empty, also with a `part`."""
    policy: FloatArray = field(default_factory=lambda: np.empty(0))
    """π(a|s) of policy iteration, `[P]`, else empty, also with a `part`."""
    sweep: SweepPhase | None = None
    """Phase of the sweep of the last step, or None."""
    planning: str = ""
    """Progress of a planner's sweep, in words, empty for an agent."""
    author: Author | None = None
    """Algorithm and settings of the last step, or None if they are the current ones."""

    @property
    def row(self) -> Algorithm:
        """The algorithm's row in the catalogue."""
        return algorithm_row(self.algorithm)

    @property
    def learned_by(self) -> tuple[str, Hyperparameters]:
        """Algorithm and hyperparameters of the last step."""
        return (self.algorithm, self.hyperparameters) if self.author is None else self.author

    def holds(self, pair: int) -> bool:
        """Return True if `q` and `visits` of `pair` are known."""
        return self.part is None or bool(self.part.held[pair])


@dataclass(frozen=True, slots=True, eq=False)
class PlaybackView:
    """The activity of a playback, and its settings."""

    phase: Phase = Phase.PREPARING
    """Current activity."""
    message: str = ""
    """Why it has ended or waits, as a sentence, usually empty."""
    speed: float | None = None
    """Chosen steps per second, or None for full speed."""
    steps_per_second: float | None = None
    """Measured steps per second, or None while unknown."""
    interpreted: bool = False
    """True while a run is interpreted, which is much slower."""
    stays_interpreted: str = ""
    """Reason why no machine code will come, as a sentence, else empty."""
    watching: str = ""
    """What the speed follows, if it follows learning, usually empty."""
    until: str = ""
    """The event to run until, in words, usually empty."""
    paused_by: str = ""
    """Reason for an automatic pause, in words, usually empty."""
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    """States and pairs at which it pauses."""
    handled: int = 0
    """Number of commands handled."""


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """A run at one step. Its arrays are copies that nothing modifies."""

    world: World
    """World of the run."""
    recipe: Recipe
    """Start of the run."""
    agent: AgentView
    """The agent with its settings and estimates."""
    counters: Counters
    """Steps, episodes, state of the agent, and the last step."""
    results: RunResults
    """Returns so far, and exact returns of the greedy policy."""
    exact_answer: Answer
    """The solution for the current γ, or the reason why there is none. Both empty while pending."""
    playback: PlaybackView
    """Activity and settings of the playback."""
    answers: AnswersView = field(default_factory=AnswersView)
    """Answers to the user's questions."""
    timeline: Timeline = field(default_factory=Timeline)
    """Position among all branches."""
    run_group: RunGroupView = field(default_factory=RunGroupView)
    """All runs side by side."""
    cell: CellHistory | None = None
    """History of the requested pair, or None."""
    value_errors: ErrorHistory | None = None
    """History of the error of V if every state has one action, else None."""
    beside: Snapshot | None = None
    """Snapshot of the second visible run at its own step, without cell history, or None if only one run is
    visible.
    """
    study: SeedStudy | None = None
    """The study of many seeds, or None unless requested."""
    world_check: WorldCheckView | None = None
    """The world check, or None unless requested."""
    trail: Trail = ()
    """Last steps of the episode, oldest first, empty if unknown."""
    world_changes: tuple[WorldChanged, ...] = ()
    """Earlier edits of the world, oldest first."""
    editor: EditorView = field(default_factory=EditorView)
    """State of the world editor."""
    lesson: LessonView | None = None
    """The current lesson, or None."""
    program: ProgramView | None = None
    """The watched program that takes the steps, or None for a built-in agent."""
