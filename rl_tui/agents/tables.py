"""The arrays of a finite MDP as the kernels take them."""

from __future__ import annotations

from typing import NamedTuple

from rl_tui.worlds.mdp import BoolArray, FloatArray, IntArray, TabularMDP


class Tables(NamedTuple):
    """What a kernel needs of a :class:`TabularMDP`; the same names, the same shapes."""

    first_pair: IntArray
    first_outcome: IntArray
    next_state: IntArray
    reward: FloatArray
    reward_std: FloatArray
    terminated: BoolArray
    cumulative: FloatArray
    start_state: IntArray
    start_cumulative: FloatArray
    time_limit: int


def tables_of(mdp: TabularMDP) -> Tables:
    """Return the kernel's view of ``mdp``; nothing is copied."""
    return Tables(*(getattr(mdp, name) for name in Tables._fields))
