"""A plain agent and world for the boxes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.streams import Streams
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

Table = dict[int, float]


class Answer(NamedTuple):
    reward: float
    next_state: int
    terminated: bool
    truncated: bool


class PlainWorld:
    """A world that lasts ``steps`` steps and draws from its stream exactly as the program does.

    A box runs ``while world.steps_left``, begins every episode with ``start`` and returns its table. ε and α
    hold for a whole episode.
    """

    def __init__(
        self, mdp: TabularMDP, hyperparameters: Hyperparameters, streams: Streams, steps: int
    ) -> None:
        self.mdp, self.hyperparameters, self.steps_left = mdp, hyperparameters, steps
        self.nature, self.dice = streams
        self.visits = dict.fromkeys(range(mdp.pairs), 0)
        self.finished: list[tuple[float, int]] = []
        self.episode = -1

    def table(self) -> Table:
        return dict.fromkeys(range(self.mdp.pairs), self.hyperparameters.initial_q)

    def counts(self) -> dict[int, int]:
        return dict.fromkeys(range(self.mdp.pairs), 0)

    def start(self) -> int:
        self.episode += 1
        self.rewards: list[float] = []
        if len(self.mdp.start_state) == 1:
            return int(self.mdp.start_state[0])
        draw = self.nature.random()
        starts = zip(self.mdp.start_state, self.mdp.start_cumulative, strict=True)
        return int(next(state for state, cumulative in starts if draw < cumulative))

    def take(self, pair: int) -> Answer:
        self.steps_left -= 1
        self.visits[pair] += 1
        outcomes = list(self.mdp.outcomes_of(pair))
        outcome = outcomes[0]
        if len(outcomes) > 1:
            draw = self.nature.random()
            outcome = next(each for each in outcomes if draw < self.mdp.cumulative[each])
        reward = float(self.mdp.reward[outcome])
        if self.mdp.reward_std[outcome] > 0:
            reward += float(self.mdp.reward_std[outcome]) * self.nature.standard_normal()
        self.rewards.append(reward)
        terminated = bool(self.mdp.terminated[outcome])
        truncated = not terminated and len(self.rewards) == self.mdp.time_limit
        if terminated or truncated:
            self.finished.append((_sum(self.rewards), len(self.rewards)))
        return Answer(reward, int(self.mdp.next_state[outcome]), terminated, truncated)

    def pairs(self, state: int) -> list[int]:
        return list(self.mdp.pairs_of(state))

    def choose(self, state: int, q: Table) -> int:
        """One draw decides whether to explore and, stretched again, what to take."""
        pairs, epsilon = self.pairs(state), self.epsilon
        draw = self.dice.random()
        if draw < epsilon:
            return pairs[int(draw / epsilon * len(pairs))]
        return self.argmax(state, q, (draw - epsilon) / (1 - epsilon))

    def argmax(self, state: int, q: Table, draw: float) -> int:
        """If ties are random, ``draw`` in [0, 1) decides between equals."""
        best = [pair for pair in self.pairs(state) if q[pair] == self.best(state, q)]
        return (
            best[0]
            if self.hyperparameters.ties == "first"
            else best[min(int(draw * len(best)), len(best) - 1)]
        )

    def best(self, state: int, q: Table) -> float:
        return max((q[pair] for pair in self.pairs(state)), default=0.0)

    def probability(self, state: int, pair: int, q: Table) -> float:
        """Return π(a|s): all pairs share ε, and the greedy ones share the rest."""
        pairs = self.pairs(state)
        best = [each for each in pairs if q[each] == self.best(state, q)]
        greedy = best[:1] if self.hyperparameters.ties == "first" else best
        share = 1 / len(greedy) if pair in greedy else 0.0
        return (1 - self.epsilon) * share + self.epsilon / len(pairs)

    def expectation(self, state: int, q: Table) -> float:
        """The best with 1 − ε, the mean of all with ε."""
        pairs = self.pairs(state)
        if not pairs:
            return 0.0
        return (1 - self.epsilon) * self.best(state, q) + self.epsilon * _sum(q[p] for p in pairs) / len(
            pairs
        )

    @property
    def epsilon(self) -> float:
        hyperparameters = self.hyperparameters
        return self._scheduled(
            hyperparameters.epsilon_schedule,
            hyperparameters.epsilon,
            hyperparameters.epsilon_min,
            hyperparameters.epsilon_decay,
        )

    def step_size(self, count: int) -> float:
        hyperparameters = self.hyperparameters
        if "sample-average" in (hyperparameters.alpha, hyperparameters.step_size_schedule):
            return 1 / count
        return self._scheduled(
            hyperparameters.step_size_schedule,
            float(hyperparameters.alpha),
            hyperparameters.alpha_min,
            hyperparameters.alpha_decay,
        )

    def _scheduled(self, schedule: str, start: float, least: float, decay: float) -> float:
        if decay == 0 or schedule == "constant":
            return start
        if schedule == "exponential":
            return least + (start - least) * math.exp(-decay * self.episode)
        if start >= least:
            return max(least, start - decay * self.episode)
        return min(least, start + decay * self.episode)


def as_array(table: Table | dict[int, int]) -> np.ndarray:
    return np.array([table[pair] for pair in sorted(table)])


def _sum(numbers: Iterable[float]) -> float:
    """Round after each addition. The built-in sum rounds less since Python 3.12."""
    total = 0.0
    for number in numbers:
        total += number
    return total
