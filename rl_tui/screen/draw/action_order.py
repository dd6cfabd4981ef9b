"""The order of actions on screen: ↑ → ↓ ←, then ↗ ↘ ↙ ↖, then staying, then all others.

Worlds number their actions differently. Files and ties keep these numbers.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Final

from rl_tui.worlds.drawing import Drawing, Grid
from rl_tui.worlds.mdp.space import FiniteSpace
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

Direction = tuple[int, int]
_CLOCKWISE: Final[tuple[Direction, ...]] = (
    *((-1, 0), (0, 1), (1, 0), (0, -1)),
    *((-1, 1), (1, 1), (1, -1), (-1, -1)),
    (0, 0),
)
_PLACES: Final[dict[Direction | None, int]] = {step: place for place, step in enumerate(_CLOCKWISE)}


def shown_order(world: World) -> tuple[int, ...]:
    """Return all actions in screen order."""
    return order_of(world.space, world.drawing)


def order_of(space: FiniteSpace, drawing: Drawing) -> tuple[int, ...]:
    """Return :func:`shown_order` from space and drawing."""
    if isinstance(drawing, Grid):
        return _order(drawing.directions)
    return tuple(range(len(space.action_names)))


def shown_place(world: World, action: int) -> int:
    """Return an action's index. Unknown ones (< 0) come last."""
    if action < 0:
        return len(world.space.action_names)
    drawing = world.drawing
    return _inverse(drawing.directions)[action] if isinstance(drawing, Grid) else action


def shown_pairs(world: World, pairs: Iterable[int]) -> list[int]:
    """Sort one state's ``pairs``."""
    listed = list(pairs)
    if not isinstance(world.drawing, Grid):
        return sorted(listed)
    places, actions = _inverse(world.drawing.directions), world.space.pair_action
    return sorted(listed, key=lambda pair: places[int(actions[pair])])


def shown_outcomes(world: World, mdp: TabularMDP, pair: int) -> list[int]:
    """Return a pair's outcomes, ordered by the actions that really happen."""
    return sorted(mdp.outcomes_of(pair), key=lambda each: shown_place(world, int(mdp.outcome_action[each])))


@lru_cache
def _order(directions: tuple[Direction | None, ...]) -> tuple[int, ...]:
    last = len(_CLOCKWISE)
    return tuple(sorted(range(len(directions)), key=lambda action: _PLACES.get(directions[action], last)))


@lru_cache
def _inverse(directions: tuple[Direction | None, ...]) -> tuple[int, ...]:
    order = _order(directions)
    return tuple(order.index(action) for action in range(len(order)))


def next_states(world: World, pair: int) -> frozenset[int]:
    """Return the possible next states, if known."""
    if world.mdp is not None:
        return frozenset(world.mdp.next_state[world.mdp.outcomes_of(pair)].tolist())
    return frozenset(each.next_state for each in world.prospects[pair]) if world.prospects else frozenset()
