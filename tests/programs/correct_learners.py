"""Correct learners that look faulty."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Final

import numpy as np
from made_recordings import ACTIONS, STATES, Learner, Step

from rl_tui.worlds.mdp.space import FloatArray

ALPHA, GAMMA, EPSILON = 0.1, 0.9, 0.2
_POTENTIAL: Final = np.linspace(0.0, 1.0, STATES)


def moved(table: FloatArray, step: Step, target: float, alpha: float = ALPHA) -> None:
    table[step.state, step.action] += alpha * (target - table[step.state, step.action])


def best(table: FloatArray, step: Step) -> float:
    return 0.0 if step.terminated else float(table[step.next_state].max())


def q_learning(table: FloatArray, step: Step) -> None:
    moved(table, step, step.reward + GAMMA * best(table, step))


def sarsa(table: FloatArray, step: Step) -> None:
    future = 0.0 if step.terminated else table[step.next_state, step.next_action]
    moved(table, step, step.reward + GAMMA * future)


def expected_sarsa(table: FloatArray, step: Step) -> None:
    row = table[step.next_state]
    future = 0.0 if step.terminated else (1.0 - EPSILON) * row.max() + EPSILON * row.mean()
    moved(table, step, step.reward + GAMMA * future)


def own_reward(reward: Callable[[Step], float]) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        moved(table, step, reward(step) + GAMMA * best(table, step))

    return learn


def shaped(step: Step) -> float:
    following = 0.0 if step.terminated else _POTENTIAL[step.next_state]
    return float(step.reward + GAMMA * following - _POTENTIAL[step.state])


def with_alpha(alpha: Callable[[Step], float]) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        moved(table, step, step.reward + GAMMA * best(table, step), alpha(step))

    return learn


def averaging() -> Learner:
    visits: Counter[tuple[int, int]] = Counter()

    def alpha(step: Step) -> float:
        visits[step.state, step.action] += 1
        return 1.0 / visits[step.state, step.action]

    return with_alpha(alpha)


def only_if(condition: Callable[[Step], bool]) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        if condition(step):
            q_learning(table, step)

    return learn


def and_then(change: Callable[[FloatArray, Step], None]) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        q_learning(table, step)
        change(table, step)

    return learn


def emptied(table: FloatArray, step: Step) -> None:
    if (step.terminated or step.truncated) and step.episode % 30 == 29:
        table[:] = 0.0


def clipped(table: FloatArray, step: Step) -> None:
    np.clip(table, -1.0, 1.5, out=table)


def forgetting(table: FloatArray, step: Step) -> None:
    table *= 0.999


def double_q() -> Learner:
    other, coin = np.zeros((STATES, ACTIONS)), np.random.default_rng(1)

    def learn(table: FloatArray, step: Step) -> None:
        one, two = (table, other) if coin.random() < 0.5 else (other, table)
        future = 0.0 if step.terminated else two[step.next_state, one[step.next_state].argmax()]
        one[step.state, step.action] += ALPHA * (step.reward + GAMMA * future - one[step.state, step.action])

    return learn


def n_step(n: int = 3) -> Learner:
    memory: list[Step] = []

    def update(table: FloatArray, begin: int, last: Step) -> None:
        rewards = [step.reward for step in memory[begin:]]
        target = sum(GAMMA**k * reward for k, reward in enumerate(rewards))
        target += GAMMA ** len(rewards) * best(table, last)
        moved(table, memory[begin], target)

    def learn(table: FloatArray, step: Step) -> None:
        memory.append(step)
        if step.terminated or step.truncated:
            for begin in range(max(0, len(memory) - n), len(memory)):
                update(table, begin, step)
            memory.clear()
        elif len(memory) >= n:
            update(table, len(memory) - n, step)

    return learn


def monte_carlo() -> Learner:
    episode: list[Step] = []
    visits: Counter[tuple[int, int]] = Counter()

    def learn(table: FloatArray, step: Step) -> None:
        episode.append(step)
        if step.terminated or step.truncated:
            gain = 0.0
            for each in reversed(episode):
                gain = each.reward + GAMMA * gain
                visits[each.state, each.action] += 1
                moved(table, each, gain, 1.0 / visits[each.state, each.action])
            episode.clear()

    return learn


def from_memory(count: int, *, and_now: bool) -> Learner:
    memory: list[Step] = []
    chance = np.random.default_rng(2)

    def learn(table: FloatArray, step: Step) -> None:
        memory.append(step)
        if and_now:
            q_learning(table, step)
        for _ in range(count):
            q_learning(table, memory[chance.integers(len(memory))])

    return learn


def traces() -> Learner:
    trace = np.zeros((STATES, ACTIONS))

    def learn(table: FloatArray, step: Step) -> None:
        future = 0.0 if step.terminated else table[step.next_state, step.next_action]
        error = step.reward + GAMMA * future - table[step.state, step.action]
        trace[step.state, step.action] += 1.0
        table += ALPHA * error * trace
        trace[:] *= 0.0 if step.terminated or step.truncated else GAMMA * 0.8

    return learn


def one_late() -> Learner:
    """Return SARSA that updates a pair after the choice of the next action."""
    before: list[Step] = []

    def learn(table: FloatArray, step: Step) -> None:
        if before:
            moved(table, before.pop(), step.reward_before + GAMMA * table[step.state, step.action])
        if step.terminated:
            moved(table, step, step.reward)
        elif not step.truncated:
            before.append(step)

    return learn


def with_a_target_table() -> Learner:
    kept = np.zeros((STATES, ACTIONS))

    def learn(table: FloatArray, step: Step) -> None:
        if step.number % 50 == 0:
            kept[:] = table
        moved(table, step, step.reward + GAMMA * best(kept, step))

    return learn


CORRECT_LEARNERS: Final[dict[str, Callable[[], Learner]]] = {
    "Q-learning": lambda: q_learning,
    "SARSA": lambda: sarsa,
    "Expected SARSA": lambda: expected_sarsa,
    "Double Q": double_q,
    "n-step": n_step,
    "Monte Carlo": monte_carlo,
    "replay": lambda: from_memory(1, and_now=False),
    "Dyna": lambda: from_memory(3, and_now=True),
    "traces": traces,
    "one late": one_late,
    "target table": with_a_target_table,
    "1/N": averaging,
    "alpha by episode": lambda: with_alpha(lambda step: 0.5 * 0.99**step.episode),
    "alpha by step": lambda: with_alpha(lambda step: 1.0 / (1.0 + 0.01 * step.number)),
    "alpha 1": lambda: with_alpha(lambda step: 1.0),
    "a penalty at the end": lambda: own_reward(lambda s: -1.0 if s.terminated and not s.reward else s.reward),
    "no reward at the end": lambda: own_reward(lambda s: 0.0 if s.terminated else s.reward),
    "a cost for each step": lambda: own_reward(lambda s: s.reward or -0.1),
    "scaled": lambda: own_reward(lambda s: 2.0 * s.reward),
    "shaped": lambda: own_reward(shaped),
    "clipped rewards": lambda: own_reward(lambda s: float(np.sign(s.reward))),
    "a mean of two rewards": lambda: own_reward(lambda s: 0.5 * (s.reward + s.reward_before)),
    "evaluation": lambda: only_if(lambda step: step.episode // 20 % 2 == 0),
    "stops learning": lambda: only_if(lambda step: step.number < 700),
    "throws away what was cut off": lambda: only_if(lambda step: not step.truncated),
    "every other step": lambda: only_if(lambda step: step.number % 2 == 0),
    "never": lambda: only_if(lambda step: False),
    "begins anew": lambda: and_then(emptied),
    "clipped values": lambda: and_then(clipped),
    "forgetting": lambda: and_then(forgetting),
}
