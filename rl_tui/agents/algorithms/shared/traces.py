"""Eligibility traces of state–action pairs (Sutton & Barto, 2nd ed., chapter 12).

Only pairs that have a trace are visited, so that a step costs no more in a large table than in a small one.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, further
from rl_tui.agents.algorithms.shared.next_action import nothing_chosen
from rl_tui.agents.kernels.compiled import inlined
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

# Below this a trace is dropped: else every step would go on moving all pairs of a long episode, by amounts
# that no digit shows.
FADED: Final = 1e-12


class TracedMemory(NamedTuple):
    """What an algorithm with traces remembers.

    The estimates ``q``, the counts ``visits`` and the traces ``eligibility`` are [P]. ``active``, [P], begins
    with the ``active_count[0]`` pairs whose trace is not 0. ``chosen``, [2], is A′ as
    :mod:`rl_tui.agents.algorithms.shared.next_action` has it.
    """

    q: FloatArray
    visits: IntArray
    eligibility: FloatArray
    active: IntArray
    active_count: IntArray
    chosen: IntArray


def no_traces(q: FloatArray, visits: IntArray, space: FiniteSpace) -> TracedMemory:
    """Return the memory at the start of an episode, around a table of estimates and its visits."""
    none = np.zeros(1, dtype=np.int64)
    return TracedMemory(
        q, visits, np.zeros(space.pairs), np.zeros(space.pairs, dtype=np.int64), none, nothing_chosen()
    )


@inlined
def cut_traces(memory: TracedMemory) -> None:
    """Let no pair have a trace any more."""
    for place in range(memory.active_count[0]):
        memory.eligibility[memory.active[place]] = 0.0
    memory.active_count[0] = 0


@inlined
def teach(
    memory: TracedMemory,
    params: KernelParameters,
    experience: Experience,
    bootstrap: float,
    decay: float,
) -> Update:
    """Give the pair just taken its trace, move all that have one, and let them fade by ``decay``.

    The trace of the pair grows by 1 where traces accumulate, else it becomes 1. With δ = reward + γ·bootstrap
    − Q(pair), every pair moves by α·e·δ, e being its trace (equation 12.7); where the step size is the sample
    average it is that of each pair. ``bootstrap`` is an estimate of the next state, 0 after the end.
    ``decay`` is γλ, or 0 to cut all traces. The update returned is that of the pair just taken.
    """
    q, visits, trace = memory.q, memory.visits, memory.eligibility
    active, count = memory.active, memory.active_count
    pair, reward = experience.pair, experience.reward
    # e(S,A) ← e(S,A) + 1, or where traces are replaced 1
    if trace[pair] == 0.0:
        active[count[0]] = pair
        count[0] += 1
    trace[pair] = trace[pair] + 1.0 if params.accumulating else 1.0
    before, own = q[pair], step_size(params, visits[pair]) * trace[pair]
    error = reward + params.gamma * bootstrap - before
    moved, kept, extreme = count[0], 0, 0.0
    for place in range(moved):
        each = active[place]
        # Q ← Q + α δ e
        estimate = q[each] + step_size(params, visits[each]) * trace[each] * error
        q[each] = estimate
        extreme = further(extreme, estimate)
        # e ← γλ e
        left = trace[each] * decay
        if left < FADED:
            trace[each] = 0.0
        else:
            trace[each] = left
            active[kept] = each
            kept += 1
    count[0] = kept
    bootstrap_state = NO_STATE if experience.terminated else experience.next_state
    return Update(
        pair, before, own, reward, params.gamma, bootstrap, bootstrap_state, q[pair], moved - 1, extreme, 0
    )
