"""Prioritized sweeping (Sutton & Barto, 2nd ed., box on page 170): planning backwards from what changed most.

The model is deterministic: it answers with what was last observed, also in a world of chance. Nothing is
learned from a step but what planning then makes of it, so without planning steps nothing is learned at all. A
pair waits with the highest priority found for it; of equal priorities the pair of the lower number comes
first.
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
    """All that prioritized sweeping remembers.

    The model of each pair, [P], is the ``model_reward`` and the ``model_next`` state last observed; the
    latter is −2 where the episode ended and −1 where the pair was never taken. The pairs that lead to state s
    are linked both ways: ``leading``, [S], is the first, ``link_next`` and ``link_previous``, [P], are its
    neighbours, −1 for none. The rest is the :class:`rl_tui.agents.algorithms.shared.priority_queue.Queue`.
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
    """Return the memory around an existing table of estimates and its visits, with nothing in the model."""
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
    """Take a step into the model and plan; the update returned is the first, of the most urgent pair."""
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
    """Queue ``pair`` if its model now asks for a change above θ."""
    value = modelled_value(memory.q, tables, memory.model_next[pair])
    priority = abs(memory.model_reward[pair] + params.gamma * value - memory.q[pair])
    if priority > params.threshold:
        enqueue(queue, pair, priority)


@inlined
def relink(memory: Memory, pair: int, next_state: int) -> None:
    """Let the model of ``pair`` lead to ``next_state``, −2 for the end, and no longer where it led."""
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
