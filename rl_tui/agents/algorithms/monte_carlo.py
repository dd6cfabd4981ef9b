"""Every-visit Monte Carlo control (Sutton & Barto, 2nd ed., section 5.4, after the box on page 101).

The box learns only from first visits, and by the average. It has no time limit: a truncated episode
bootstraps here.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, further, has_room, learn, no_update
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import expectation
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

MOST_REMEMBERED: Final = 1_000_000


class Memory(NamedTuple):
    """Estimates, visits and updates, [P], and `pairs` and `rewards` of the current episode.

    There is room for the time limit, at most a million steps, of which ``length[0]`` are used.
    """

    q: FloatArray
    visits: IntArray
    updates: IntArray
    pairs: IntArray
    rewards: FloatArray
    length: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits. Earlier visits count as updates."""
    room = min(space.time_limit or MOST_REMEMBERED, MOST_REMEMBERED)
    return Memory(
        q,
        visits,
        visits.copy(),
        np.zeros(room, dtype=np.int64),
        np.zeros(room),
        np.zeros(1, dtype=np.int64),
    )


def checkpoint_arrays(memory: Memory) -> Memory:
    """Return the memory without the unused part of the episode."""
    length = int(memory.length[0])
    return memory._replace(pairs=memory.pairs[:length], rewards=memory.rewards[:length])


@member_of(has_room, Memory)
def _has_room(memory: Memory) -> bool:
    return int(memory.length[0]) < len(memory.pairs)


@member_of(learn, Memory)
def _learn(
    memory: Memory,
    rule: Any,
    params: KernelParameters,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> Update:
    """Store the step. At the end of the episode, update all its pairs, the last one first.

    After truncation, the expected value of the policy replaces the rest of the return: 0 would make the time
    limit a terminal state. The returned update belongs to the first step of the episode.
    """
    memory.visits[experience.pair] += 1
    memory.pairs[memory.length[0]] = experience.pair
    memory.rewards[memory.length[0]] = experience.reward
    memory.length[0] += 1
    if not (experience.terminated or experience.truncated):
        return no_update()
    bootstrap, bootstrap_state = 0.0, NO_STATE
    if experience.truncated:
        bootstrap_state = experience.next_state
        first, last = pairs_of(tables, bootstrap_state)
        bootstrap = expectation(rule, memory.q, memory.visits, first, last)
    gathered, discount, extreme = 0.0, 1.0, 0.0
    pair, before, alpha, after = experience.pair, 0.0, 0.0, 0.0
    # Loop for each step of episode, t = T−1, T−2, …, 0
    length = memory.length[0]
    for back in range(length):
        # G ← γG + R_{t+1}
        step = length - 1 - back
        gathered = params.gamma * gathered + memory.rewards[step]
        discount *= params.gamma
        # N(S_t,A_t) ← N(S_t,A_t) + 1;  Q(S_t,A_t) ← Q(S_t,A_t) + α [G − Q(S_t,A_t)], α = 1/N for the average
        pair = memory.pairs[step]
        memory.updates[pair] += 1
        alpha = step_size(params, memory.updates[pair])
        before = memory.q[pair]
        after = before + alpha * (gathered + discount * bootstrap - before)
        memory.q[pair] = after
        extreme = further(extreme, after)
    memory.length[0] = 0
    others = length - 1
    return Update(
        pair, before, alpha, gathered, discount, bootstrap, bootstrap_state, after, others, extreme, 0
    )
