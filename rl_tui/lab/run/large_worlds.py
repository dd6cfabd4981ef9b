"""Which worlds are too large to be copied whole for every frame."""

from __future__ import annotations

from typing import Final

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.world import World

MOST_COPIED: Final = 100_000


def is_large(world: World) -> bool:
    """Return whether copying all of Q and visits for each frame would be felt.

    Only maps are shown in parts: other drawings show every state.
    """
    return world.space.pairs > MOST_COPIED and isinstance(world.drawing, Grid)
