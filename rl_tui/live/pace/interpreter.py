"""Interpreter settings that keep the learner and the keys responsive."""

from __future__ import annotations

import gc
import sys
from typing import Final

# By default a drawing thread holds the interpreter for up to 5 ms before the learner, back from a kernel,
# gets it again. This value brought 5 % more steps per second beside a screen that draws a fifth of the time
SWITCH_INTERVAL: Final = 0.0005
USUAL_SWITCH_INTERVAL: Final = sys.getswitchinterval()
# with two players, one may close after the other has begun
_PLAYERS: Final = set[int]()


def switch_often(player: object) -> None:
    """Let threads switch ten times as often for a player."""
    _PLAYERS.add(id(player))
    sys.setswitchinterval(SWITCH_INTERVAL)


def leave_out_of_collections() -> None:
    """Exclude all loaded objects from garbage collection.

    The libraries are about 200,000 objects; scanning them stops every thread for up to 88 ms, once a second
    at full speed (measured).
    """
    gc.unfreeze()  # collect what an earlier player left behind
    gc.collect()
    gc.freeze()


def as_usual(player: object) -> bool:
    """Remove `player`. Restore both settings and return True after the last."""
    _PLAYERS.discard(id(player))
    if _PLAYERS:
        return False
    sys.setswitchinterval(USUAL_SWITCH_INTERVAL)
    gc.unfreeze()
    return True
