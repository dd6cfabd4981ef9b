"""NumPy agents that leave a recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rl_tui.programs.watched.messages import CHANGE_WIDTH, STEP_WIDTH, StepFlag
from rl_tui.programs.watched.recording import Recording
from rl_tui.worlds.mdp.space import FloatArray


@dataclass
class Made:
    """A random world with an agent. ``rule`` is q, sarsa or expected; ``alpha(visits, episode)``."""

    rule: str = "q"
    alpha: Callable[[int, int], float] = lambda visits, episode: 0.1
    gamma: float = 0.9
    epsilon: float = 0.2
    states: int = 12
    actions: int = 3
    seed: int = 0
    dtype: Any = np.float64
    initial: float = 0.0
    bootstraps_after_end: bool = False
    reward_late: bool = False
    reward_before_at_first: float | None = None
    """The reward before the first step of an episode. None: the last reward of the episode before."""
    own_reward: Callable[[int, int, int, float], float] | None = None
    minus_one: bool = False
    sparse: bool = False
    time_limit: int = 60
    late_update: bool = False
    evaluates_every: int = 0

    def recording(self, steps: int) -> Recording:
        rng = np.random.default_rng(self.seed)
        successors = rng.integers(0, self.states, (self.states, self.actions, 3))
        rewards = -np.ones(self.states) if self.minus_one else rng.normal(size=self.states).round(2)
        if self.sparse:
            rewards = np.zeros(self.states)
            rewards[-1] = 1.0
        q = np.full((self.states, self.actions), self.initial, self.dtype)
        q[-1] = 0 if not self.bootstraps_after_end else self.initial
        recording = Recording()
        recording.find_table(0, self.actions, q.astype(float).ravel())
        visits = np.zeros((self.states, self.actions), int)
        rows: list[tuple[float, ...]] = []
        changes: list[tuple[float, ...]] = []
        episode, before = 0, 0.0

        def chosen(state: int) -> int:
            if rng.random() < self.epsilon:
                return int(rng.integers(self.actions))
            row = q[state].tolist()
            best = [action for action, value in enumerate(row) if value == max(row)]
            return best[rng.integers(len(best))]

        def update(step: int, s: int, a: int, r: float, s2: int, a2: int, ended: bool) -> None:
            visits[s, a] += 1
            value = q[s2, a2] if self.rule == "sarsa" else q[s2].max()
            if self.rule == "expected":
                value = (1 - self.epsilon) * value + self.epsilon * q[s2].mean()
            if ended and not self.bootstraps_after_end:
                value = 0.0
            if self.own_reward:
                r = self.own_reward(s, a, s2, r)
            old = float(q[s, a])
            q[s, a] += self.alpha(int(visits[s, a]), episode) * (r + self.gamma * value - q[s, a])
            if float(q[s, a]) != old:
                changes.append((step, s * self.actions + a, old, float(q[s, a])))

        while len(rows) < steps:
            state, place, ended = int(rng.integers(self.states - 1)), 0, False
            action = chosen(state)
            learns = not self.evaluates_every or (episode + 1) % self.evaluates_every > 0
            waiting: tuple[int, int, float] | None = None
            while not ended and place < self.time_limit and len(rows) < steps:
                s2 = int(successors[state, action, rng.integers(3)])
                reward, ended = float(rewards[s2]), s2 == self.states - 1
                cut = not ended and place + 1 == self.time_limit
                rows.append((0, state, action, reward, s2, ended + 2 * cut, episode, place))
                if place == 0 and self.reward_before_at_first is not None:
                    before = self.reward_before_at_first
                used = before if self.reward_late else reward
                a2 = chosen(s2)
                number = len(rows) - 1
                if learns and self.late_update:
                    if waiting:
                        update(number, *waiting, state, action, False)
                    waiting = (state, action, reward)
                    if ended:
                        update(number, *waiting, s2, a2, True)
                elif learns:
                    update(number, state, action, used, s2, a2, ended)
                if self.rule == "q":
                    a2 = chosen(s2)
                before, state, action, place = reward, s2, a2, place + 1
            episode += 1
        recording.add(
            np.array(rows, float).reshape(-1, STEP_WIDTH), np.array(changes, float).reshape(-1, CHANGE_WIDTH)
        )
        return recording


def sent(recording: Recording) -> tuple[FloatArray, FloatArray]:
    """Return the steps, [n, 8], and changes, [m, 4], in their pipe format."""
    steps, changes = recording.steps, recording.changes
    flags = steps.terminated * StepFlag.TERMINATED + steps.truncated * StepFlag.TRUNCATED
    rows = np.column_stack((*steps[:5], flags, steps.episode, steps.episode_step))
    return rows.astype(np.float64), np.column_stack(changes)
