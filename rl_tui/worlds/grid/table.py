"""The transition table of a grid world, in whole arrays. States are the open cells, row by row."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.grid.map import CellMap, LegendEntry, with_border
from rl_tui.worlds.grid.moves import MOVES, STEPS, Gust, Landings, Slip, Terrain
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray, NumberNames
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP, TransitionArrays, mdp_of_arrays

if TYPE_CHECKING:
    from rl_tui.worlds.grid.moves import CellArray
    from rl_tui.worlds.grid.section import GridSection


# The states of a map


@dataclass(frozen=True, eq=False)
class GridStates:
    """The S states of a map. Arrays are [S] unless noted."""

    map: CellMap

    @cached_property
    def numbers(self) -> IntArray:
        """Cell of each state, row · columns + column."""
        return np.flatnonzero(~self._is_wall.ravel())

    @cached_property
    def open_cells(self) -> BoolArray:
        """True for open cells, with a border, [(rows + 2) · (columns + 2)]."""
        return with_border(~self._is_wall)

    @cached_property
    def places(self) -> CellArray:
        """Index of each state in `open_cells`."""
        return np.flatnonzero(self.open_cells).astype(np.int32)

    @cached_property
    def state_at(self) -> CellArray:
        """State of each of `open_cells`; undefined for closed cells."""
        states = np.zeros(len(self.open_cells), dtype=np.int32)
        states[self.places] = np.arange(len(self.places), dtype=np.int32)
        return states

    @cached_property
    def starts(self) -> IntArray:
        """Start states, [K]."""
        return np.flatnonzero(self._of(lambda entry: entry.kind is CellKind.START, np.bool_))

    @cached_property
    def ends(self) -> BoolArray:
        """True if entering ends the episode."""
        return self._of(lambda entry: entry.ends, np.bool_)

    @cached_property
    def exits(self) -> BoolArray:
        """True if "exit" is the only action."""
        return self._of(lambda entry: entry.exit, np.bool_)

    @cached_property
    def rewards(self) -> FloatArray:
        """Reward of each cell."""
        return self._of(lambda entry: entry.pays, np.float64)

    @cached_property
    def arrival(self) -> CellArray:
        """State after entering: itself, or the start after a fall."""
        arrival = np.arange(len(self.numbers), dtype=np.int32)
        arrival[self._of(lambda entry: entry.back, np.bool_)] = self.starts[0]
        return arrival

    @cached_property
    def jump_to(self) -> CellArray:
        """State to which all actions lead, or −1."""
        code_of = {character: code for code, character in enumerate(self.map.characters)}
        target = np.full(len(self.map.entries), -1, dtype=np.int32)
        for code, entry in enumerate(self.map.entries):
            if entry.jump is not None:
                target[code] = np.flatnonzero(self._codes == code_of[entry.jump])[0]
        return target[self._codes]

    def allows(self, move: str) -> BoolArray | None:
        """Return where `move` is possible, or None for everywhere."""
        if all(entry.only is None for entry in self.map.entries):
            return None
        return self._of(lambda entry: entry.only is None or move in entry.only, np.bool_)

    @cached_property
    def _is_wall(self) -> BoolArray:
        return self._lookup(lambda entry: entry.is_wall, np.bool_)[self.map.codes]

    @cached_property
    def _codes(self) -> npt.NDArray[np.uint8]:
        return self.map.codes.ravel()[self.numbers]

    def _lookup(self, quality: Callable[[LegendEntry], Any], kind: type[np.generic]) -> npt.NDArray[Any]:
        return np.array([quality(entry) for entry in self.map.entries], dtype=kind)

    def _of(self, quality: Callable[[LegendEntry], Any], kind: type[np.generic]) -> npt.NDArray[Any]:
        return self._lookup(quality, kind)[self._codes]


def grid_drawing(states: GridStates, actions: Sequence[str], wind: Sequence[int] = ()) -> Grid:
    """Return the drawing of a map."""
    rows, columns = states.map.codes.shape
    kinds = np.array([entry.kind for entry in states.map.entries], dtype=object)
    steps = [STEPS.get(name, (0, 0)) for name in actions]
    return Grid(
        rows=rows,
        columns=columns,
        kinds=tuple(kinds[states.map.codes.ravel()].tolist()),
        cell_of_state=tuple(states.numbers.tolist()),
        directions=tuple(step if any(step) else None for step in steps),
        wind=tuple(wind) if any(wind) else (),
        one_way=tuple(_one_way(states.map)),
    )


def _one_way(cells: CellMap) -> Iterator[tuple[int, tuple[int, int]]]:
    ways = {
        code: STEPS[entry.only[0]]
        for code, entry in enumerate(cells.entries)
        if entry.only is not None and len(entry.only) == 1
    }
    codes = cells.codes.ravel()
    for cell in np.flatnonzero(np.isin(codes, list(ways))).tolist():
        yield cell, ways[int(codes[cell])]


# The transition table


EXIT: Final = "exit"
_GUST_SHARE: Final = 1.0 / 3.0
_Way = tuple[int, Gust]


class Variant(NamedTuple):
    """One possible outcome of a move."""

    slip: Slip
    gust: Gust


def variants_of(rules: GridSection) -> list[Variant]:
    """Return the possible outcomes of a move, at most 27."""
    down = (0, -1, 1) if rules.gusts and any(rules.wind) else (0,)
    right = (0, -1, 1) if rules.gusts and any(rules.wind_rows) else (0,)
    return [Variant(slip, Gust(*gust)) for slip, *gust in product(rules.slips, down, right)]


def action_names(states: GridStates, rules: GridSection) -> tuple[str, ...]:
    """Return the moves, and "exit" if some cell has it."""
    moves = MOVES[rules.moves]
    return (*moves, EXIT) if states.exits.any() else moves


def grid_table(states: GridStates, rules: GridSection) -> TabularMDP:
    """Return the transition table of a valid map, without pairs for unreachable cells."""
    block = _Block(states, rules)
    return mdp_of_arrays(
        NumberNames(states.numbers),
        action_names(states, rules),
        block.arrays(),
        states.starts,
        np.full(len(states.starts), 1.0 / len(states.starts)),
        rules.time_limit,
        is_live=True,
    )


class _Block:
    """Outcomes of n acting cells × A actions × V variants, even impossible ones."""

    def __init__(self, states: GridStates, rules: GridSection) -> None:
        self.states, self.rules = states, rules
        self.moves, self.variants = MOVES[rules.moves], variants_of(rules)
        self.terrain = _terrain(states, rules)
        acting: IntArray = np.flatnonzero(~states.ends)
        landings = self._landings(acting)
        is_reached = self._reached(acting, landings)[acting]
        if not is_reached.all():
            acting, kept = acting[is_reached], np.flatnonzero(is_reached)
            landings = {way: each.of(kept) for way, each in landings.items()}
        self.acting = acting
        self.shape = (len(acting), len(action_names(states, rules)), len(self.variants))
        self.exits, self.jump_to = states.exits[acting], states.jump_to[acting]
        self.jumps = self.jump_to >= 0
        self.entered: CellArray = np.empty(self.shape, dtype=np.int32)
        self.bumped: BoolArray = np.zeros(self.shape if rules.bump_reward else (1, 1, 1), dtype=np.bool_)
        self._walk(landings)

    def arrays(self) -> TransitionArrays:
        cells, actions, variants = self.shape
        probability = self._probability()
        all_possible = bool((probability > 0.0).all())
        possible = np.broadcast_to(probability > 0.0, self.shape)

        def kept(values: npt.NDArray[Any], kind: type[np.generic]) -> npt.NDArray[Any]:
            if not all_possible:
                return np.broadcast_to(values, self.shape)[possible].astype(kind, copy=False)
            flat = np.empty(cells * actions * variants, dtype=kind)
            flat.reshape(self.shape)[...] = values
            return flat

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
            probability=kept(probability, np.float64),
            next_state=kept(self.states.arrival[self.entered], np.int64),
            reward=kept(self._reward(), np.float64),
            reward_std=np.zeros(int(count.sum())),
            terminated=kept(self.states.ends[self.entered] | self.exits[:, None, None], np.bool_),
            outcome_action=kept(self._happened(), np.int64),
        )

    def _landings(self, acting: IntArray) -> dict[_Way, Landings]:
        states, known = self.states, dict[_Way, Landings]()
        places = states.places[acting]
        for action, (slip, gust) in product(range(len(self.moves)), self.variants):
            happened = (action + slip.turn) % len(self.moves)
            if (happened, gust) not in known:
                move = self.moves[happened]
                allowed = states.allows(move)
                known[happened, gust] = self.terrain.landings(
                    places, STEPS[move], None if allowed is None else allowed[acting], gust
                )
        return known

    def _reached(self, acting: IntArray, landings: dict[_Way, Landings]) -> BoolArray:
        states = self.states
        leads_to = np.stack([states.state_at[each.cells] for each in landings.values()], axis=1)
        jumps = states.jump_to[acting] >= 0
        leads_to[jumps] = states.jump_to[acting][jumps][:, None]
        leads_to = states.arrival[leads_to]
        goes_on = ~states.ends[leads_to] & ~states.exits[acting][:, None]
        count = np.zeros(len(states.numbers) + 1, dtype=np.int64)
        count[acting + 1] = goes_on.sum(axis=1)
        return reachable(np.cumsum(count), leads_to[goes_on].astype(np.int64), states.starts)

    def _walk(self, landings: dict[_Way, Landings]) -> None:
        for action, (variant, (slip, gust)) in product(range(len(self.moves)), enumerate(self.variants)):
            landed = landings[(action + slip.turn) % len(self.moves), gust]
            self.entered[:, action, variant] = self.states.state_at[landed.cells]
            if self.rules.bump_reward:
                self.bumped[:, action, variant] = landed.bumped
        still = self.exits | self.jumps
        if still.any():
            ends_in = np.where(self.jumps, self.jump_to, self.acting)[still]
            self.entered[still] = ends_in[:, None, None]
            if self.rules.bump_reward:
                self.bumped[still] = False
        # "exit" is impossible elsewhere, but its index must stay on the map
        self.entered[:, len(self.moves) :] = self.acting[:, None, None]

    def _probability(self) -> FloatArray:
        # [1 or n, 1 or A, V]
        chance = np.array([slip.probability for slip, _ in self.variants])[None, None, :]
        for axis, wind in enumerate((self.terrain.wind_down, self.terrain.wind_right)):
            if self.rules.gusts and wind is not None:
                windy = (wind[self.states.places[self.acting]] != 0)[:, None, None]
                blows = np.array([gust[axis] != 0 for _, gust in self.variants])[None, None, :]
                chance = chance * np.where(windy, _GUST_SHARE, np.where(blows, 0.0, 1.0))
        if self.jumps.any():
            certain = np.arange(len(self.variants)) == 0
            chance = np.where(self.jumps[:, None, None], certain[None, None, :].astype(np.float64), chance)
        if self.shape[1] > len(self.moves):
            is_move = (np.arange(self.shape[1]) < len(self.moves))[None, :, None]
            exits = (~is_move) & (np.arange(len(self.variants)) == 0)[None, None, :]
            chance = np.where(self.exits[:, None, None], exits.astype(np.float64), chance * is_move)
        return chance

    def _happened(self) -> IntArray:
        # [1 or n, A, V]
        meant = np.arange(self.shape[1], dtype=np.int64)[None, :, None]
        turn = np.array([slip.turn for slip, _ in self.variants])[None, None, :]
        happened = np.where(meant < len(self.moves), (meant + turn) % len(self.moves), meant)
        if self.jumps.any():
            return np.where(self.jumps[:, None, None], meant, happened)
        return happened

    def _reward(self) -> FloatArray:
        # [n, 1 or A, 1 or V]
        states, rules = self.states, self.rules
        if rules.rewards == "leaving":
            reward = (states.rewards[self.acting] + rules.step_reward)[:, None, None]
        else:
            reward = (np.where(states.exits, 0.0, states.rewards) + rules.step_reward)[self.entered]
        if rules.bump_reward:
            reward = reward + rules.bump_reward * self.bumped
        if self.exits.any():
            reward = np.where(self.exits[:, None, None], states.rewards[self.acting][:, None, None], reward)
        return reward


def _terrain(states: GridStates, rules: GridSection) -> Terrain:
    # Upward wind is negative, since rows count downwards
    rows, columns = states.map.codes.shape

    def everywhere(wind: CellArray) -> CellArray | None:
        return np.pad(np.broadcast_to(wind, (rows, columns)), 1).ravel() if wind.any() else None

    down = everywhere(-np.array(rules.wind, dtype=np.int32))
    right = everywhere(np.array(rules.wind_rows, dtype=np.int32)[:, None])
    return Terrain(states.open_cells, columns + 2, down, right)
