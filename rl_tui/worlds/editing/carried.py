"""What of one world there is in another: which of its states and pairs are the same."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from rl_tui.worlds.editing.draft import Draft
    from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
    from rl_tui.worlds.world import World

NEW: Final = -1
"""In place of a number in the world before: there was no such thing."""


class Carried(NamedTuple):
    """For each state, [S], and each pair, [P], of a world what it was in the world before, or NEW."""

    states: IntArray
    pairs: IntArray

    def states_now(self, before: Collection[int]) -> frozenset[int]:
        """Return the numbers that these states of the world ``before`` have now; some may be gone."""
        return frozenset(np.flatnonzero(np.isin(self.states, list(before))).tolist())

    def pairs_now(self, before: Collection[int]) -> frozenset[int]:
        """Return the numbers that these pairs of the world ``before`` have now; some may be gone."""
        return frozenset(np.flatnonzero(np.isin(self.pairs, list(before))).tolist())


def carried(before: tuple[Draft, World], after: tuple[Draft, World]) -> Carried:
    """Return what the states and pairs of ``after`` were in ``before``: each a draft and its world."""
    (old_draft, old), (draft, world) = before, after
    states = _numbers(old_draft.state_keys(old), draft.state_keys(world))
    actions = _numbers(old_draft.action_keys(old), draft.action_keys(world))
    return Carried(states, _pairs(old.space, world.space, states, actions))


def _numbers(old: IntArray | Sequence[Hashable], new: IntArray | Sequence[Hashable]) -> IntArray:
    """Return where each of the ``new`` keys stands among the ``old`` ones, NEW for nowhere."""
    if isinstance(old, np.ndarray) and isinstance(new, np.ndarray):
        order = np.argsort(old, kind="stable")
        place = np.searchsorted(old, new, sorter=order)
        found: IntArray = order[np.minimum(place, len(old) - 1)]
        return np.where(old[found] == new, found, NEW)
    number_of = {key: number for number, key in enumerate(old)}
    return np.array([number_of.get(key, NEW) for key in new], dtype=np.int64)


def _pairs(old: FiniteSpace, new: FiniteSpace, states: IntArray, actions: IntArray) -> IntArray:
    """Return what each pair of ``new`` was in ``old``."""
    owner = np.repeat(np.arange(new.states), np.diff(new.first_pair))
    state, action = states[owner], actions[new.pair_action]
    width = len(old.action_names)
    known = np.repeat(np.arange(old.states), np.diff(old.first_pair)) * width + old.pair_action
    wanted = np.where((state == NEW) | (action == NEW), NEW, state * width + action)
    place = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    return np.where(known[place] == wanted, place, NEW)
