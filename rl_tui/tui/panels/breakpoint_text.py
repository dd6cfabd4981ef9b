"""What breakpoints are called in running text."""

from __future__ import annotations

from rl_tui.lab.live.until import Breakpoints
from rl_tui.tui.draw.names import pair_name, state_name
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.world import World

_MOST_LISTED = 6


def estimate_name(world: World, pair: int, glyphs: Glyphs) -> str:
    """Return ``Q(6,←)``, of a bandit ``Q(3)``."""
    return f"Q({pair_name(world, pair, glyphs)})"


def pair_in_words(world: World, pair: int, glyphs: Glyphs) -> str:
    """Return the pair as a place to stop at: ``6,←``; of a bandit ``arm 3``."""
    name = pair_name(world, pair, glyphs)
    return f"arm {name}" if isinstance(world.drawing, Arms) else name


def breakpoints_text(world: World, breakpoints: Breakpoints, glyphs: Glyphs) -> str:
    """Return all breakpoints in a line, states first: ``state 6; 4,←``; of many the first and a count."""
    listed = [f"state {state_name(world, state, glyphs)}" for state in sorted(breakpoints.states)]
    listed += [pair_in_words(world, pair, glyphs) for pair in sorted(breakpoints.pairs)]
    more = len(listed) - _MOST_LISTED
    return "; ".join(listed[:_MOST_LISTED]) + (f" and {more:,} more" if more > 0 else "")
