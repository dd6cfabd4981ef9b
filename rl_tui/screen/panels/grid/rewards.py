"""Which cells of a map pay something, so that they stand out from the floor around them."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_CELLS: Final = 10_000


class CellReward(NamedTuple):
    """The ``reward`` of a cell; ``good`` says that it is more than the usual step's."""

    reward: float
    good: bool


def cell_rewards(space: FiniteSpace, grid: Grid) -> dict[int, CellReward]:
    """Return the cells in which every way to leave them, or else to enter them, pays the same unusual reward.

    Usual is the commonest reward of the world. Cells where an episode has ended are left out: they have signs
    of their own. Empty where it is not known what the actions lead to, where no action is a direction and for
    maps of more than 10,000 cells.
    """
    if not isinstance(space, TabularMDP) or not any(grid.directions) or len(grid.kinds) > MOST_CELLS:
        return {}
    rewards, counts = np.unique(space.reward, return_counts=True)
    usual = float(rewards[counts.argmax()])
    source = space.pair_state[space.outcome_pair]
    moved = source != space.next_state
    leaving = _only_reward(space.states, source, space.reward)
    entering = _only_reward(space.states, space.next_state[moved], space.reward[moved])
    pays = np.full(space.states, np.nan)
    for each in (entering, leaving):
        np.copyto(pays, each, where=np.isfinite(each) & (each != usual))
    pays[np.diff(space.first_pair) == 0] = np.nan
    unusual = np.flatnonzero(np.isfinite(pays))
    return {
        grid.cell_of_state[state]: CellReward(reward, reward > usual)
        for state, reward in zip(unusual.tolist(), pays[unusual].tolist(), strict=True)
    }


def _only_reward(states: int, state: IntArray, reward: FloatArray) -> FloatArray:
    """Return the reward of all outcomes at each state, [S]; NaN where they differ or there is none."""
    low, high = np.full(states, np.inf), np.full(states, -np.inf)
    np.minimum.at(low, state, reward)
    np.maximum.at(high, state, reward)
    return np.where(low == high, low, np.nan)
