"""Watkins's Q(λ) (Sutton & Barto, 2nd ed., section 12.10): Q-learning with traces.

Traces are cut before a non-greedy action. One with the best estimate is greedy, even if drawn to explore.
"""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from rl_tui.agents.algorithms.family import Experience, Update, act, learn, on_override
from rl_tui.agents.algorithms.shared.next_action import choose_next, take_chosen
from rl_tui.agents.algorithms.shared.traces import TracedMemory, cut_traces, no_traces, teach
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import best_value
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(TracedMemory):
    """The memory of Q(λ)."""


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits, without traces."""
    return Memory(*no_traces(q, visits, space))


# A ← A′; at the start of an episode choose A from S using the policy derived from Q
member_of(act, Memory)(take_chosen)


@member_of(on_override, Memory)
def _on_override(memory: Memory, tables: Tables, state: int, pair: int) -> None:
    # Traces up to A′ were cut or kept when A′ was chosen. Any other action is checked now
    first, last = pairs_of(tables, state)
    if pair != memory.chosen[0] and memory.q[pair] != best_value(memory.q, first, last):
        cut_traces(memory)


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
    bootstrap, decay = 0.0, 0.0
    if not experience.terminated:
        first, last = pairs_of(tables, experience.next_state)
        bootstrap = best_value(memory.q, first, last)
        # Cut traces at a non-greedy action and at the end of an episode
        if memory.q[next_pair] == bootstrap and not experience.truncated:
            decay = params.gamma * params.trace_decay
    # δ ← R + γ max_a Q(S′,a) − Q(S,A);  Q ← Q + α δ e;  e ← γλ e, or 0
    return teach(memory, params, experience, bootstrap, decay)
