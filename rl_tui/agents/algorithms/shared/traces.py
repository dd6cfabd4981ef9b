"""Eligibility traces (Sutton & Barto, 2nd ed., chapter 12). Only pairs with a trace are visited."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, further
from rl_tui.agents.algorithms.shared.next_action import nothing_chosen
from rl_tui.agents.kernels.compiled import inlined
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

# Smaller traces are dropped. Otherwise every step would update all pairs of a long episode by invisible
# amounts
FADED: Final = 1e-12


class TracedMemory(NamedTuple):
    """The memory of an algorithm with traces.

    `q`, `visits` and the traces `eligibility` are [P]. The first ``active_count[0]`` entries of `active`,
    [P], are the pairs with a trace. `chosen`, [2], is A′; see
    :mod:`rl_tui.agents.algorithms.shared.next_action`.
    """

    q: FloatArray
    visits: IntArray
    eligibility: FloatArray
    active: IntArray
    active_count: IntArray
    chosen: IntArray


def no_traces(q: FloatArray, visits: IntArray, space: FiniteSpace) -> TracedMemory:
    """Wrap existing estimates and visits, without traces."""
    none = np.zeros(1, dtype=np.int64)
    return TracedMemory(
        q, visits, np.zeros(space.pairs), np.zeros(space.pairs, dtype=np.int64), none, nothing_chosen()
    )


@inlined
def cut_traces(memory: TracedMemory) -> None:
    """Remove all traces."""
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
    """Set the trace of the taken pair, update all pairs with a trace, and let the traces decay.

    An accumulating trace grows by 1, a replacing one becomes 1. With δ = reward + γ · bootstrap − Q(pair),
    each pair moves by α · e · δ (equation 12.7). A sample average uses the count of each pair. `decay` is γλ,
    or 0 to cut all traces.
    """
    q, visits, trace = memory.q, memory.visits, memory.eligibility
    active, count = memory.active, memory.active_count
    pair, reward = experience.pair, experience.reward
    # e(S,A) ← e(S,A) + 1, or 1 for replacing traces
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
