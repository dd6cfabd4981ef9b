"""Value iteration in place (Sutton & Barto, 2nd ed., box on page 83, equation 4.10).

At γ = 1 a loop without rewards keeps its initial value, so start with estimates of 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import Update, back_up, has_converged
from rl_tui.agents.algorithms.shared.backups import (
    ANY,
    Sweep,
    at_rest,
    back_up_pairs,
    begin_sweep,
    change_in_words,
    no_sweep,
    note_change,
)
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Memory(NamedTuple):
    """Estimates, and the :class:`rl_tui.agents.algorithms.shared.backups.Sweep`.

    Backups of `q`, [P], are counted in `visits`, [P]. The greatest estimate is `v`, [S], or 0.
    """

    q: FloatArray
    visits: IntArray
    v: FloatArray
    number: IntArray
    sweeps: IntArray
    change: FloatArray
    gamma: FloatArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits."""
    v = np.zeros(space.states)
    own = np.diff(space.first_pair) > 0
    v[own] = np.maximum.reduceat(q, space.first_pair[:-1][own])
    return Memory(q, visits, v, *no_sweep())


def describe(memory: Memory) -> str:
    """Return the progress as text. Empty before the first sweep."""
    if not memory.sweeps[0]:
        return ""
    return f"sweep {memory.sweeps[0]:,}: {change_in_words(memory.change)}"


@member_of(back_up, Memory)
def _back_up(memory: Memory, params: KernelParameters, tables: Tables, state: int, sweep: int) -> Update:
    progress = Sweep(memory.number, memory.sweeps, memory.change, memory.gamma)
    if sweep != memory.number[0]:
        begin_sweep(progress, params, sweep)
    # v ← V(s);  V(s) ← max_a Σ p(s′,r|s,a) [r + γ V(s′)];  Δ ← max(Δ, |v − V(s)|)
    update = back_up_pairs(memory.q, memory.visits, memory.v, params, tables, state, ANY)
    note_change(progress, params, abs(update.after - memory.v[state]))
    memory.v[state] = update.after
    return update


@member_of(has_converged, Memory)
def _has_converged(memory: Memory, params: KernelParameters) -> bool:
    # until Δ < θ
    return at_rest(Sweep(memory.number, memory.sweeps, memory.change, memory.gamma), params)
