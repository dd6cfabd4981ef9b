"""An MDP seen only through observations, where several states can look the same.

The future then depends on the past, so there is no transition table over observations: a partially observable
process (Sutton & Barto, 2nd ed., section 17.3).
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from numpy.random import PCG64, Generator

from rl_tui.worlds.drawing import Drawing
from rl_tui.worlds.environment import StepResult
from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import Prospect, World


class ObservedEnvironment:
    """A simulated transition table that returns only observations.

    An unavailable action acts like the first available one. Nothing happens after the end.
    """

    def __init__(self, hidden: TabularMDP, looks: Sequence[int]) -> None:
        self._hidden, self._looks = hidden, looks
        self._generator = Generator(PCG64())
        self._state = int(hidden.start_state[0])
        self._steps = 0

    def reset(self, seed: int | None = None) -> int:
        """Start an episode and return its first observation."""
        if seed is not None:
            self._generator = Generator(PCG64(seed))
        mdp = self._hidden
        self._steps = 0
        self._state = int(mdp.start_state[self._drawn(mdp.start_cumulative)])
        return self._looks[self._state]

    def step(self, action: int) -> StepResult:
        """Take `action`. At the time limit the episode is truncated."""
        mdp, pairs = self._hidden, self._hidden.pairs_of(self._state)
        if not pairs:
            return StepResult(self._looks[self._state], 0.0, True, False)
        pair = mdp.pair_of(self._state, action)
        outcomes = mdp.outcomes_of(pairs[0] if pair is None else pair)
        outcome = outcomes[self._drawn(mdp.cumulative[outcomes.start : outcomes.stop])]
        reward, deviation = float(mdp.reward[outcome]), float(mdp.reward_std[outcome])
        if deviation > 0.0:
            reward += deviation * self._generator.standard_normal()
        self._steps += 1
        self._state = int(mdp.next_state[outcome])
        terminated = bool(mdp.terminated[outcome])
        truncated = not terminated and 0 < mdp.time_limit <= self._steps
        return StepResult(self._looks[self._state], reward, terminated, truncated)

    def _drawn(self, cumulative: np.ndarray) -> int:
        # no draw if only one outcome is possible
        return bisect_right(cumulative.tolist(), self._generator.random()) if len(cumulative) > 1 else 0


def observed_world(hidden: TabularMDP, names: Sequence[str], looks: Sequence[int], drawing: Drawing) -> World:
    """Return the simulated world of the observations `looks` of the states, [S].

    States with equal observations must have the same actions.
    """
    alike: list[list[int]] = [[] for _ in names]
    for state, look in enumerate(looks):
        alike[look].append(state)
    # the first state represents its observation: all pairs have the same order
    owned = [hidden.pairs_of(states[0]) for states in alike]
    space = FiniteSpace(
        state_names=tuple(names),
        action_names=hidden.action_names,
        first_pair=np.cumsum([0, *map(len, owned)], dtype=np.int64),
        pair_action=_actions(hidden, owned),
        time_limit=hidden.time_limit,
    )
    prospects = tuple(
        _prospects(hidden, looks, [hidden.pairs_of(state)[place] for state in states])
        for states, pairs in zip(alike, owned, strict=True)
        for place in range(len(pairs))
    )
    make = partial(ObservedEnvironment, hidden, tuple(looks))
    return World(space, drawing, new_environment=make, prospects=prospects)


def _actions(hidden: TabularMDP, owned: Sequence[range]) -> IntArray:
    return np.array([hidden.pair_action[pair] for pairs in owned for pair in pairs], dtype=np.int64)


def _prospects(hidden: TabularMDP, looks: Sequence[int], pairs: Sequence[int]) -> tuple[Prospect, ...]:
    # The `pairs` are those of states that look the same
    chances = [_chances(hidden, looks, pair) for pair in pairs]
    seen = dict.fromkeys(look for each in chances for look in each)
    return tuple(_prospect(look, [each.get(look, (0.0, 0.0)) for each in chances]) for look in seen)


def _prospect(look: int, chances: Sequence[tuple[float, float]]) -> Prospect:
    probabilities = [probability for probability, _ in chances]
    certain = math.isclose(min(probabilities), max(probabilities), abs_tol=1e-9)
    rewards = {round(reward, 9) for probability, reward in chances if probability > 0.0}
    return Prospect(look, probabilities[0] if certain else None, tuple(sorted(rewards)))


def _chances(hidden: TabularMDP, looks: Sequence[int], pair: int) -> Mapping[int, tuple[float, float]]:
    # Observation → probability and mean reward
    sums: dict[int, tuple[float, float]] = {}
    for outcome in hidden.outcomes_of(pair):
        probability, look = float(hidden.probability[outcome]), looks[int(hidden.next_state[outcome])]
        before, paid = sums.get(look, (0.0, 0.0))
        sums[look] = (before + probability, paid + probability * float(hidden.reward[outcome]))
    return {look: (chance, paid / chance) for look, (chance, paid) in sums.items() if chance > 0.0}
