"""Matching states and pairs of two worlds, by map cell or by name."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from rl_tui.screen.kit.pointing import NOWHERE
from rl_tui.worlds.drawing import Arms, Grid
from rl_tui.worlds.editing.carried import NEW, Carried, Keyed, carried_by_keys
from rl_tui.worlds.mdp.space import IntArray
from rl_tui.worlds.world import World

Found = TypeVar("Found")


def _kept(find: Callable[[World, World], Found]) -> Callable[[World, World], Found]:
    """Cache the result while both worlds exist."""
    known = WeakKeyDictionary[World, WeakKeyDictionary[World, Found]]()

    @wraps(find)
    def found(world: World, other: World) -> Found:
        of_world = known.setdefault(world, WeakKeyDictionary())
        if other not in of_world:
            of_world[other] = find(world, other)
        return of_world[other]

    return found


def are_alike(world: World, other: World) -> bool:
    """Return whether both number states, actions and pairs equally."""
    return world.space is other.space or _have_same_numbers(world, other)


@_kept
def _have_same_numbers(world: World, other: World) -> bool:
    one, two = world.space, other.space
    if (one.states, one.pairs, one.action_names) != (two.states, two.pairs, two.action_names):
        return False
    if not are_same_size(world, other):
        return False
    same_pairs = np.array_equal(one.first_pair, two.first_pair)
    same_pairs = same_pairs and np.array_equal(one.pair_action, two.pair_action)
    return same_pairs and list(_state_keys(world)) == list(_state_keys(other))


@_kept
def in_common(world: World, other: World) -> Carried:
    """Return matching states [S] and pairs [P], or NEW."""
    if not are_same_size(world, other):
        space = world.space
        return Carried(np.full(space.states, NEW), np.full(space.pairs, NEW))
    now, before = (Keyed(each.space, _state_keys(each), each.space.action_names) for each in (other, world))
    return carried_by_keys(now, before)


def are_same_size(world: World, other: World) -> bool:
    """Return whether both are equally large maps or bandits, or graphs."""
    one, two = world.drawing, other.drawing
    if isinstance(one, Grid) and isinstance(two, Grid):
        return (one.rows, one.columns) == (two.rows, two.columns)
    if isinstance(one, Arms) and isinstance(two, Arms):
        return world.space.pairs == other.space.pairs
    return type(one) is type(two)


def _state_keys(world: World) -> IntArray | Sequence[Hashable]:
    drawing = world.drawing
    if isinstance(drawing, Grid) and len(set(drawing.cell_of_state)) == world.space.states:
        return np.array(drawing.cell_of_state, dtype=np.int64)
    return tuple(world.space.state_names)


def state_in(state: int, world: World, other: World) -> int | None:
    """Return the matching state of ``other``."""
    return state if are_alike(world, other) else _number(in_common(world, other).states[state])


def pair_in(pair: int, world: World, other: World) -> int | None:
    """Return the matching pair of ``other``."""
    return pair if are_alike(world, other) else _number(in_common(world, other).pairs[pair])


def pairs_in(pairs: range, world: World, other: World) -> range:
    """Match one pair, or a state's."""
    if not pairs or are_alike(world, other):
        return pairs
    if len(pairs) == 1 and (pair := pair_in(pairs.start, world, other)) is not None:
        return range(pair, pair + 1)
    state = state_in(world.space.state_of(pairs.start), world, other)
    return NOWHERE if len(pairs) == 1 or state is None else other.space.pairs_of(state)


def _number(found: np.int64) -> int | None:
    return None if found == NEW else int(found)
