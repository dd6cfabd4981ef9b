"""The states and pairs that two worlds share."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from rl_tui.worlds.editing.arms_draft import Draft
    from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, IntArray
    from rl_tui.worlds.world import World

NEW: Final = -1
"""Marks a state or pair that did not exist before."""


class Carried(NamedTuple):
    """Former number of each state, [S], and pair, [P], or NEW."""

    states: IntArray
    pairs: IntArray

    def states_now(self, before: Collection[int]) -> frozenset[int]:
        """Return the current numbers of former states, without removed ones."""
        return frozenset(np.flatnonzero(np.isin(self.states, list(before))).tolist())

    def pairs_now(self, before: Collection[int]) -> frozenset[int]:
        """Return the current numbers of former pairs, without removed ones."""
        return frozenset(np.flatnonzero(np.isin(self.pairs, list(before))).tolist())


class Keyed(NamedTuple):
    """A space with identities of states, [S], and actions, [A]."""

    space: FiniteSpace
    states: IntArray | Sequence[Hashable]
    actions: Sequence[Hashable]


def carried(before: tuple[Draft, World], after: tuple[Draft, World]) -> Carried:
    """Match two worlds, each given with its draft."""
    (old_draft, old), (draft, world) = before, after
    return carried_by_keys(
        Keyed(old.space, old_draft.state_keys(old), old_draft.action_keys(old)),
        Keyed(world.space, draft.state_keys(world), draft.action_keys(world)),
    )


def carried_by_keys(old: Keyed, new: Keyed) -> Carried:
    """Match two spaces by equal identities."""
    states = _numbers(old.states, new.states)
    actions = _numbers(old.actions, new.actions)
    return Carried(states, _pairs(old.space, new.space, states, actions))


def differing_choices(
    old: tuple[FiniteSpace, BoolArray], new: tuple[FiniteSpace, BoolArray], common: Carried
) -> BoolArray:
    """Return the states of `new`, [S], that existed before and where other pairs are chosen, [P].

    States without pairs, before or after, are False.
    """
    (was, chosen_before), (now, chosen) = old, new
    before = np.append(chosen_before, False)[common.pairs]  # index NEW (−1) reads the appended False
    differs = np.zeros(now.states, dtype=np.bool_)
    differs[now.pair_state[before != chosen]] = True
    # chosen pairs may have been removed
    kept = np.bincount(now.pair_state[before], minlength=now.states)
    had = np.bincount(was.pair_state[chosen_before], minlength=was.states)
    differs |= kept != np.append(had, 0)[common.states]
    acted = np.append(np.diff(was.first_pair) > 0, False)[common.states]
    return np.asarray(differs & acted & (np.diff(now.first_pair) > 0))


def _numbers(old: IntArray | Sequence[Hashable], new: IntArray | Sequence[Hashable]) -> IntArray:
    if isinstance(old, np.ndarray) and isinstance(new, np.ndarray):
        if np.array_equal(old, new):
            return np.arange(len(new))
        order = np.argsort(old, kind="stable")
        place = np.searchsorted(old, new, sorter=order)
        found: IntArray = order[np.minimum(place, len(old) - 1)]
        return np.where(old[found] == new, found, NEW)
    number_of = {key: number for number, key in enumerate(old)}
    return np.array([number_of.get(key, NEW) for key in new], dtype=np.int64)


def _pairs(old: FiniteSpace, new: FiniteSpace, states: IntArray, actions: IntArray) -> IntArray:
    same = (
        (states, np.arange(old.states)),
        (actions, np.arange(len(old.action_names))),
        (old.first_pair, new.first_pair),
        (old.pair_action, new.pair_action),
    )
    if all(np.array_equal(one, other) for one, other in same):
        return np.arange(new.pairs)
    owner = np.repeat(np.arange(new.states), np.diff(new.first_pair))
    state, action = states[owner], actions[new.pair_action]
    width = len(old.action_names)
    known = np.repeat(np.arange(old.states), np.diff(old.first_pair)) * width + old.pair_action
    wanted = np.where((state == NEW) | (action == NEW), NEW, state * width + action)
    place = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    return np.where(known[place] == wanted, place, NEW)
