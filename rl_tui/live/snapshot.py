"""The snapshot: one frozen picture of a run, and the source of every number on screen.

``Playable`` is the interface of a playback, which publishes snapshots.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from rl_tui.agents.catalogue import Algorithm, algorithm_row
from rl_tui.live.commands import Command
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.record import LearnedTable, Record
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
    from rl_tui.runs.timeline.table_samples import CellHistory
    from rl_tui.runs.timeline.trail import Trail
    from rl_tui.studies.many_seeds.figures import SeedStudy
    from rl_tui.studies.world_check.world_checks import WorldCheckView
    from rl_tui.worlds.mdp.space import FloatArray, IntArray
    from rl_tui.worlds.world import World


# The snapshot


class Phase(StrEnum):
    """What the run is doing."""

    PREPARING = "preparing"  # the world is built
    PAUSED = "paused"
    RUNNING = "running"
    SEEKING = "seeking"  # another step is sought; until it is there, the last one is shown
    SPENT = "spent"  # the budget is used up
    DONE = "done"  # a planner has converged: PlaybackView.message says so
    STOPPED = "stopped"  # runaway: PlaybackView.message names the step


PHASES: Final = {
    State.BUILDING: Phase.PREPARING,
    State.UNTIL: Phase.RUNNING,
    **{state: Phase[state.name] for state in (State.SEEKING, State.RUNNING, State.PAUSED, *ENDED)},
}
"""What a snapshot tells of each state; while it trains or rebuilds, that of the state in which it goes on."""


@dataclass(frozen=True, slots=True, eq=False)
class AgentView:
    """The agent: by what it learns, and what it has learned. P are the pairs, S the states of the world."""

    algorithm: str
    """The id of the algorithm in force."""
    hyperparameters: Hyperparameters
    """The hyper-parameters in force."""
    q: FloatArray
    """[P], the estimates; of a large world 0 outside of ``part``: see :meth:`holds`."""
    visits: IntArray
    """[P], how often each pair was updated or taken; of a large world as ``q``."""
    part: CopiedPart | None = None
    """Of a large world the part that was copied, which has what the screen shows; None: all was copied."""
    tables: tuple[FloatArray, ...] = ()
    """[P] each, the two of Double Q-learning, of which ``q`` is the mean; else, or with a ``part``, none."""
    values: FloatArray = field(default_factory=lambda: np.empty(0))
    """[S], the V that a planner keeps; else, or with a ``part``, empty."""
    policy: FloatArray = field(default_factory=lambda: np.empty(0))
    """[P], the probabilities of the policy that policy iteration keeps; else, or with a ``part``, empty."""
    sweep: SweepPhase | None = None
    """What the sweep of the last step does to that policy; None: nothing, or there was no sweep yet."""
    planning: str = ""
    """How a planner's sweep is getting on, in words; empty for an agent that learns."""
    author: Author | None = None
    """By what the last step was taken; None: by what is in force."""

    @property
    def row(self) -> Algorithm:
        """The algorithm's row of the catalogue; a program whose update is not known has its own."""
        return algorithm_row(self.algorithm)

    @property
    def learned_by(self) -> tuple[str, Hyperparameters]:
        """The algorithm and the hyper-parameters by which the last step was taken."""
        return (self.algorithm, self.hyperparameters) if self.author is None else self.author

    def holds(self, pair: int) -> bool:
        """Return whether ``q`` and ``visits`` of ``pair`` are known."""
        return self.part is None or bool(self.part.held[pair])


@dataclass(frozen=True, slots=True, eq=False)
class PlaybackView:
    """What the run is doing, and what was asked of it."""

    phase: Phase = Phase.PREPARING
    """What the run is doing."""
    message: str = ""
    """Why it goes no further or what it waits for, as a sentence; mostly empty."""
    speed: float | None = None
    """The wanted steps a second; None: as fast as it goes."""
    steps_per_second: float | None = None
    """The measured steps a second; None while unknown."""
    interpreted: bool = False
    """Whether a run goes on interpreted, far more slowly, until its machine code is there."""
    stays_interpreted: str = ""
    """Why no machine code will come, as a sentence; empty where it may."""
    watching: str = ""
    """What its speed goes by, in words, where that is what is learned; mostly empty."""
    until: str = ""
    """What the run is on its way to, in words; mostly empty."""
    paused_by: str = ""
    """Why it paused by itself, in words; mostly empty."""
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    """The states and pairs where it pauses."""
    handled: int = 0
    """How many commands were taken in so far."""


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """A run at one step. Its arrays are copies that are never written to."""

    world: World
    """The world of the run."""
    recipe: Recipe
    """What the run began with."""
    agent: AgentView
    """The algorithm, its settings, and what it has learned."""
    counters: Counters
    """Steps, episodes, where the agent is, and its last step."""
    results: RunResults
    """The returns so far, and how good the greedy policy is."""
    exact_answer: Answer
    """The exact answer for the γ in force, or why there is none; both empty while it is worked out."""
    playback: PlaybackView
    """What the run is doing, and what was asked of it."""
    answers: AnswersView = field(default_factory=AnswersView)
    """What a person has asked of it beside, and the answers."""
    timeline: Timeline = field(default_factory=Timeline)
    """Where this moment stands among all branches."""
    run_group: RunGroupView = field(default_factory=RunGroupView)
    """The runs side by side."""
    cell: CellHistory | None = None
    """How Q of the pair that was asked for went up to here; None: of no pair."""
    beside: Snapshot | None = None
    """The lane that stands beside the one shown, at its own moment, without cell; None: there is none."""
    study: SeedStudy | None = None
    """What many seeds say of these runs; None where nobody has asked."""
    world_check: WorldCheckView | None = None
    """What an author wants to know of the world of the run shown; None while nobody asks."""
    trail: Trail = ()
    """The last steps of the episode up to the last one, oldest first; none where they are not known."""
    world_changes: tuple[WorldChanged, ...] = ()
    """Where on the way the world of the run became another one, oldest first."""
    editor: EditorView = field(default_factory=EditorView)
    """What a person draws of the world."""
    lesson: LessonView | None = None
    """The lesson that is taken beside the runs, None where there is none."""
    program: ProgramView | None = None
    """The program that takes the steps, where that is not rl-tui's own agent."""


# The interface of a playback


class MakePlayable(Protocol):
    """Makes what a player plays."""

    def __call__(self, on_news: Callable[[], None], *, automatic: bool) -> Playable:
        """Return it; ``on_news`` is called, from any thread, when there is something new to show.

        With ``automatic`` off no step passes but those that commands ask for.
        """


class Playable(Protocol):
    """Takes commands and works them off in short pieces: see :class:`Playback`, which is the model."""

    handled: int
    touched: bool

    @property
    def state(self) -> State:
        """What it is doing."""

    @property
    def phase(self) -> Phase:
        """What a snapshot says that it is doing."""

    @property
    def changed(self) -> bool:
        """Whether there is something new to show."""

    @property
    def loaded(self) -> tuple[bool, bool]:
        """What changes when libraries were loaded."""

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""

    @property
    def record(self) -> Record:
        """What is needed to come back to here."""

    @property
    def table(self) -> LearnedTable | None:
        """The live table of what is shown, None where there is none."""

    @property
    def unanswered(self) -> float:
        """For how many seconds what it waits for has not answered; 0 where it does not wait."""

    def takes(self, command: Command) -> bool:
        """Return True if ``command`` need not wait."""

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to."""

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""

    def snapshot(self) -> Snapshot:
        """Return the newest picture."""

    def close(self) -> None:
        """End what it has started beside the player's thread; called from another one."""
