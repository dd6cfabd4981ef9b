"""What a playback reads of a run, built-in or a watched program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rl_tui.agents.catalogue import SweepPhase
    from rl_tui.agents.hyperparameters import Hyperparameters
    from rl_tui.agents.kernels.watch import WatchedEvents
    from rl_tui.agents.last_step import Author
    from rl_tui.agents.learner_counters import Counters
    from rl_tui.runs.answers.policy_kind import PolicyKind
    from rl_tui.runs.edited_world import EditedWorld
    from rl_tui.runs.recipe import JournalEntry, Recipe
    from rl_tui.runs.results import RunResults
    from rl_tui.runs.run import WorldChanged
    from rl_tui.worlds.mdp.space import FloatArray, IntArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World


class PlayedAgent(Protocol):
    """The agent of a run, with P pairs."""

    @property
    def algorithm(self) -> str:
        """Id of the algorithm."""

    @property
    def hyperparameters(self) -> Hyperparameters:
        """Current hyperparameters."""

    @property
    def q(self) -> FloatArray:
        """Estimates, `[P]`."""

    @property
    def visits(self) -> IntArray:
        """Updates or visits of each pair, `[P]`."""

    @property
    def episodes(self) -> int:
        """Finished episodes."""

    @property
    def counters(self) -> Counters:
        """Steps, episodes, state, and last step."""

    @property
    def begins_episode(self) -> bool:
        """True if an episode has just ended or none has begun."""

    @property
    def author(self) -> Author | None:
        """Algorithm and settings of the last step, or None if current."""

    @property
    def noticed(self) -> WatchedEvents:
        """Watched events of the last step."""

    @property
    def mdp(self) -> TabularMDP | None:
        """Transition table, or None."""

    @property
    def drifted(self) -> object | None:
        """Figures of drifting means, or None in a constant world."""

    @property
    def converged(self) -> bool:
        """True for a planner that has converged."""

    @property
    def phase(self) -> SweepPhase | None:
        """Phase of a planner's last sweep, or None."""

    @property
    def planning(self) -> str:
        """Progress of a planner's sweep, in words."""

    def remembered(self, *names: str) -> tuple[FloatArray, ...]:
        """Return copies of those tables `names` that exist."""

    def set_time_budget(self, seconds: float) -> None:
        """Let the next advance return after about `seconds`."""


class PlayedRun(Protocol):
    """A run at one step."""

    @property
    def recipe(self) -> Recipe:
        """Start of the run."""

    @property
    def learner(self) -> PlayedAgent:
        """The agent."""

    @property
    def world(self) -> World:
        """The current world."""

    @property
    def edited(self) -> EditedWorld:
        """The current world with its edits."""

    @property
    def world_changes(self) -> tuple[WorldChanged, ...]:
        """All edits so far."""

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """All changes so far."""

    @property
    def step(self) -> int:
        """Steps taken."""

    @property
    def results(self) -> RunResults:
        """Results so far."""

    @property
    def noticed(self) -> bool:
        """True if the run stopped at a watched event."""

    @property
    def over(self) -> bool:
        """True if the run takes no further step."""

    @property
    def spent(self) -> bool:
        """True if it is over as intended."""

    @property
    def message(self) -> str:
        """Why the run has ended, empty if it has not."""

    @property
    def unknown_policies(self) -> Mapping[PolicyKind, str]:
        """Policies without values, each with the reason."""
