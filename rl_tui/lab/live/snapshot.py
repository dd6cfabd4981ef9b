"""One frozen picture of a run: every number on screen comes from here."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from rl_tui.agents.exact.solution import Solution
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.last_step import Author, LastStep
from rl_tui.lab.live.until import Breakpoints
from rl_tui.lab.live.viewport import Window
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.timeline.branches import Branch
from rl_tui.worlds.mdp.tabular_mdp import FloatArray, IntArray
from rl_tui.worlds.world import World


class Phase(StrEnum):
    """What the run is doing."""

    PREPARING = "preparing"  # the world is built, the kernels are compiled or read from their cache
    PAUSED = "paused"
    RUNNING = "running"
    SEEKING = "seeking"  # on the way to another moment; until it is there, the last one is shown
    SPENT = "spent"  # the budget is used up
    DONE = "done"  # a planner has converged: Snapshot.message says so
    STOPPED = "stopped"  # runaway: Snapshot.message names the step


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Finished episodes in bins of equal width (the last one may be part-filled), oldest first, [B] each.

    ``episode`` is the last episode (from 1) in the bin; returns are undiscounted.
    """

    episode: IntArray
    return_mean: FloatArray
    return_low: FloatArray
    return_high: FloatArray
    length_mean: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Exact expected return of the greedy policy at marks fixed by step number, [M] each; NaN: undefined."""

    step: IntArray
    episode: IntArray
    expected_return: FloatArray


@dataclass(frozen=True, slots=True)
class BanditFigures:
    """How a bandit's budget was spent.

    ``winnings`` is the sum of rewards; ``regret`` the sum over pulls of max q* − q*(pulled arm), exact;
    ``best_arm_rate`` the share of pulls on the truly best arm, None before the first pull; ``best_possible``
    what as many pulls of that arm bring on average, pulls · max q*.
    """

    pulls: int
    budget: int
    winnings: float
    regret: float
    best_arm_rate: float | None
    best_possible: float


@dataclass(frozen=True, slots=True, eq=False)
class CellHistory:
    """How Q of ``pair`` went up to the moment shown: after ``step`` steps it was ``value``, [N] each.

    The steps ascend from 0 and end with the moment itself.
    """

    pair: int
    step: IntArray
    value: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class LaneView:
    """One of several runs side by side, as far as it is shown beside the others.

    ``name`` tells in a few words what is different here. ``q`` is [P], of a large world empty.
    """

    name: str
    algorithm: str
    hyperparameters: Hyperparameters
    step: int
    episodes: int
    q: FloatArray
    curve: Curve
    marks: Marks
    return_last_100: float | None
    greedy_return: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """Where a moment stands in time: ``branch`` is the number of the one in force of all ``branches``."""

    branches: tuple[Branch, ...] = (Branch("1"),)
    branch: int = 0

    @property
    def current(self) -> Branch:
        """The branch in force."""
        return self.branches[self.branch]

    @property
    def in_past(self) -> bool:
        """Whether the run has been further than here: to change something now forks it."""
        return self.current.here < self.current.end


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """A run at one step. Arrays are copies that nobody writes.

    ``speed`` is the wanted steps a second (None: as fast as it goes); ``steps_per_second`` the measured one
    (None while unknown). ``episodes`` counts finished episodes; ``episode_step`` and ``episode_return``
    belong to the one under way. ``state`` is where the agent is; after an episode's last step still the state
    it ended in, until the next episode begins; ``step_from`` is where the next step starts, which then is
    another state already (None where no step can be taken yet). ``q`` and ``visits`` are [P]; of a large
    world they are 0 outside of ``window``, which has what the screen shows: read them where :meth:`holds`
    says so.

    ``rewards``, [N], are those of the episode under way, or of the one that has just ended, oldest first; of
    a long episode the last ones only, up to step ``last.episode_step`` of it. ``discounted_return`` is that
    of the whole episode so far, seen from its start, with the γ that was in force at each step.

    ``lanes`` are the runs side by side, the one shown among them at place ``lane``; empty where there is
    one. ``until`` says what the run is on its way to, ``paused_by`` why it paused by itself; mostly both are
    empty. ``cell`` is the history of the pair asked for. ``handled`` counts the commands taken in so far.

    ``tables``, [P] each, are the two of Double Q-learning, of which ``q`` is the mean; ``values``, [S], is
    the V that a planner keeps. Both are empty elsewhere, and of a large world.

    ``author`` is who took the last step, None where it is whoever is in force. ``planning`` tells in words
    how a planner's sweep is getting on, empty for an agent.

    ``exact`` is the exact answer for the γ in force, None while it is computed or where there is none;
    ``exact_refused`` then says why. ``greedy_return`` is the exact expected undiscounted return of the greedy
    policy of this very ``q``, None where it has none or is too dear to compute live.
    """

    world: World
    recipe: Recipe
    algorithm: str
    hyperparameters: Hyperparameters
    phase: Phase
    message: str
    speed: float | None
    steps_per_second: float | None
    step: int
    episodes: int
    state: int
    episode_step: int
    episode_return: float
    q: FloatArray
    visits: IntArray
    last: LastStep | None
    curve: Curve
    marks: Marks
    return_last_100: float | None
    length_last_100: float | None
    greedy_return: float | None
    exact: Solution | None
    exact_refused: str
    bandit: BanditFigures | None
    window: Window | None = None
    planning: str = ""
    author: Author | None = None
    timeline: Timeline = Timeline()
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    until: str = ""
    paused_by: str = ""
    rewards: FloatArray = field(default_factory=lambda: np.empty(0))
    discounted_return: float = 0.0
    lanes: tuple[LaneView, ...] = ()
    lane: int = 0
    cell: CellHistory | None = None
    handled: int = 0
    step_from: int | None = None
    tables: tuple[FloatArray, ...] = ()
    values: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def learned_by(self) -> tuple[str, Hyperparameters]:
        """The algorithm and the hyper-parameters by which the last step was taken."""
        return (self.algorithm, self.hyperparameters) if self.author is None else self.author

    def holds(self, pair: int) -> bool:
        """Tell whether ``q`` and ``visits`` of ``pair`` are known."""
        return self.window is None or bool(self.window.held[pair])
