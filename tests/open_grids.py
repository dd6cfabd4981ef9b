"""Open square maps of any size, made from arrays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.random import Generator

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.runs.recipe import Recipe
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

MOVES = ((0, -1), (1, 0), (0, 1), (-1, 0))


def open_grid(side: int, time_limit: int = 0) -> World:
    states = side * side
    goal = states - 1
    row, column = np.divmod(np.arange(goal), side)
    landings = [
        np.clip(row + down, 0, side - 1) * side + np.clip(column + right, 0, side - 1)
        for down, right in MOVES
    ]
    next_state = np.stack(landings, axis=1).ravel().astype(np.int64)
    pairs = 4 * goal
    ones = np.ones(pairs)
    start = side // 2 * side + side // 2
    kinds = [CellKind.FLOOR] * states
    kinds[start], kinds[goal] = CellKind.START, CellKind.GOAL
    mdp = TabularMDP(
        state_names=tuple(map(str, range(states))),
        action_names=("left", "down", "right", "up"),
        first_pair=np.append(np.arange(0, pairs + 1, 4), pairs),
        pair_action=np.tile(np.arange(4), goal),
        time_limit=time_limit,
        first_outcome=np.arange(pairs + 1),
        next_state=next_state,
        reward=-ones,
        reward_std=np.zeros(pairs),
        terminated=next_state == goal,
        outcome_action=np.tile(np.arange(4), goal),
        probability=ones,
        cumulative=ones,
        start_state=np.array([start]),
        start_cumulative=np.ones(1),
    )
    return World(mdp, Grid(side, side, tuple(kinds), tuple(range(states)), MOVES))


@dataclass(frozen=True, slots=True, eq=False)
class OpenSection:
    side: int
    drawn_from_seed: bool = False

    def sketch(self) -> Grid:
        return Grid(self.side, self.side, (), (), ())

    def build(self, generator: Generator) -> World:
        return open_grid(self.side)


def open_grid_recipe(side: int, seed: int = 0) -> Recipe:
    scenario = Scenario(
        id=f"open-{side}",
        title=f"Open {side}×{side}",
        summary="an open map",
        notes="A sample.",
        order=0,
        kind="grid",
        defaults={},
        source=Path("open.toml"),
        section=cast("Any", OpenSection(side)),
    )
    return Recipe(scenario, "q-learning", Hyperparameters(alpha=0.1, gamma=0.99, epsilon=0.1), seed)
