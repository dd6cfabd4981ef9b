"""What playing asks of the interpreter, so that neither the learner nor a key waits for it."""

from __future__ import annotations

import gc
import sys
from typing import Final

# Whoever draws holds the interpreter for up to 5 ms before the learner, back from a kernel, may have it
# again. With less it loses less: measured, 5 % more steps a second beside a screen that draws a fifth of the
# time.
SWITCH_INTERVAL: Final = 0.0005
USUAL_SWITCH_INTERVAL: Final = sys.getswitchinterval()


# Whoever plays: of two players, one that is left may close after the next has begun
_PLAYERS: Final = set[int]()


def switch_often(player: object) -> None:
    """Let threads take turns ten times as often as usual, as long as ``player`` or another one plays."""
    _PLAYERS.add(id(player))
    sys.setswitchinterval(SWITCH_INTERVAL)


def leave_out_of_collections() -> None:
    """Spare the garbage collector all that is loaded by now.

    The libraries are some 200,000 objects. Looking through them stops every thread: measured, for up to
    88 ms, once a second beside a screen at full speed.
    """
    gc.unfreeze()  # what a player before left behind is to be found
    gc.collect()
    gc.freeze()


def as_usual(player: object) -> bool:
    """Undo both when the last player has ended; ``player`` has. Return whether it was the last."""
    _PLAYERS.discard(id(player))
    if _PLAYERS:
        return False
    sys.setswitchinterval(USUAL_SWITCH_INTERVAL)
    gc.unfreeze()
    return True
