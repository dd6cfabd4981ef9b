"""What of one world there is in another: which of its states and pairs are the same."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from rl_tui.worlds.editing.arms_draft import Draft
    from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, IntArray
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


class Keyed(NamedTuple):
    """States and actions of a space with what each is known by, [S] and [A]."""

    space: FiniteSpace
    states: IntArray | Sequence[Hashable]
    actions: Sequence[Hashable]


def carried(before: tuple[Draft, World], after: tuple[Draft, World]) -> Carried:
    """Return what the states and pairs of ``after`` were in ``before``: each a draft and its world."""
    (old_draft, old), (draft, world) = before, after
    return carried_by_keys(
        Keyed(old.space, old_draft.state_keys(old), old_draft.action_keys(old)),
        Keyed(world.space, draft.state_keys(world), draft.action_keys(world)),
    )


def carried_by_keys(old: Keyed, new: Keyed) -> Carried:
    """Return what the states and pairs of ``new`` were in ``old``: those of the same keys."""
    states = _numbers(old.states, new.states)
    actions = _numbers(old.actions, new.actions)
    return Carried(states, _pairs(old.space, new.space, states, actions))


def differing_choices(
    old: tuple[FiniteSpace, BoolArray], new: tuple[FiniteSpace, BoolArray], common: Carried
) -> BoolArray:
    """Return in which states of ``new``, [S], other pairs are chosen than in the same states of ``old``.

    Each is a space and the pairs, [P], that are chosen there. States that are new, or in which nothing can be
    done before or after, are none of them.
    """
    (was, chosen_before), (now, chosen) = old, new
    before = np.append(chosen_before, False)[common.pairs]  # NEW is the last one
    differs = np.zeros(now.states, dtype=np.bool_)
    differs[now.pair_state[before != chosen]] = True
    # some that were chosen may be gone
    kept = np.bincount(now.pair_state[before], minlength=now.states)
    had = np.bincount(was.pair_state[chosen_before], minlength=was.states)
    differs |= kept != np.append(had, 0)[common.states]
    acted = np.append(np.diff(was.first_pair) > 0, False)[common.states]
    return np.asarray(differs & acted & (np.diff(now.first_pair) > 0))


def _numbers(old: IntArray | Sequence[Hashable], new: IntArray | Sequence[Hashable]) -> IntArray:
    """Return where each of the ``new`` keys stands among the ``old`` ones, NEW for nowhere."""
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
    """Return what each pair of ``new`` was in ``old``."""
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
