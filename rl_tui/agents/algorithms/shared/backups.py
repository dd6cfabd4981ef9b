"""The expected update of a state (Sutton & Barto, 2nd ed., section 4.1)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rl_tui.agents.algorithms.family import NO_STATE, Update, further
from rl_tui.agents.kernels.compiled import compiled, inlined
from rl_tui.agents.kernels.parameters import KernelParameters
from rl_tui.agents.kernels.tables import Tables, landing, outcomes_of, pairs_of
from rl_tui.worlds.mdp.space import FloatArray, IntArray

ANY = -1


class Sweep(NamedTuple):
    """Progress of the current sweep, in arrays of one number.

    Sweeps are counted as the loop does in `number`, −1 before the first, and as the planner does in `sweeps`.
    The largest change so far, `change`, is infinite before the first sweep and after a change of the
    discount, because it then proves nothing. The discount at the start is `gamma`.
    """

    number: IntArray
    sweeps: IntArray
    change: FloatArray
    gamma: FloatArray


def no_sweep() -> Sweep:
    """Return the progress before the first sweep."""
    return Sweep(np.full(1, -1, dtype=np.int64), np.zeros(1, dtype=np.int64), np.full(1, np.inf), np.zeros(1))


@inlined
def begin_sweep(progress: Sweep, params: KernelParameters, number: int) -> None:
    """Start another sweep."""
    progress.number[0] = number
    progress.sweeps[0] += 1
    progress.change[0] = 0.0
    progress.gamma[0] = params.gamma


@inlined
def note_change(progress: Sweep, params: KernelParameters, change: float) -> None:
    """Record the change of a state's value."""
    if params.gamma != progress.gamma[0]:
        progress.change[0] = np.inf
    progress.change[0] = max(progress.change[0], change)


@inlined
def at_rest(progress: Sweep, params: KernelParameters) -> bool:
    """Return True if the last sweep changed no value by more than the accuracy."""
    still: bool = progress.change[0] <= params.accuracy
    return still and bool(progress.gamma[0] == params.gamma)


def change_in_words(change: FloatArray) -> str:
    """Return a largest change, [1], as text."""
    if np.isinf(change[0]):
        return "γ changed on the way"
    return f"largest change {change[0]:.2g}"


@compiled
def back_up_pairs(
    q: FloatArray,
    visits: IntArray,
    v: FloatArray,
    params: KernelParameters,
    tables: Tables,
    state: int,
    reported: int,
) -> Update:
    """Set all estimates of `state` to their expected update from `v`, [S], and count the visits.

    Returns the update of `reported` (−1: the best pair), with expected reward and next value.
    """
    first, last = pairs_of(tables, state)
    pair, before, gathered, bootstrap, after = first, 0.0, 0.0, 0.0, -np.inf
    moved, extreme = 0, 0.0
    for each in range(first, last):
        # Q(s,a) ← Σ p(s′,r|s,a) [r + γ V(s′)]
        reward, value = 0.0, 0.0
        first_outcome, last_outcome = outcomes_of(tables, each)
        for outcome in range(first_outcome, last_outcome):
            reward += tables.probability[outcome] * tables.reward[outcome]
            if not tables.terminated[outcome]:
                value += tables.probability[outcome] * v[landing(tables, outcome)]
        estimate = reward + params.gamma * value
        former = q[each]
        q[each] = estimate
        visits[each] += 1
        extreme = further(extreme, estimate)
        if estimate != former:
            moved += 1
        if each == reported or (reported == ANY and estimate > after):
            pair, before, gathered, bootstrap, after = each, former, reward, value, estimate
    others = moved - 1 if after != before else moved
    return Update(pair, before, 1.0, gathered, params.gamma, bootstrap, NO_STATE, after, others, extreme, 0)
