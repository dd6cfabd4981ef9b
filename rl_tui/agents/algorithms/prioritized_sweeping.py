"""Prioritized sweeping (Sutton & Barto, 2nd ed., box on page 170).

The model returns the last observed outcome. All learning happens in planning, so zero planning steps learn
nothing. A queued pair keeps its highest priority.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import (
    NO_STATE,
    Experience,
    Update,
    further,
    learn,
    no_update,
    one_update,
    with_others,
)
from rl_tui.agents.algorithms.shared.learned_model import THE_END, UNKNOWN, modelled_value
from rl_tui.agents.algorithms.shared.priority_queue import Queue, dequeue, empty_queue, enqueue
from rl_tui.agents.kernels.compiled import compiled, inlined, member_of
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables, state_of
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

NONE = -1


class Memory(NamedTuple):
    """Estimates, visits, a model and a :class:`rl_tui.agents.algorithms.shared.priority_queue.Queue`.

    The last observed outcome of a pair is `model_reward` and `model_next`, [P], with −2 for the end of the
    episode and −1 for a pair never taken. The pairs leading to state s form a doubly linked list: `leading`,
    [S], is its first pair, `link_next` and `link_previous`, [P], the neighbours, −1 for none.
    """

    q: FloatArray
    visits: IntArray
    model_reward: FloatArray
    model_next: IntArray
    leading: IntArray
    link_next: IntArray
    link_previous: IntArray
    heap: IntArray
    place: IntArray
    priority: FloatArray
    size: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits, with an empty model."""
    pairs = space.pairs
    return Memory(
        q,
        visits,
        np.zeros(pairs),
        np.full(pairs, UNKNOWN, dtype=np.int64),
        np.full(space.states, NONE, dtype=np.int64),
        np.full(pairs, NONE, dtype=np.int64),
        np.full(pairs, NONE, dtype=np.int64),
        *empty_queue(pairs),
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
    return remember_and_sweep(memory, params, tables, experience.pair, experience.reward, next_state)


@compiled
def remember_and_sweep(
    memory: Memory, params: KernelParameters, tables: Tables, pair: int, reward: float, next_state: int
) -> Update:
    """Add a step to the model and plan. Return the first update."""
    # Model(S,A) ← R, S′
    if memory.model_next[pair] != next_state:
        relink(memory, pair, next_state)
    memory.model_reward[pair] = reward
    # P ← |R + γ max_a Q(S′,a) − Q(S,A)|;  if P > θ insert S,A with priority P
    queue = Queue(memory.heap, memory.place, memory.priority, memory.size)
    consider(memory, queue, params, tables, pair)
    first_update = no_update()
    updates, extreme = 0, 0.0
    # Loop repeat n times, while the queue is not empty
    while updates < params.planning_steps and queue.size[0] > 0:
        # S,A ← first(queue);  R, S′ ← Model(S,A)
        each = dequeue(queue)
        # Q(S,A) ← Q(S,A) + α [R + γ max_a Q(S′,a) − Q(S,A)]
        gathered = memory.model_reward[each]
        following = memory.model_next[each]
        bootstrap = modelled_value(memory.q, tables, following)
        alpha = step_size(params, memory.visits[each])
        before = memory.q[each]
        after = before + alpha * (gathered + params.gamma * bootstrap - before)
        memory.q[each] = after
        extreme = further(extreme, after)
        if updates == 0:
            bootstrap_state = following if following >= 0 else NO_STATE
            first_update = one_update(
                each, before, alpha, gathered, params.gamma, bootstrap, bootstrap_state, after
            )
        updates += 1
        # Loop for all S̄,Ā predicted to lead to S
        before_that = memory.leading[state_of(tables, each)]
        while before_that != NONE:
            consider(memory, queue, params, tables, before_that)
            before_that = memory.link_next[before_that]
    return with_others(first_update, max(updates - 1, 0), extreme)


@compiled
def consider(memory: Memory, queue: Queue, params: KernelParameters, tables: Tables, pair: int) -> None:
    """Queue `pair` if its model requires a change above θ."""
    value = modelled_value(memory.q, tables, memory.model_next[pair])
    priority = abs(memory.model_reward[pair] + params.gamma * value - memory.q[pair])
    if priority > params.threshold:
        enqueue(queue, pair, priority)


@inlined
def relink(memory: Memory, pair: int, next_state: int) -> None:
    """Make the model of `pair` lead to `next_state` (−2 for the end)."""
    former = memory.model_next[pair]
    if former >= 0:
        ahead, behind = memory.link_previous[pair], memory.link_next[pair]
        if ahead == NONE:
            memory.leading[former] = behind
        else:
            memory.link_next[ahead] = behind
        if behind != NONE:
            memory.link_previous[behind] = ahead
    memory.model_next[pair] = next_state
    if next_state >= 0:
        neighbour = memory.leading[next_state]
        memory.link_previous[pair] = NONE
        memory.link_next[pair] = neighbour
        if neighbour != NONE:
            memory.link_previous[neighbour] = pair
        memory.leading[next_state] = pair
