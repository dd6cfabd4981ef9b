"""Sums of a learning curve: those of each bin, over the episodes that fall into it."""

from __future__ import annotations

from typing import NamedTuple

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


class CurveSums(NamedTuple):
    """Sums over the episodes of each bin, [B] each: returns, lengths, and optimal actions."""

    returns: FloatArray
    lengths: IntArray
    optimal: IntArray


@compiled
def collect(
    sums: CurveSums,
    width: int,
    done: int,
    returns: FloatArray,
    lengths: IntArray,
    optimal: BoolArray,
) -> None:
    """Add episodes to their bins; the first of them comes after ``done`` others."""
    for index in range(len(returns)):
        here = (done + index) // width
        sums.returns[here] += returns[index]
        sums.lengths[here] += lengths[index]
        sums.optimal[here] += optimal[index]
