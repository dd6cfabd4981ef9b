"""The layers of world and table: numbers per pair [P] or state [S]."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from typing import Final

import numpy as np

from rl_tui.live.snapshot import AgentView, Snapshot
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.runs.bandit import best_arms, true_means
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.kit.counterparts import are_alike
from rl_tui.screen.kit.numbers_in_common import (
    best_of_states,
    ends,
    exact_v,
    finite,
    held_pairs,
    known_v,
    lanes_in_view,
    tried_pairs,
    tried_q,
)
from rl_tui.screen.kit.snapshot_facts import is_secret, keeps_back
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.mdp.space import BoolArray, FloatArray
from rl_tui.worlds.world import World


class Layer(StrEnum):
    """The layers, in their key's order."""

    Q = "Q"
    OPTIMAL = "Q*"
    ERROR = "Q−Q*"
    POLICY = "Qπ"
    LANES = "Q−other"
    VISITS = "visits"
    LANDSCAPE = "landscape"


EXACT_LAYERS: Final = (Layer.OPTIMAL, Layer.ERROR)
WORLD_LAYERS: Final = (*EXACT_LAYERS, Layer.VISITS)
"""Layers that replace V in the world."""
ACTION_LAYERS: Final = (Layer.Q, Layer.OPTIMAL)
"""Layers in which map cells can show every action."""
WORDS: Final = {Layer.OPTIMAL: "exact value", Layer.ERROR: "error", Layer.VISITS: "visits"}
"""Names for the numbers of a layer, by default ``value``."""

Exact = tuple[FloatArray, BoolArray]

# What is known


def exact_q(snapshot: Snapshot) -> Exact | None:
    """Return Q* and its greedy pairs, [P] each, unless hidden."""
    if is_secret(snapshot):
        return None
    if snapshot.world.is_bandit:
        mdp = snapshot.world.mdp
        if mdp is not None and (mdp.drift_std == 0.0 or snapshot.counters.step == 0):
            return true_means(mdp), best_arms(mdp)
    solution = snapshot.exact_answer.solution
    return None if solution is None else (solution.q, solution.greedy)


def hides_exact(snapshot: Snapshot) -> bool:
    """Return whether exact values exist, or will, but are hidden."""
    return is_secret(snapshot) and not snapshot.exact_answer.refused


def veils_exact(snapshot: Snapshot) -> bool:
    """Return whether ``···`` stands for a Q* to reveal."""
    has_key = hides_exact(snapshot) and not keeps_back(snapshot, "answer")
    return has_key and not snapshot.world.is_bandit


def veiled(glyphs: Glyphs) -> str:
    """Return the placeholder for a hidden number."""
    return "..." if glyphs.name == "ascii" else "···"


def shown_exact(snapshot: Snapshot) -> Exact | None:
    """Return :func:`exact_q`, or NaN behind ``···``."""
    if veils_exact(snapshot):
        pairs = snapshot.world.space.pairs
        return np.full(pairs, np.nan), np.zeros(pairs, np.bool_)
    return exact_q(snapshot)


def other_lane(snapshot: Snapshot) -> LaneView | None:
    """Return the second visible run if comparable."""
    group, beside = snapshot.run_group, snapshot.beside
    other = group.lanes[group.beside] if group.lanes and group.beside is not None else None
    if other is None or (beside is not None and not are_alike(snapshot.world, beside.world)):
        return None
    return other if len(other.q) == snapshot.world.space.pairs else None


# Layers of a world


def world_layer(snapshot: Snapshot, layer: Layer) -> Layer:
    """Return a world's layer, Q by default."""
    if snapshot.world.is_bandit or layer not in WORLD_LAYERS:
        return Layer.Q
    return Layer.Q if layer in EXACT_LAYERS and shown_exact(snapshot) is None else layer


