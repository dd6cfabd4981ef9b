"""Worlds whose states form a row, each leading only to neighbours."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

_DIRECTIONS: Final = {"left": -1, "right": 1}
_LEAST_STATES: Final = 3


class Move(NamedTuple):
    """A named action, and the probability of each next state."""

    state: int
    action: str
    targets: Mapping[int, float]


def chain_order(
    states: int, moves: Iterable[Move], places: Mapping[int, tuple[float, float]]
) -> tuple[int, ...]:
    """Return the states of a chain from left to right. Empty if the world is not a chain.

    A chain has a single action, or the actions left and right, which must lead that way on average. With a
    single action, the end with the smaller place, (column, row), or the smaller number, is on the left.
    """
    moves = tuple(moves)
    names = {move.action for move in moves}
    if states < _LEAST_STATES or not (len(names) == 1 or names <= _DIRECTIONS.keys()):
        return ()
    links: list[set[int]] = [set() for _ in range(states)]
    for state, _, targets in moves:
        for target in targets:
            if target != state:
                links[state].add(target)
                links[target].add(state)
    ends = [state for state, own in enumerate(links) if len(own) == 1]
    if len(ends) != 2 or any(len(own) > 2 for own in links):
        return ()
    first = min(ends, key=lambda end: (places.get(end, (math.inf, 0.0)), end))
    order = [first]
    while ahead := links[order[-1]].difference(order[-2:]):
        order.append(ahead.pop())
    if len(order) < states:
        return ()
    position = {state: place for place, state in enumerate(order)}
    rightward = sum(
        _DIRECTIONS.get(action, 0) * chance * (position[target] - position[state])
        for state, action, targets in moves
        for target, chance in targets.items()
    )
    return tuple(reversed(order) if rightward < 0.0 else order)
