"""The order in which the screen shows actions: the same in every world that has directions.

Every world numbers its actions in its own order: lakes ← ↓ → ↑, the cliff ↑ → ↓ ←. Files and ties keep that.
The screen shows ↑ → ↓ ←, then ↗ ↘ ↙ ↖, then staying, then all other actions.
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
    """Return the numbers of all actions of ``world`` in the order in which they are shown."""
    return order_of(world.space, world.drawing)


def order_of(space: FiniteSpace, drawing: Drawing) -> tuple[int, ...]:
    """Return the same where only the space and the drawing of a world are at hand."""
    if isinstance(drawing, Grid):
        return _order(drawing.directions)
    return tuple(range(len(space.action_names)))


def shown_place(world: World, action: int) -> int:
    """Return where ``action`` comes in that order, from 0, to sort by; an unknown one (< 0) comes last."""
    if action < 0:
        return len(world.space.action_names)
    drawing = world.drawing
    return _inverse(drawing.directions)[action] if isinstance(drawing, Grid) else action


def shown_pairs(world: World, pairs: Iterable[int]) -> list[int]:
    """Return ``pairs``, all of one state, in the order in which their actions are shown."""
    listed = list(pairs)
    if not isinstance(world.drawing, Grid):
        return sorted(listed)
    places, actions = _inverse(world.drawing.directions), world.space.pair_action
    return sorted(listed, key=lambda pair: places[int(actions[pair])])


def shown_outcomes(world: World, mdp: TabularMDP, pair: int) -> list[int]:
    """Return the outcomes of ``pair`` in the order of the actions that really happen in them."""
    return sorted(mdp.outcomes_of(pair), key=lambda each: shown_place(world, int(mdp.outcome_action[each])))


@lru_cache
def _order(directions: tuple[Direction | None, ...]) -> tuple[int, ...]:
    last = len(_CLOCKWISE)
    return tuple(sorted(range(len(directions)), key=lambda action: _PLACES.get(directions[action], last)))


@lru_cache
def _inverse(directions: tuple[Direction | None, ...]) -> tuple[int, ...]:
    order = _order(directions)
    return tuple(order.index(action) for action in range(len(order)))
