"""Exact figures of the greedy policy while a run goes on, at marks fixed by step number."""

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
    """What the greedy policy of some estimates earns; each is None where it has no exact value."""

    expected_return: float | None = None
    """The expected undiscounted return of an episode."""
    ends: float | None = None
    """Where the policy has no return: the probability (0 to 1) that an episode of it ends."""
    softened: float | None = None
    """The expected return with a uniformly random action ε of the time."""


NO_FIGURES: Final = GreedyEarnings()


class GreedyReturn:
    """The exact undiscounted return of the greedy policy, remembered while policy and world stay the same.

    ``mdp_now`` gives the world as it is, another one after each step where it drifts.
    """

    def __init__(self, mdp_now: Callable[[], TabularMDP | None]) -> None:
        self._mdp_now = mdp_now
        self._mdp: TabularMDP | None = None
        self._policy: FloatArray | None = None
        self._value: float | None = None
        self._figures: tuple[float | None, GreedyEarnings] | None = None  # with the ε they are for

    def __call__(self, q: FloatArray, ties: Ties) -> float | None:
        """Return it for the estimates ``q``, [P]; None where the policy has none."""
        mdp = self._mdp_now()
        if mdp is None:
            return None
        policy = greedy_policy(mdp, q, ties)
        if mdp is not self._mdp or self._policy is None or not np.array_equal(policy, self._policy):
            self._value = expected_return(mdp, policy)
            self._policy, self._mdp, self._figures = policy, mdp, None
        return self._value

    def figures(self, q: FloatArray, ties: Ties, epsilon: float | None) -> GreedyEarnings:
        """Return what may be shown in every frame of the greedy policy of the estimates ``q``, [P].

        ``epsilon`` is how often the agent takes a random action instead; None: it explores in another way.
        Figures that take too long in this world are left out.
        """
        mdp = self._mdp_now()
        if mdp is None or mdp.states > MOST_STATES or visits_of(mdp) > DEAREST_LIVE:
            return NO_FIGURES
        value, policy = self(q, ties), self._policy
        assert policy is not None
        chance = epsilon if is_quick(mdp) else None
        if self._figures is None:
            ends = chance_of_ending(mdp, policy) if value is None else None
            self._figures = 0.0, GreedyEarnings(value, ends, value)
        if self._figures[0] != chance:
            earned = None if chance is None else expected_return(mdp, softened(mdp, policy, chance))
            self._figures = chance, self._figures[1]._replace(softened=earned)
        return self._figures[1]


class MarksState(NamedTuple):
    """A copy of all marks, for checkpoints: how far they are apart, and two numbers of each, [M]."""

    spacing: int
    episode: IntArray
    value: FloatArray


class Evaluation:
    """Marks at multiples of a spacing that doubles, dropping every other mark, when there are many.

    Where they lie depends on the world and the step number only. The first spacing is 16 steps, or the power
    of two above that which keeps dear evaluations rare. There are no marks above 20,000 states, nor without a
    transition table. Where the world becomes so large on the way, marks go on without values.
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
        """The step number of the next mark; None where no marks are taken."""

    def mark(self, episodes: int, q: FloatArray | None, ties: Ties) -> None:
        """Take the mark that is due, after ``episodes`` finished ones, with the estimates ``q``, [P].

        Without estimates there is no value.
        """
        value = None if q is None or not self._has_values else self._greedy_return(q, ties)
        self._episode[self._used] = episodes
        self._value[self._used] = math.nan if value is None else value
        self._used += 1
        if self._used == len(self._value):
            self._thin_out()
        self.next_step = self._used * self._spacing

    def change_world(self, mdp: TabularMDP) -> None:
        """Go on in the world of ``mdp``, with marks further apart where each is dearer there."""
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
        """Return the marks taken so far."""
        used = slice(0, self._used)
        step = np.arange(self._used) * self._spacing
        return Marks(step, self._episode[used].copy(), self._value[used].copy())

    def checkpoint(self) -> MarksState:
        """Return a copy of all that is kept."""
        return MarksState(self._spacing, self._episode[: self._used].copy(), self._value[: self._used].copy())

    def restore(self, state: MarksState) -> None:
        """Go back to what :meth:`checkpoint` returned."""
        self._spacing, self._used = state.spacing, len(state.value)
        put_back((self._episode, self._value), state[1:])
        self.next_step = self._used * self._spacing if self._active else None
