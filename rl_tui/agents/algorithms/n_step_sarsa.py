"""n-step SARSA: on-policy control with n rewards (Sutton & Barto, 2nd ed., box on page 147, equation 7.5)."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.algorithms.family import (
    NO_STATE,
    Experience,
    Update,
    act,
    further,
    learn,
    no_update,
    one_update,
    with_others,
)
from rl_tui.agents.algorithms.shared.next_action import choose_next, nothing_chosen, take_chosen
from rl_tui.agents.hyperparameters import MOST_STEPS
from rl_tui.agents.kernels.compiled import inlined, member_of
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

_ROOM: Final = MOST_STEPS + 1


class Memory(NamedTuple):
    """Estimates, visits and updates, [P], and recent steps.

    Ring buffers are `pairs` A_t and `rewards` R_{t+1}: step t is at t modulo their size. In `time`, [2], are
    t, the steps taken, and τ, the next step to update. A′ is `chosen`; see
    :mod:`rl_tui.agents.algorithms.shared.next_action`.
    """

    q: FloatArray
    visits: IntArray
    updates: IntArray
    pairs: IntArray
    rewards: FloatArray
    time: IntArray
    chosen: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits. Earlier visits count as updates."""
    return Memory(
        q,
        visits,
        visits.copy(),
        np.zeros(_ROOM, dtype=np.int64),
        np.zeros(_ROOM),
        np.zeros(2, dtype=np.int64),
        nothing_chosen(),
    )


# A ← A′; at the start of an episode choose A from S using the policy derived from Q
member_of(act, Memory)(take_chosen)


@member_of(learn, Memory)
def _learn(
    memory: Memory,
    rule: Any,
    params: KernelParameters,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> Update:
    # Store R_{t+1}; if S_{t+1} is not terminal, select and store A_{t+1} ~ π(·|S_{t+1})
    time, pair = memory.time[0], experience.pair
    memory.visits[pair] += 1
    memory.pairs[time % _ROOM] = pair
    memory.rewards[time % _ROOM] = experience.reward
    time += 1
    memory.pairs[time % _ROOM] = choose_next(memory, rule, tables, experience, generator)
    # τ ← t − n + 1: the step to update. After n was reduced, several are due; after it was increased, none
    # for a while. At the end of an episode all remaining ones are due, until τ = T − 1
    ended = experience.terminated or experience.truncated
    update = no_update()
    extreme, made = 0.0, 0
    for due in range(memory.time[1], time if ended else time - params.steps + 1):
        update = _update(memory, params, due, min(due + params.steps, time), time, experience)
        extreme = further(extreme, update.after)
        made += 1
    memory.time[0] = 0 if ended else time
    memory.time[1] = 0 if ended else memory.time[1] + made
    return with_others(update, max(made - 1, 0), extreme)


@inlined
def _update(
    memory: Memory, params: KernelParameters, due: int, last: int, time: int, experience: Experience
) -> Update:
    """Update the pair of step `due` with the rewards up to step `last`. The bootstrap state is right only for
    the last update of a step.
    """
    # G ← Σ γ^(i−τ−1) R_i for i from τ+1 to min(τ+n, T)
    gathered, discount = 0.0, 1.0
    for step in range(due, last):
        gathered += discount * memory.rewards[step % _ROOM]
        discount *= params.gamma
    # If τ + n < T: G ← G + γⁿ Q(S_{τ+n}, A_{τ+n}); a truncated episode would have gone on
    bootstrap, bootstrap_state = 0.0, NO_STATE
    if last < time or not experience.terminated:
        bootstrap = memory.q[memory.pairs[last % _ROOM]]
        bootstrap_state = experience.next_state
    # Q(S_τ,A_τ) ← Q(S_τ,A_τ) + α [G − Q(S_τ,A_τ)]
    pair = memory.pairs[due % _ROOM]
    memory.updates[pair] += 1
    alpha = step_size(params, memory.updates[pair])
    before = memory.q[pair]
    after = before + alpha * (gathered + discount * bootstrap - before)
    memory.q[pair] = after
    return one_update(pair, before, alpha, gathered, discount, bootstrap, bootstrap_state, after)