def as_layer(snapshot: Snapshot, layer: Layer) -> Snapshot:
    """Put a layer's numbers in place of V."""
    if layer in (Layer.Q, Layer.LANDSCAPE):
        return snapshot
    exact, beside = shown_exact(snapshot), snapshot.beside
    if layer is Layer.OPTIMAL and exact is not None:
        agent = _optimal(snapshot, *exact)
    else:
        agent = _compared(snapshot, layer, exact)
    if beside is not None and world_layer(beside, layer) is layer:
        beside = as_layer(beside, layer)
    return replace(snapshot, agent=agent, beside=beside)


def _optimal(snapshot: Snapshot, q: FloatArray, greedy: BoolArray) -> AgentView:
    space, values = snapshot.world.space, np.zeros(snapshot.world.space.states)
    values[np.diff(space.first_pair) > 0] = best_of_states(space, q)
    return with_exact(snapshot, values, q, greedy.astype(np.float64))


def with_exact(snapshot: Snapshot, values: FloatArray, q: FloatArray, policy: FloatArray) -> AgentView:
    """Put exact numbers of a policy in place of the learned ones."""
    visits = np.ones(len(q), np.int64)
    return replace(snapshot.agent, q=q, values=values, policy=policy, visits=visits, part=None)


def _compared(snapshot: Snapshot, layer: Layer, exact: Exact | None) -> AgentView:
    agent, space = snapshot.agent, snapshot.world.space
    states, pairs, first = held_pairs(space, agent.part)
    q = agent.q[pairs]
    best = np.maximum.reduceat(q, first)
    values, policy = np.zeros(space.states), agent.policy
    if layer is Layer.VISITS:
        values[states] = np.add.reduceat(agent.visits[pairs], first)
    else:
        assert exact is not None
        own = agent.values[states] if len(agent.values) else best
        values[states] = own - np.maximum.reduceat(exact[0][pairs], first)
    if not len(policy):
        counts = np.diff(first, append=len(q))
        policy = np.zeros(space.pairs)
        policy[pairs] = q == np.repeat(best, counts)
    return replace(agent, values=values, policy=policy)


# The numbers of scales


_LEAST_ERROR: Final = 0.01  # share of the range of Q*: numbers do not show a tenth of it
_FEW: Final = 8  # states: V of fewer may be close together, unlike their Q


def layer_numbers(snapshot: Snapshot, layer: Layer) -> tuple[FloatArray, FloatArray]:
    """Return the numbers that set a scale (V, as errors or of few states also Q), and all that it colours."""
    if layer is Layer.ERROR:
        errors = finite(np.concatenate([_errors(lane) for lane in lanes_in_view(snapshot)]))
        return errors, errors
    seen = as_layer(snapshot, layer) if layer in WORLD_LAYERS else snapshot
    v = known_v(seen)
    if layer is Layer.VISITS:
        return v, v
    coloured = np.concatenate([v, tried_q(seen)])
    return v if _has_many_states(snapshot.world) else coloured, coloured


def least_error(snapshot: Snapshot) -> float:
    """Return the end of a scale of errors that are all small, where Q* is known."""
    known = [exact[0] for lane in lanes_in_view(snapshot) if (exact := exact_q(lane)) is not None]
    low, high = ends(finite(np.concatenate(known)))
    return _LEAST_ERROR * (high - low)


def policy_numbers(world: World, answer: PolicyAnswer) -> FloatArray:
    """Return a scale's numbers of a policy with known values."""
    assert answer.v is not None
    assert answer.q is not None
    v = exact_v(world, answer.v)
    return v if _has_many_states(world) else np.concatenate([v, finite(answer.q)])


def _has_many_states(world: World) -> bool:
    return bool(np.count_nonzero(np.diff(world.space.first_pair)) >= _FEW)


def _errors(lane: Snapshot) -> FloatArray:
    """Return the errors of known V and of tried pairs: no others have colours."""
    exact, tried = exact_q(lane), tried_pairs(lane)
    if exact is None:
        return np.empty(0)
    errors = lane.agent.q[tried] - exact[0][tried]
    if lane.world.is_bandit:
        return np.asarray(errors)
    return np.concatenate([known_v(as_layer(replace(lane, beside=None), Layer.ERROR)), errors])
