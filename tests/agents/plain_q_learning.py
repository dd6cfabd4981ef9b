"""The box of page 131, written down slowly and without any of the program's kernels."""

from __future__ import annotations

import math

import numpy as np

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp import TabularMDP
from rl_tui.worlds.streams import Streams


def plain_q_learning(
    mdp: TabularMDP, settings: Hyperparameters, streams: Streams, steps: int
) -> tuple[np.ndarray, np.ndarray, list[tuple[float, int]]]:
    """Return Q and visits, [P], and the (return, length) of each finished episode."""
    q = dict.fromkeys(range(mdp.pairs), settings.initial_q)
    visits = dict.fromkeys(range(mdp.pairs), 0)
    episodes: list[tuple[float, int]] = []
    state, length, total = _start(mdp, streams.world), 0, 0.0
    for _ in range(steps):
        epsilon = settings.epsilon
        if settings.epsilon_decay:
            fade = math.exp(-settings.epsilon_decay * len(episodes))
            epsilon = settings.epsilon_min + (settings.epsilon - settings.epsilon_min) * fade
        pair = _epsilon_greedy(list(mdp.pairs_of(state)), q, epsilon, settings.ties, streams.learner)
        outcomes = list(mdp.outcomes_of(pair))
        outcome = outcomes[0]
        if len(outcomes) > 1:
            draw = streams.world.random()
            outcome = next(each for each in outcomes if draw < mdp.cumulative[each])
        reward = float(mdp.reward[outcome])
        if mdp.reward_std[outcome] > 0:
            reward += float(mdp.reward_std[outcome]) * streams.world.standard_normal()
        next_state = int(mdp.next_state[outcome])
        length, total = length + 1, total + reward
        visits[pair] += 1
        step_size = 1 / visits[pair] if settings.alpha == "sample-average" else float(settings.alpha)
        following = (
            0.0
            if mdp.terminated[outcome]
            else max((q[each] for each in mdp.pairs_of(next_state)), default=0.0)
        )
        q[pair] = q[pair] + step_size * (reward + settings.gamma * following - q[pair])
        if mdp.terminated[outcome] or length == mdp.time_limit:
            episodes.append((total, length))
            state, length, total = _start(mdp, streams.world), 0, 0.0
        else:
            state = next_state
    return np.array(list(q.values())), np.array(list(visits.values())), episodes


def _start(mdp: TabularMDP, generator: np.random.Generator) -> int:
    if len(mdp.start_state) == 1:
        return int(mdp.start_state[0])
    draw = generator.random()
    return int(next(s for s, c in zip(mdp.start_state, mdp.start_cumulative, strict=True) if draw < c))


def _epsilon_greedy(
    pairs: list[int], q: dict[int, float], epsilon: float, ties: str, generator: np.random.Generator
) -> int:
    draw = generator.random()
    if draw < epsilon:
        return pairs[int(draw / epsilon * len(pairs))]
    best = [pair for pair in pairs if q[pair] == max(q[each] for each in pairs)]
    if ties == "first":
        return best[0]
    return best[min(int((draw - epsilon) / (1 - epsilon) * len(best)), len(best) - 1)]
