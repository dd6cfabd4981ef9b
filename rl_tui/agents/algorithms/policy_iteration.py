"""Policy iteration with evaluation in place (Sutton & Barto, 2nd ed., section 4.3, box on page 80).

The first policy takes all actions equally (Figure 4.1). If all states can reach an end, it has values at γ =
1, otherwise they may grow without bound. A policy changes only if that gains something. It could alternate
between equally good policies forever (exercise 4.4), or reach one that never ends at γ = 1.

After a user's order, it may improve before the evaluation has converged (generalized policy iteration,
section 4.6).
"""

from __future__ import annotations

from typing import Final, NamedTuple

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
from rl_tui.agents.catalogue import SWEEP_PHASES, SweepPhase
from rl_tui.agents.kernels.compiled import compiled, member_of
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.common.words import counted
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

# Relative to the best value, or to 1 if that is larger. Closer values count as equal
TIE: Final = 1e-9

EVALUATION: Final = 0
IMPROVEMENT: Final = 1
NO_ORDER: Final = -1


class Memory(NamedTuple):
    """Estimates, the policy, and progress in arrays of one number.

    Args:
        q: [P].
        visits: Number of backups, [P].
        v: [S]; 0 for states without pairs.
        policy: Probability of each pair, [P].
        phase: 0 in an evaluation, 1 in an improvement.
        policies: Number of the policy, from 1.
        improved: States whose policy changed in the improvement.
        ordered: Phase ordered for the next sweep, or −1.
        number: See :class:`rl_tui.agents.algorithms.shared.backups.Sweep`.
        sweeps: Sweeps of the current evaluation.
        change: Largest change in the last evaluation; infinite if the policy has changed since.
        gamma: Discount of the last evaluation.
    """

    q: FloatArray
    visits: IntArray
    v: FloatArray
    policy: FloatArray
    phase: IntArray
    policies: IntArray
    improved: IntArray
    ordered: IntArray
    number: IntArray
    sweeps: IntArray
    change: FloatArray
    gamma: FloatArray


def new_memory(q: FloatArray, visits: IntArray, space: FiniteSpace) -> Memory:
    """Wrap existing estimates and visits."""
    each = np.diff(space.first_pair)
    v = np.zeros(space.states)
    v[each > 0] = np.add.reduceat(q, space.first_pair[:-1][each > 0]) / each[each > 0]
    phase, policies, improved, no_order = (
        np.full(1, number, dtype=np.int64) for number in (EVALUATION, 1, 0, NO_ORDER)
    )
    equal = 1.0 / np.repeat(each, each)
    return Memory(q, visits, v, equal, phase, policies, improved, no_order, *no_sweep())


def phase_of(memory: Memory) -> SweepPhase | None:
    """Return the phase of the last sweep; None before the first."""
    return None if memory.number[0] < 0 else SWEEP_PHASES[int(memory.phase[0])]


def order(memory: Memory, phase: SweepPhase) -> None:
    """Make the next sweep one of `phase`. The latest order counts."""
    memory.ordered[0] = SWEEP_PHASES.index(phase)


def ordered(memory: Memory) -> SweepPhase | None:
    """Return the phase ordered for the next sweep, or None."""
    return None if memory.ordered[0] == NO_ORDER else SWEEP_PHASES[int(memory.ordered[0])]


def describe(memory: Memory) -> str:
    """Return the progress as text. Empty before the first sweep."""
    if memory.number[0] < 0:
        return ""
    policy, is_next = f"policy {memory.policies[0]:,}", ordered(memory)
    after = "" if is_next is None else f"; then {is_next}"
    if phase_of(memory) == "evaluation":
        return f"{policy}, evaluation sweep {memory.sweeps[0]:,}: {change_in_words(memory.change)}{after}"
    improved = counted(int(memory.improved[0]), "state")
    return f"{policy}, improvement: {improved} changed{after}"


@member_of(back_up, Memory)
def _back_up(memory: Memory, params: KernelParameters, tables: Tables, state: int, sweep: int) -> Update:
    progress = Sweep(memory.number, memory.sweeps, memory.change, memory.gamma)
    if sweep != memory.number[0]:
        take_turns(memory, progress, params)
        if memory.phase[0] == EVALUATION:
            begin_sweep(progress, params, sweep)
        progress.number[0] = sweep
    if memory.phase[0] == EVALUATION:
        return evaluate(memory, progress, params, tables, state)
    return improve(memory, progress, params, tables, state)


@member_of(has_converged, Memory)
def _has_converged(memory: Memory, params: KernelParameters) -> bool:
    # If policy-stable, then stop, provided that its values come from a converged evaluation
    progress = Sweep(memory.number, memory.sweeps, memory.change, memory.gamma)
    is_stable = memory.phase[0] == IMPROVEMENT and memory.improved[0] == 0 and at_rest(progress, params)
    return is_stable and memory.ordered[0] == NO_ORDER


@compiled
def take_turns(memory: Memory, progress: Sweep, params: KernelParameters) -> None:
    """Go to the ordered phase, else from a converged evaluation to improvement and back."""
    phase = EVALUATION
    if memory.ordered[0] != NO_ORDER:
        phase = memory.ordered[0]
        memory.ordered[0] = NO_ORDER
    elif memory.phase[0] == EVALUATION and memory.sweeps[0] > 0 and at_rest(progress, params):
        phase = IMPROVEMENT
    if memory.phase[0] == IMPROVEMENT:
        memory.policies[0] += memory.improved[0] > 0
        memory.sweeps[0] = 0
    memory.phase[0] = phase
    memory.improved[0] = 0


@compiled
def evaluate(memory: Memory, progress: Sweep, params: KernelParameters, tables: Tables, state: int) -> Update:
    """Update the value of `state`, and return the update of its policy's pair."""
    first, last = pairs_of(tables, state)
    taken = ANY
    for pair in range(first, last):
        if memory.policy[pair] == 1.0:
            taken = pair
    # v ← V(s);  V(s) ← Σ π(a|s) Σ p(s′,r|s,a) [r + γ V(s′)];  Δ ← max(Δ, |v − V(s)|)
    update = back_up_pairs(memory.q, memory.visits, memory.v, params, tables, state, taken)
    value = 0.0
    for pair in range(first, last):
        value += memory.policy[pair] * memory.q[pair]
    note_change(progress, params, abs(value - memory.v[state]))
    memory.v[state] = value
    return update


@compiled
def improve(memory: Memory, progress: Sweep, params: KernelParameters, tables: Tables, state: int) -> Update:
    """Make the policy of `state` greedy if that gains something."""
    update = back_up_pairs(memory.q, memory.visits, memory.v, params, tables, state, ANY)
    note_change(progress, params, 0.0)
    first, last = pairs_of(tables, state)
    best = memory.q[update.pair]
    slack = TIE * max(1.0, abs(best))
    value, ties, first_best = 0.0, 0, -1
    for pair in range(first, last):
        value += memory.policy[pair] * memory.q[pair]
        if memory.q[pair] >= best - slack:
            ties += 1
            if first_best < 0:
                first_best = pair
    # old-action ← π(s);  π(s) ← argmax_a Q(s,a);  if old-action ≠ π(s), then policy-stable ← false
    if value < best - slack:
        memory.improved[0] += 1
        progress.change[0] = np.inf
        for pair in range(first, last):
            memory.policy[pair] = 0.0
            if params.random_ties and memory.q[pair] >= best - slack:
                memory.policy[pair] = 1.0 / ties
        if not params.random_ties:
            memory.policy[first_best] = 1.0
    return update
