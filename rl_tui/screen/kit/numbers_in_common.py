"""Numbers of both visible runs."""

from __future__ import annotations

from typing import Final
from weakref import WeakKeyDictionary

import numpy as np

from rl_tui.live.snapshot import Snapshot
from rl_tui.live.viewport import CopiedPart
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.world import World

_EXITS: Final = WeakKeyDictionary[World, BoolArray]()  # computed once per world


def lanes_in_view(snapshot: Snapshot) -> tuple[Snapshot, ...]:
    """Return ``snapshot`` and the second visible run."""
    return (snapshot,) if snapshot.beside is None else (snapshot, snapshot.beside)


def all_q(snapshot: Snapshot) -> FloatArray:
    """Return all finite Q."""
    return finite(np.concatenate([_q(lane) for lane in lanes_in_view(snapshot)]))


def all_v(snapshot: Snapshot) -> FloatArray:
    """Return the finite V of states with actions."""
    return finite(np.concatenate([_v(lane)[0] for lane in lanes_in_view(snapshot)]))


def known_v(snapshot: Snapshot) -> FloatArray:
    """Return V of learned states, or estimates of pulled arms, without exits, which show rewards."""
    if snapshot.world.is_bandit:
        return tried_q(snapshot)
    return finite(np.concatenate([v[known] for v, known in map(_v, lanes_in_view(snapshot))]))


def exact_v(world: World, values: FloatArray) -> FloatArray:
    """Return the finite V of states with actions, without exits."""
    return finite(values[np.diff(world.space.first_pair) > 0][~_exits(world)])


def tried_q(snapshot: Snapshot) -> FloatArray:
    """Return the finite Q of tried pairs."""
    return finite(np.concatenate([lane.agent.q[tried_pairs(lane)] for lane in lanes_in_view(snapshot)]))


def tried_pairs(lane: Snapshot) -> IntArray:
    """Return the copied pairs with visits."""
    part, visits = lane.agent.part, lane.agent.visits
    return np.flatnonzero(visits) if part is None else part.pairs[visits[part.pairs] > 0]


def best_of_states(space: FiniteSpace, values: FloatArray) -> FloatArray:
    """Return the maximum per state of ``values`` [P]."""
    first = space.first_pair[:-1][np.diff(space.first_pair) > 0]
    return np.asarray(np.maximum.reduceat(values, first)) if len(first) else np.empty(0)


def finite(values: FloatArray) -> FloatArray:
    """Drop NaN and infinite values."""
    return values[np.isfinite(values)]


def ends(values: FloatArray) -> tuple[float, float]:
    """Return finite minimum and maximum, or zeros."""
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def _q(lane: Snapshot) -> FloatArray:
    part = lane.agent.part
    return lane.agent.q if part is None else lane.agent.q[part.pairs]


def held_pairs(space: FiniteSpace, part: CopiedPart | None) -> tuple[IntArray, IntArray | slice, IntArray]:
    """Return copied states, their pairs, and each state's first index."""
    if part is None:
        states = np.flatnonzero(np.diff(space.first_pair))
        return states, slice(None), space.first_pair[states]
    pairs = np.flatnonzero(part.held)
    owner = np.searchsorted(space.first_pair, pairs, side="right") - 1
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    return owner[first], pairs, first


def _v(lane: Snapshot) -> tuple[FloatArray, BoolArray]:
    """Return V of each copied state, and whether it was learned."""
    agent = lane.agent
    states, pairs, first = held_pairs(lane.world.space, agent.part)
    if not len(first):
        return np.empty(0), np.empty(0, dtype=np.bool_)
    q, visits = agent.q[pairs], agent.visits[pairs]
    v = np.maximum.reduceat(q, first)
    known = (np.add.reduceat(visits, first) > 0) | (np.minimum.reduceat(q, first) != v)
    if agent.part is None:
        known &= ~_exits(lane.world)
    if len(agent.policy):
        v = agent.values[states]
    return np.asarray(v), np.asarray(known)


def _exits(world: World) -> BoolArray:
    if world not in _EXITS:
        _EXITS[world] = _find_exits(world)
    return _EXITS[world]


def _find_exits(world: World) -> BoolArray:
    counts, drawing = np.diff(world.space.first_pair), world.drawing
    if not isinstance(drawing, Grid) or not any(drawing.directions):
        return np.zeros(np.count_nonzero(counts), dtype=np.bool_)
    is_other = np.array([step is None for step in drawing.directions])
    first_action = world.space.pair_action[world.space.first_pair[:-1][counts > 0]]
    return np.asarray((counts[counts > 0] == 1) & is_other[first_action])
