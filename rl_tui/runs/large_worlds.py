"""Which worlds are too large to be copied whole for every frame, or built while somebody waits."""

from __future__ import annotations

from typing import Final

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.world import World

MOST_COPIED: Final = 100_000
# About what is built within a tenth of a second
MOST_STATES_AT_ONCE: Final = 20_000
MOST_OUTCOMES_AT_ONCE: Final = 500_000


def is_large(world: World) -> bool:
    """Return whether copying all of Q and visits for each frame would be felt.

    Only maps are shown in parts: other drawings show every state.
    """
    return world.space.pairs > MOST_COPIED and isinstance(world.drawing, Grid)


def takes_long(draft: Draft, before: World) -> bool:
    """Return whether it would be felt to wait for the world of ``draft``, which ``before`` becomes."""
    outcomes = 0 if before.mdp is None else len(before.mdp.next_state)
    states = max(draft.size, before.space.states)
    return states > MOST_STATES_AT_ONCE or outcomes > MOST_OUTCOMES_AT_ONCE
