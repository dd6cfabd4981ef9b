"""From a map and its rules to the transition table, in whole arrays."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.grid.moves import MOVES, STEPS, Gust, Landings, Slip, Terrain
from rl_tui.worlds.grid.states import GridStates
from rl_tui.worlds.mdp.number_names import NumberNames
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP, TransitionArrays, mdp_of_arrays

if TYPE_CHECKING:
    from rl_tui.worlds.grid.moves import CellArray
    from rl_tui.worlds.grid.section import GridSection

EXIT: Final = "exit"
_GUST_SHARE: Final = 1.0 / 3.0


class Variant(NamedTuple):
    """One way in which every move may turn out."""

    slip: Slip
    gust: Gust


def variants_of(rules: GridSection) -> list[Variant]:
    """Return the ways in which moves may turn out, at most 27."""
    down = (0, -1, 1) if rules.gusts and any(rules.wind) else (0,)
    right = (0, -1, 1) if rules.gusts and any(rules.wind_rows) else (0,)
    return [Variant(slip, Gust(*gust)) for slip, *gust in product(rules.slips, down, right)]


def action_names(states: GridStates, rules: GridSection) -> tuple[str, ...]:
    """Return the moves, and "exit" where a cell has it."""
    moves = MOVES[rules.moves]
    return (*moves, EXIT) if states.exits.any() else moves


def grid_table(states: GridStates, rules: GridSection) -> TabularMDP:
    """Return the table of a map without faults.

    Every move from every cell that is not terminal is worked out, for all cells at once; the pairs of cells
    that cannot be reached are then dropped.
    """
    block = _Block(states, rules)
    return mdp_of_arrays(
        NumberNames(states.numbers),
        action_names(states, rules),
        block.arrays(),
        states.starts,
        np.full(len(states.starts), 1.0 / len(states.starts)),
        rules.time_limit,
    )


class _Block:
    """The outcomes of n acting cells × A actions × V variants; not all of them are possible everywhere."""

    def __init__(self, states: GridStates, rules: GridSection) -> None:
        self.states, self.rules = states, rules
        self.acting: IntArray = np.flatnonzero(~states.ends)
        self.moves, self.variants = MOVES[rules.moves], variants_of(rules)
        self.shape = (len(self.acting), len(action_names(states, rules)), len(self.variants))
        self.exits, self.jump_to = states.exits[self.acting], states.jump_to[self.acting]
        self.jumps = self.jump_to >= 0
        self.terrain = _terrain(states, rules)
        self.entered: CellArray = np.empty(self.shape, dtype=np.int32)
        self.bumped: BoolArray = np.zeros(self.shape if rules.bump_reward else (1, 1, 1), dtype=np.bool_)
        self._walk()

    def arrays(self) -> TransitionArrays:
        """Return all that is possible, pair by pair."""
        cells, actions, variants = self.shape
        probability = self._probability()
        all_possible = bool((probability > 0.0).all())
        possible = np.broadcast_to(probability > 0.0, self.shape)

        def kept(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
            values = np.broadcast_to(values, self.shape)
            return values.flatten() if all_possible else values[possible]

        count = np.full(cells * actions, variants) if all_possible else possible.sum(axis=2).ravel()
        pair_state = np.repeat(self.acting, actions)
        pair_action = np.tile(np.arange(actions, dtype=np.int64), cells)
        legal = count > 0
        if not legal.all():
            pair_state, pair_action, count = pair_state[legal], pair_action[legal], count[legal]
        return TransitionArrays(
            pair_state=pair_state,
            pair_action=pair_action,
            outcome_count=count,
            probability=kept(probability),
            next_state=kept(self.states.arrival[self.entered]).astype(np.int64),
            reward=kept(self._reward()),
            reward_std=np.zeros(int(count.sum())),
            terminated=kept(self.states.ends[self.entered] | self.exits[:, None, None]),
            outcome_action=kept(self._happened()),
        )

    def _walk(self) -> None:
        """Work out which state each outcome enters, and where one is stopped."""
        states, known = self.states, dict[tuple[int, Gust], Landings]()
        places = states.places[self.acting]
        for action, (variant, (slip, gust)) in product(range(len(self.moves)), enumerate(self.variants)):
            happened = (action + slip.turn) % len(self.moves)
            if (happened, gust) not in known:
                move = self.moves[happened]
                allowed = states.allows(move)
                known[happened, gust] = self.terrain.landings(
                    places, STEPS[move], None if allowed is None else allowed[self.acting], gust
                )
            landings = known[happened, gust]
            self.entered[:, action, variant] = states.state_at[landings.cells]
            if self.rules.bump_reward:
                self.bumped[:, action, variant] = landings.bumped
        still = self.exits | self.jumps
        if still.any():
            ends_in = np.where(self.jumps, self.jump_to, self.acting)[still]
            self.entered[still] = ends_in[:, None, None]
            if self.rules.bump_reward:
                self.bumped[still] = False
        # "exit" is impossible elsewhere, but must not point out of the map
        self.entered[:, len(self.moves) :] = self.acting[:, None, None]

    def _probability(self) -> FloatArray:
        """Return the chance of each variant, [1 or n, 1 or A, V]."""
        chance = np.array([slip.probability for slip, _ in self.variants])[None, None, :]
        for axis, wind in enumerate((self.terrain.wind_down, self.terrain.wind_right)):
            if self.rules.gusts and wind is not None:
                windy = (wind[self.states.places[self.acting]] != 0)[:, None, None]
                blows = np.array([gust[axis] != 0 for _, gust in self.variants])[None, None, :]
                chance = chance * np.where(windy, _GUST_SHARE, np.where(blows, 0.0, 1.0))
        if self.jumps.any():
            certain = np.arange(len(self.variants)) == 0
            chance = np.where(self.jumps[:, None, None], certain[None, None, :].astype(np.float64), chance)
        if self.exits.any():
            is_move = (np.arange(self.shape[1]) < len(self.moves))[None, :, None]
            exits = (~is_move) & (np.arange(len(self.variants)) == 0)[None, None, :]
            chance = np.where(self.exits[:, None, None], exits.astype(np.float64), chance * is_move)
        return chance

    def _happened(self) -> IntArray:
        """Return the action that really happens, [1 or n, A, V]."""
        meant = np.arange(self.shape[1], dtype=np.int64)[None, :, None]
        turn = np.array([slip.turn for slip, _ in self.variants])[None, None, :]
        happened = np.where(meant < len(self.moves), (meant + turn) % len(self.moves), meant)
        if self.jumps.any():
            return np.where(self.jumps[:, None, None], meant, happened)
        return happened

    def _reward(self) -> FloatArray:
        """Return what each outcome pays, [n, 1 or A, 1 or V]."""
        states, rules = self.states, self.rules
        if rules.rewards == "leaving":
            reward = (states.rewards[self.acting] + rules.step_reward)[:, None, None]
        else:
            reward = np.where(states.exits, 0.0, states.rewards)[self.entered] + rules.step_reward
        if rules.bump_reward:
            reward = reward + rules.bump_reward * self.bumped
        if self.exits.any():
            reward = np.where(self.exits[:, None, None], states.rewards[self.acting][:, None, None], reward)
        return reward


def _terrain(states: GridStates, rules: GridSection) -> Terrain:
    """Return the map with its wind, which blows up where rows are counted down."""
    rows, columns = states.map.codes.shape

    def everywhere(wind: CellArray) -> CellArray | None:
        return np.pad(np.broadcast_to(wind, (rows, columns)), 1).ravel() if wind.any() else None

    down = everywhere(-np.array(rules.wind, dtype=np.int32))
    right = everywhere(np.array(rules.wind_rows, dtype=np.int32)[:, None])
    return Terrain(states.open_cells, columns + 2, down, right)
