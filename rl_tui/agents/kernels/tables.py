"""The arrays of a finite MDP for kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.agents.kernels.compiled import compiled, inlined, inlined_by_type
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

IndexArray = npt.NDArray[np.uint32]


class Tables(NamedTuple):
    """The part of a :class:`TabularMDP` that kernels need, with the same names and shapes.

    Unsigned indices need no checks for negative ones, so the loop is a third faster. Read them through
    :func:`pairs_of`, :func:`outcomes_of` or ``np.int64``, because unsigned plus signed gives a float.
    """

    first_pair: IndexArray
    first_outcome: IndexArray
    next_state: IndexArray
    reward: FloatArray
    reward_std: FloatArray
    terminated: BoolArray
    cumulative: FloatArray
    probability: FloatArray
    start_state: IndexArray
    start_cumulative: FloatArray
    time_limit: int
    drift_std: float


def tables_of(space: FiniteSpace) -> Tables:
    """Return the tables of `space`, perhaps without outcomes."""
    if isinstance(space, TabularMDP):
        return Tables(
            first_pair=_indices(space.first_pair),
            first_outcome=_indices(space.first_outcome),
            next_state=_indices(space.next_state),
            reward=space.reward,
            reward_std=space.reward_std,
            terminated=space.terminated,
            cumulative=space.cumulative,
            probability=space.probability,
            start_state=_indices(space.start_state),
            start_cumulative=space.start_cumulative,
            time_limit=int(space.time_limit),
            drift_std=float(space.drift_std),
        )
    none, nothing, never = np.empty(0, np.int64), np.empty(0), np.empty(0, np.bool_)
    for array in (nothing, never):
        array.flags.writeable = False
    return Tables(
        first_pair=_indices(space.first_pair),
        first_outcome=_indices(none),
        next_state=_indices(none),
        reward=nothing,
        reward_std=nothing,
        terminated=never,
        cumulative=nothing,
        probability=nothing,
        start_state=_indices(none),
        start_cumulative=nothing,
        time_limit=int(space.time_limit),
        drift_std=0.0,
    )


def _indices(array: npt.NDArray[np.int64]) -> IndexArray:
    indices = array.astype(np.uint32)
    indices.flags.writeable = False
    return indices


@inlined_by_type
def pairs_of(tables: Tables, state: int) -> tuple[int, int]:
    """Return the first pair of `state` and the one after its last."""
    return np.int64(tables.first_pair[state]), np.int64(tables.first_pair[state + 1])  # type: ignore[return-value]


@compiled
def state_of(tables: Tables, pair: int) -> int:
    """Return the state that owns `pair`."""
    low, high = 0, len(tables.first_pair) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if tables.first_pair[middle] <= pair:
            low = middle
        else:
            high = middle
    return low


@inlined
def landing(tables: Tables, outcome: int) -> int:
    """Return the next state of `outcome`."""
    return np.int64(tables.next_state[outcome])  # type: ignore[return-value]


@inlined
def outcomes_of(tables: Tables, pair: int) -> tuple[int, int]:
    """Return the first outcome of `pair` and the one after its last."""
    return np.int64(tables.first_outcome[pair]), np.int64(tables.first_outcome[pair + 1])  # type: ignore[return-value]
