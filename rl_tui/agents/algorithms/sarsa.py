"""SARSA: on-policy TD control (Sutton & Barto, 2nd ed., box on page 130, equation 6.7)."""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.random import Generator

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, act, learn, one_update
from rl_tui.agents.algorithms.shared.next_action import choose_next, nothing_chosen, take_chosen
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(NamedTuple):
    """An estimate and a count for each pair, [P], and A′, [2]; see
    :mod:`rl_tui.agents.algorithms.shared.next_action`.
    """

    q: FloatArray
    visits: IntArray
    chosen: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits."""
    return Memory(q, visits, nothing_chosen())


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
    # Choose A′ from S′ using the policy derived from Q
    pair = experience.pair
    memory.visits[pair] += 1
    alpha = step_size(params, memory.visits[pair])
    next_pair = choose_next(memory, rule, tables, experience, generator)
    bootstrap, bootstrap_state = 0.0, NO_STATE
    if not experience.terminated:
        bootstrap, bootstrap_state = memory.q[next_pair], experience.next_state
    # Q(S,A) ← Q(S,A) + α [R + γ Q(S′,A′) − Q(S,A)]
    before = memory.q[pair]
    after = before + alpha * (experience.reward + params.gamma * bootstrap - before)
    memory.q[pair] = after
    return one_update(pair, before, alpha, experience.reward, params.gamma, bootstrap, bootstrap_state, after)
