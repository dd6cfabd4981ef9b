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


def switch_often() -> None:
    """Let threads take turns twenty times as often as usual."""
    sys.setswitchinterval(SWITCH_INTERVAL)


def switch_as_usual() -> None:
    """Undo :func:`switch_often`."""
    sys.setswitchinterval(USUAL_SWITCH_INTERVAL)


def leave_out_of_collections() -> None:
    """Spare the garbage collector all that is loaded by now.

    The libraries are some 200,000 objects. Looking through them stops every thread: measured, for up to
    88 ms, once a second beside a screen at full speed.
    """
    gc.collect()
    gc.freeze()


def take_into_collections() -> None:
    """Undo :func:`leave_out_of_collections`, so that what is no longer used is found."""
    gc.unfreeze()
