"""The numbers of both lanes in view: they have one form, and tints between the same ends."""

from __future__ import annotations

import numpy as np

from rl_tui.live.snapshot import Snapshot
from rl_tui.worlds.mdp.space import FloatArray


def lanes_in_view(snapshot: Snapshot) -> tuple[Snapshot, ...]:
    """Return ``snapshot`` and that of the lane beside it, if there is one."""
    return (snapshot,) if snapshot.beside is None else (snapshot, snapshot.beside)


def all_q(snapshot: Snapshot) -> FloatArray:
    """Return the finite Q of all pairs; of a large world those that the snapshot holds."""
    return finite(np.concatenate([_q(lane) for lane in lanes_in_view(snapshot)]))


def all_v(snapshot: Snapshot) -> FloatArray:
    """Return the finite V of all states with actions; of a large world those that the snapshot holds."""
    return finite(np.concatenate([_v(lane) for lane in lanes_in_view(snapshot)]))


def finite(values: FloatArray) -> FloatArray:
    """Return those of ``values`` that are numbers."""
    return values[np.isfinite(values)]


def ends(values: FloatArray) -> tuple[float, float]:
    """Return the least and the greatest of finite ``values``; zeros where there is none."""
    return (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)


def _q(lane: Snapshot) -> FloatArray:
    part = lane.agent.part
    return lane.agent.q if part is None else lane.agent.q[part.pairs]


def _v(lane: Snapshot) -> FloatArray:
    first_pair, part, q = lane.world.space.first_pair, lane.agent.part, lane.agent.q
    if len(lane.agent.policy):
        return lane.agent.values[np.diff(first_pair) > 0]
    if part is None:
        first = first_pair[:-1][np.diff(first_pair) > 0]
    else:
        pairs = np.flatnonzero(part.held)
        state = np.searchsorted(first_pair, pairs, side="right")
        q, first = q[pairs], np.flatnonzero(np.diff(state, prepend=-1))
    return np.asarray(np.maximum.reduceat(q, first)) if len(first) else np.empty(0)
