"""SARSA(λ) (Sutton & Barto, 2nd ed., section 12.7: the box on page 305 with one feature per pair)."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience, Update, act, learn
from rl_tui.agents.algorithms.shared.next_action import choose_next, take_chosen
from rl_tui.agents.algorithms.shared.traces import TracedMemory, no_traces, teach
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(TracedMemory):
    """The memory of SARSA(λ)."""


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits, without traces."""
    return Memory(*no_traces(q, visits, space))


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
    memory.visits[experience.pair] += 1
    next_pair = choose_next(memory, rule, tables, experience, generator)
    bootstrap = memory.q[next_pair] if next_pair >= 0 else 0.0
    # δ ← R + γ Q(S′,A′) − Q(S,A);  Q ← Q + α δ e;  e ← γλ e, and no trace leads into another episode
    ended = experience.terminated or experience.truncated
    decay = 0.0 if ended else params.gamma * params.trace_decay
    return teach(memory, params, experience, bootstrap, decay)
