"""Tabular Dyna-Q (Sutton & Barto, 2nd ed., box on page 164).

The model returns the last observed outcome. In a stochastic world, planning therefore pulls the estimates
towards one of several outcomes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, further, learn
from rl_tui.agents.algorithms.shared.learned_model import THE_END, UNKNOWN, modelled_value
from rl_tui.agents.kernels.compiled import compiled, member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(NamedTuple):
    """Estimates, visits and a model.

    The last observed outcome of a pair is `model_reward` and `model_next`, [P], with −2 for the end of the
    episode and −1 for a pair never taken. The first ``observed_count[0]`` entries of `observed`, [S], are the
    visited states. From first_pair[s] on, `tried`, [P], lists the ``tried_count[s]`` pairs taken in state s.
    """

    q: FloatArray
    visits: IntArray
    model_reward: FloatArray
    model_next: IntArray
    observed: IntArray
    observed_count: IntArray
    tried: IntArray
    tried_count: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits, with an empty model."""
    return Memory(
        q,
        visits,
        model_reward=np.zeros(space.pairs),
        model_next=np.full(space.pairs, UNKNOWN, dtype=np.int64),
        observed=np.zeros(space.states, dtype=np.int64),
        observed_count=np.zeros(1, dtype=np.int64),
        tried=np.zeros(space.pairs, dtype=np.int64),
        tried_count=np.zeros(space.states, dtype=np.int64),
    )


@member_of(learn, Memory)
def _learn(
    memory: Memory,
    rule: Any,
    params: KernelParameters,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> Update:
    memory.visits[experience.pair] += 1
    next_state = THE_END if experience.terminated else experience.next_state
    return learn_and_practise(
        memory, params, tables, experience.state, experience.pair, experience.reward, next_state, generator
    )


@compiled
def learn_and_practise(
    memory: Memory,
    params: KernelParameters,
    tables: Tables,
    state: int,
    pair: int,
    reward: float,
    next_state: int,
    generator: Generator,
) -> Update:
    """Learn from a step, then from n steps of the model, and return the update of the real step.

    Each draw picks an observed state, and its fractional part, uniform again, the action.
    """
    q, visits = memory.q, memory.visits
    # Q(S,A) ← Q(S,A) + α [R + γ max_a Q(S′,a) − Q(S,A)]
    alpha = step_size(params, visits[pair])
    before = q[pair]
    bootstrap = modelled_value(q, tables, next_state)
    after = before + alpha * (reward + params.gamma * bootstrap - before)
    q[pair] = after
    extreme = after
    # Model(S,A) ← R, S′
    if memory.model_next[pair] == UNKNOWN:
        if memory.tried_count[state] == 0:
            memory.observed[memory.observed_count[0]] = state
            memory.observed_count[0] += 1
        memory.tried[np.int64(tables.first_pair[state]) + memory.tried_count[state]] = pair
        memory.tried_count[state] += 1
    memory.model_reward[pair] = reward
    memory.model_next[pair] = next_state
    # Loop repeat n times
    for _ in range(params.planning_steps):
        # S ← random previously observed state
        place = uniform(generator) * memory.observed_count[0]
        index = int(place)
        imagined = memory.observed[index]
        # A ← random action previously taken in S
        chance = place - index
        choice = int(chance * memory.tried_count[imagined])
        each = memory.tried[np.int64(tables.first_pair[imagined]) + choice]
        # R, S′ ← Model(S,A);  Q(S,A) ← Q(S,A) + α [R + γ max_a Q(S′,a) − Q(S,A)]
        value = modelled_value(q, tables, memory.model_next[each])
        target = memory.model_reward[each] + params.gamma * value
        q[each] += step_size(params, visits[each]) * (target - q[each])
        extreme = further(extreme, q[each])
    return Update(
        pair,
        before,
        alpha,
        reward,
        params.gamma,
        bootstrap,
        next_state if next_state >= 0 else NO_STATE,
        after,
        params.planning_steps,
        extreme,
        0,
    )
