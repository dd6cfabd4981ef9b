"""Limits for worlds that are slow to copy or to build."""

from __future__ import annotations

from typing import Final

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.world import World

MOST_COPIED: Final = 100_000
# about what can be built within a tenth of a second
MOST_STATES_AT_ONCE: Final = 20_000
MOST_OUTCOMES_AT_ONCE: Final = 500_000


def is_large(world: World) -> bool:
    """Return True for a map whose Q is too large to copy for a frame."""
    return world.space.pairs > MOST_COPIED and isinstance(world.drawing, Grid)


def takes_long(draft: Draft, before: World) -> bool:
    """Return True if building `draft` takes a noticeable time."""
    outcomes = 0 if before.mdp is None else len(before.mdp.next_state)
    states = max(draft.size, before.space.states)
    return states > MOST_STATES_AT_ONCE or outcomes > MOST_OUTCOMES_AT_ONCE
