"""Exact returns of the greedy policy during a run."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.policy_figures import chance_of_ending, expected_return, greedy_policy, softened
from rl_tui.agents.hyperparameters import Ties
from rl_tui.agents.learner_memory import put_back
from rl_tui.runs.exact_answers import DEAREST_LIVE, is_quick, visits_of
from rl_tui.runs.results import Marks
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_MARKS: Final = 256
FIRST_SPACING: Final = 16
MOST_STATES: Final = 20_000
VISITS_A_STEP: Final = 1_000


class GreedyEarnings(NamedTuple):
    """Expected returns of the greedy policy, or None without an exact value."""

    expected_return: float | None = None
    """Expected undiscounted return of an episode."""
    ends: float | None = None
    """If there is no return: the probability (0 to 1) that an episode ends."""
    softened: float | None = None
    """Expected return with a uniformly random action in a share ε of the steps."""


NO_FIGURES: Final = GreedyEarnings()


class GreedyReturn:
    """The exact undiscounted return of the greedy policy in the world of `mdp_now`, cached."""

    def __init__(self, mdp_now: Callable[[], TabularMDP | None]) -> None:
        self._mdp_now = mdp_now
        self._mdp: TabularMDP | None = None
        self._policy: FloatArray | None = None
        self._value: float | None = None
        self._figures: tuple[float | None, GreedyEarnings] | None = None  # with their ε
        self._judged: TabularMDP | None = None
        self._is_live = self._is_quick = False  # for the world judged last

    def __call__(self, q: FloatArray, ties: Ties) -> float | None:
        """Return it for the estimates `q`, `[P]`, or None."""
        mdp = self._mdp_now()
        if mdp is None:
            return None
        policy = greedy_policy(mdp, q, ties)
        if mdp is not self._mdp or self._policy is None or not np.array_equal(policy, self._policy):
            self._value = expected_return(mdp, policy)
            self._policy, self._mdp, self._figures = policy, mdp, None
        return self._value

    def figures(self, q: FloatArray, ties: Ties, epsilon: float | None) -> GreedyEarnings:
        """Return the numbers that are fast enough for every frame.

        `q` is `[P]`. `epsilon` is None for other ways to explore.
        """
        mdp = self._mdp_now()
        if mdp is not None and mdp is not self._judged:
            self._is_live = mdp.states <= MOST_STATES and visits_of(mdp) <= DEAREST_LIVE
            self._judged, self._is_quick = mdp, is_quick(mdp)
        if mdp is None or not self._is_live:
            return NO_FIGURES
        value, policy = self(q, ties), self._policy
        assert policy is not None
        chance = epsilon if self._is_quick else None
        if self._figures is None:
            ends = chance_of_ending(mdp, policy) if value is None else None
            self._figures = 0.0, GreedyEarnings(value, ends, value)
        if self._figures[0] != chance:
            earned = None if chance is None else expected_return(mdp, softened(mdp, policy, chance))
            self._figures = chance, self._figures[1]._replace(softened=earned)
        return self._figures[1]


class MarksState(NamedTuple):
    """A copy of all marks, `[M]`, for a checkpoint."""

    spacing: int
    episode: IntArray
    value: FloatArray


class Evaluation:
    """Marks at multiples of a spacing, which doubles once there are too many.

    Positions depend only on the world and the step number. Worlds above 20,000 states or without a transition
    table have none.
    """

    def __init__(self, mdp: TabularMDP | None, greedy_return: GreedyReturn, most: int = MOST_MARKS) -> None:
        self._greedy_return = greedy_return
        self._active = mdp is not None and mdp.states <= MOST_STATES
        self._has_values = self._active
        self._spacing = FIRST_SPACING
        while mdp is not None and self._spacing * VISITS_A_STEP < visits_of(mdp):
            self._spacing *= 2
        self._used = 0
        self._episode: IntArray = np.zeros(most, np.int64)
        self._value: FloatArray = np.zeros(most)
        self.next_step = 0 if self._active else None
        """Step of the next mark, or None if no marks are taken."""

    def mark(self, episodes: int, q: FloatArray | None, ties: Ties) -> None:
        """Take the mark that is due, without a value if `q`, `[P]`, is None."""
        value = None if q is None or not self._has_values else self._greedy_return(q, ties)
        self._episode[self._used] = episodes
        self._value[self._used] = math.nan if value is None else value
        self._used += 1
        if self._used == len(self._value):
            self._thin_out()
        self.next_step = self._used * self._spacing

    def change_world(self, mdp: TabularMDP) -> None:
        """Continue in `mdp`, perhaps with a larger spacing."""
        self._has_values = mdp.states <= MOST_STATES
        if not self._active or not self._has_values:
            return
        while self._spacing * VISITS_A_STEP < visits_of(mdp):
            self._thin_out()
        self.next_step = self._used * self._spacing

    def _thin_out(self) -> None:
        kept = (self._used + 1) // 2
        for array in (self._episode, self._value):
            array[:kept] = array[: self._used : 2].copy()
        self._used = kept
        self._spacing *= 2

    def marks(self) -> Marks:
        """Return all marks so far."""
        used = slice(0, self._used)
        step = np.arange(self._used) * self._spacing
        return Marks(step, self._episode[used].copy(), self._value[used].copy())

    def checkpoint(self) -> MarksState:
        """Return a copy of the state."""
        return MarksState(self._spacing, self._episode[: self._used].copy(), self._value[: self._used].copy())

    def restore(self, state: MarksState) -> None:
        """Restore the state from `checkpoint`."""
        self._spacing, self._used = state.spacing, len(state.value)
        put_back((self._episode, self._value), state[1:])
        self.next_step = self._used * self._spacing if self._active else None
