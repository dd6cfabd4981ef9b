"""Q-learning: off-policy TD control (Sutton & Barto, 2nd ed., box on page 131, equation 6.8)."""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.random import Generator

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, learn, one_update
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import best_value
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(NamedTuple):
    """An estimate and a count for each pair, [P]."""

    q: FloatArray
    visits: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits."""
    return Memory(q, visits)


@member_of(learn, Memory)
def _learn(
    memory: Memory,
    rule: Any,
    params: KernelParameters,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> Update:
    # Q(S,A) ← Q(S,A) + α [R + γ max_a Q(S′,a) − Q(S,A)]
    pair = experience.pair
    memory.visits[pair] += 1
    alpha = step_size(params, memory.visits[pair])
    bootstrap, bootstrap_state = 0.0, NO_STATE
    if not experience.terminated:
        bootstrap_state = experience.next_state
        first, last = pairs_of(tables, bootstrap_state)
        bootstrap = best_value(memory.q, first, last)
    before = memory.q[pair]
    after = before + alpha * (experience.reward + params.gamma * bootstrap - before)
    memory.q[pair] = after
    return one_update(pair, before, alpha, experience.reward, params.gamma, bootstrap, bootstrap_state, after)
