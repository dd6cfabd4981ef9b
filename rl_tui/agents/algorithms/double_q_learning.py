"""Double Q-learning (Sutton & Barto, 2nd ed., box on page 136, equation 6.10)."""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.random import Generator

from rl_tui.agents.algorithms.family import NO_STATE, Experience, Update, learn
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.kernels.parameters import KernelParameters, step_size
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import greedy
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(NamedTuple):
    """Two tables and their numbers of updates, [P]. Their mean `q` is shown and acted on."""

    q: FloatArray
    visits: IntArray
    q1: FloatArray
    q2: FloatArray
    updates1: IntArray
    updates2: IntArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits. Both tables start with the estimates."""
    return Memory(q, visits, q.copy(), q.copy(), visits.copy(), visits.copy())


@member_of(learn, Memory)
def _learn(
    memory: Memory,
    rule: Any,
    params: KernelParameters,
    tables: Tables,
    experience: Experience,
    generator: Generator,
) -> Update:
    # With 0.5 probability: Q₁(S,A) ← Q₁(S,A) + α [R + γ Q₂(S′, argmax_a Q₁(S′,a)) − Q₁(S,A)]
    # else:                 Q₂(S,A) ← Q₂(S,A) + α [R + γ Q₁(S′, argmax_a Q₂(S′,a)) − Q₂(S,A)]
    pair = experience.pair
    memory.visits[pair] += 1
    # One draw serves twice: its rest below or above 0.5, doubled, is uniform again
    draw = uniform(generator)
    first_table = draw < 0.5
    learning = memory.q1 if first_table else memory.q2
    judging = memory.q2 if first_table else memory.q1
    updates = memory.updates1 if first_table else memory.updates2
    rest = 2.0 * draw if first_table else 2.0 * draw - 1.0
    # The sample average is the mean of one table's targets
    updates[pair] += 1
    alpha = step_size(params, updates[pair])
    bootstrap, bootstrap_state = 0.0, NO_STATE
    if not experience.terminated:
        bootstrap_state = experience.next_state
        first, last = pairs_of(tables, bootstrap_state)
        bootstrap = judging[greedy(learning, first, last, params.random_ties, rest)]
    before = learning[pair]
    after = before + alpha * (experience.reward + params.gamma * bootstrap - before)
    learning[pair] = after
    memory.q[pair] = (memory.q1[pair] + memory.q2[pair]) / 2.0
    table = 1 if first_table else 2
    reward, gamma = experience.reward, params.gamma
    return Update(pair, before, alpha, reward, gamma, bootstrap, bootstrap_state, after, 0, after, table)
