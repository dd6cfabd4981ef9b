"""What survives a change of the world."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from rl_tui.agents.kernels.drift import Drift
from rl_tui.agents.kernels.watch import Watching
from rl_tui.worlds.editing.carried import NEW, Carried
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def carry_over(now: npt.NDArray[Any], before: npt.NDArray[Any], pairs: IntArray) -> None:
    """Copy values of common pairs from `before`, [P before], to `now`, [P].

    `pairs`, [P], holds former numbers, or NEW.
    """
    known = pairs != NEW
    now[known] = before[pairs[known]]


def carry_drift(now: Drift, before: Drift, pairs: IntArray) -> None:
    """Keep the drift of common arms. Sums over pulls restart."""
    if not len(now.offset) or not len(before.offset):
        return
    carry_over(now.offset, before.offset, pairs)
    now.mean[:] += now.offset
    now.optimal[:] = now.mean == now.mean.max()


def carried_state(carried: Carried, state: int) -> int:
    """Return the new number of the former `state`, or NEW if gone."""
    there = np.flatnonzero(carried.states == state)
    return int(there[0]) if len(there) else NEW


def carried_watching(carried: Carried, watching: Watching | None) -> Watching | None:
    """Renumber the watched states and pairs, without removed ones."""
    if watching is None:
        return None
    cell = carried.pairs_now(() if watching.cell is None else (watching.cell,))
    return replace(
        watching,
        states=carried.states_now(watching.states),
        pairs=carried.pairs_now(watching.pairs),
        cell=next(iter(cell), None),
    )


def goes_on(space: FiniteSpace, state: int, episode_step: int) -> bool:
    """Return True if an episode can continue in `state` (NEW: a removed state)."""
    is_over = bool(space.time_limit) and episode_step >= space.time_limit
    return state != NEW and len(space.pairs_of(state)) > 0 and not is_over


def starts_in(space: FiniteSpace, state: int) -> bool:
    """Return True if an episode may start in `state`."""
    return isinstance(space, TabularMDP) and bool(np.isin(state, space.start_state))


def is_same_table(one: FiniteSpace, other: FiniteSpace) -> bool:
    """Return True for equal transition tables, bit for bit, or the same other space."""
    if one is other or not (isinstance(one, TabularMDP) and isinstance(other, TabularMDP)):
        return one is other
    return one.pairs == other.pairs and table_digest(one) == table_digest(other)
