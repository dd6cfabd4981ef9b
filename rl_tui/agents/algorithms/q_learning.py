"""Q-learning: off-policy TD control (Sutton & Barto, 2nd ed., box on page 131, equation 6.8)."""

from __future__ import annotations

from typing import NamedTuple

from numpy.random import Generator

from rl_tui.agents.action_rules import choose
from rl_tui.agents.algorithms.family import Transition, Update, act, learn
from rl_tui.agents.compiled import inlined, member_of
from rl_tui.agents.settings import EpsilonGreedy, Settings
from rl_tui.agents.tables import Tables
from rl_tui.worlds.mdp import FloatArray, IntArray


class Memory(NamedTuple):
    """All that Q-learning remembers: an estimate and a count for each pair, both [P]."""

    q: FloatArray
    visits: IntArray


def new_memory(q: FloatArray, visits: IntArray, tables: Tables) -> Memory:
    """Return the memory around an existing table of estimates and its visits."""
    return Memory(q, visits)


@inlined
def best_value(q: FloatArray, tables: Tables, state: int) -> float:
    """Return max over a of Q(state, a); the maximum over nothing is 0."""
    first = tables.first_pair[state]
    last = tables.first_pair[state + 1]
    if first == last:
        return 0.0
    best = float(q[first])
    for pair in range(first + 1, last):
        best = max(best, float(q[pair]))
    return best


@member_of(act, Memory)
def _act(
    memory: Memory, rule: EpsilonGreedy, epsilon: float, tables: Tables, state: int, generator: Generator
) -> tuple[int, bool]:
    # Choose A from S using the policy derived from Q (ε-greedy)
    return choose(rule, epsilon, memory.q, tables.first_pair[state], tables.first_pair[state + 1], generator)


@member_of(learn, Memory)
def _learn(memory: Memory, settings: Settings, tables: Tables, transition: Transition) -> Update:
    # Q(S,A) ← Q(S,A) + α [R + γ max_a Q(S′,a) − Q(S,A)]
    pair = transition.pair
    memory.visits[pair] += 1
    step_size = 1.0 / memory.visits[pair] if settings.sample_average else settings.alpha
    bootstrap = 0.0 if transition.terminated else best_value(memory.q, tables, transition.next_state)
    before = memory.q[pair]
    after = before + step_size * (transition.reward + settings.gamma * bootstrap - before)
    memory.q[pair] = after
    return Update(pair, before, step_size, bootstrap, after)
