"""Policy iteration, its evaluations in place (Sutton & Barto, 2nd ed., section 4.3, box on page 80).

The first policy takes all actions equally (Figure 4.1). It ends with probability 1 wherever all states can
reach an end, so that it has a value at γ = 1 too; where they cannot, values at γ = 1 may grow from sweep to
sweep without end. The policy of a state changes only where that gains something: else it could go to and fro
between equally good ones for ever (exercise 4.4), or at γ = 1 come to one that never ends.

Which sweep is next can be ordered, whatever is due by itself: then evaluations need not come to rest before
the policy is improved (generalized policy iteration, section 4.6).
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

# Of the best value, or of 1 where that is less: nearer ones are equally good
TIE: Final = 1e-9

EVALUATION: Final = 0
IMPROVEMENT: Final = 1
NO_ORDER: Final = -1


class Memory(NamedTuple):
    """All that policy iteration remembers.

    The estimates ``q`` are [P], and so are ``visits``, which count how often each was backed up, and the
    probabilities ``policy``. ``v``, [S], is the value of each state under the policy, 0 where it owns no
    pair. ``phase`` is 0 in an evaluation and 1 in an improvement; ``policies`` counts them from 1 and
    ``improved`` the states whose policy changed in the improvement; ``ordered`` is the phase of the next
    sweep where a person has ordered one, else −1; [1] each. The rest is the
    :class:`rl_tui.agents.algorithms.shared.backups.Sweep`, which counts the sweeps of an evaluation. Its
    change and its discount are those of the last evaluation, in an improvement too, and the change is
    infinite where that was of another policy than the one in force.
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
    """Return the memory around an existing table of estimates and its visits."""
    each = np.diff(space.first_pair)
    v = np.zeros(space.states)
    v[each > 0] = np.add.reduceat(q, space.first_pair[:-1][each > 0]) / each[each > 0]
    phase, policies, improved, no_order = (
        np.full(1, number, dtype=np.int64) for number in (EVALUATION, 1, 0, NO_ORDER)
    )
    equal = 1.0 / np.repeat(each, each)
    return Memory(q, visits, v, equal, phase, policies, improved, no_order, *no_sweep())


def phase_of(memory: Memory) -> SweepPhase | None:
    """Return what the sweep under way, or the last one, does to the policy; None before the first."""
    return None if memory.number[0] < 0 else SWEEP_PHASES[int(memory.phase[0])]


def order(memory: Memory, phase: SweepPhase) -> None:
    """Let the next sweep be one of ``phase``, whatever is due; the last order counts."""
    memory.ordered[0] = SWEEP_PHASES.index(phase)


def ordered(memory: Memory) -> SweepPhase | None:
    """Return what is ordered for the next sweep, None where nothing is."""
    return None if memory.ordered[0] == NO_ORDER else SWEEP_PHASES[int(memory.ordered[0])]


def describe(memory: Memory) -> str:
    """Say how the sweep under way is getting on; empty before the first."""
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
    # If policy-stable, then stop: where its values are those of an evaluation that came to rest
    progress = Sweep(memory.number, memory.sweeps, memory.change, memory.gamma)
    is_stable = memory.phase[0] == IMPROVEMENT and memory.improved[0] == 0 and at_rest(progress, params)
    return is_stable and memory.ordered[0] == NO_ORDER


@compiled
def take_turns(memory: Memory, progress: Sweep, params: KernelParameters) -> None:
    """Go to the sweep ordered; else to improvement when the values are at rest, and after one sweep back."""
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
    """Give ``state`` its value under the policy; the update returned is that of the pair it takes."""
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
    """Make the policy of ``state`` greedy if that gains anything; values stay as they are."""
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
