"""The states of a playback."""

from __future__ import annotations

from enum import Enum, auto
from typing import Final


class State(Enum):
    """What a playback is doing."""

    BUILDING = auto()
    """The world is built, and then the learner."""
    SEEKING = auto()
    """Runs are brought to another step; then it goes on."""
    TRAINING = auto()
    """An exact number of steps is taken, of which no snapshot shows anything; then it goes on."""
    REBUILDING = auto()
    """Learning waits for a large world that was edited, which is built in another thread; then it goes on."""
    UNTIL = auto()
    """It runs as fast as it goes until a condition holds."""
    RUNNING = auto()
    """It runs at the wanted speed."""
    PAUSED = auto()
    """It waits for commands."""
    SPENT = auto()
    """The budget is used up."""
    DONE = auto()
    """A planner has converged."""
    STOPPED = auto()
    """The run broke down."""


ENDED: Final = frozenset({State.SPENT, State.DONE, State.STOPPED})
"""The run shown takes no further step, unless something is changed."""

PASSING: Final = frozenset({State.SEEKING, State.TRAINING, State.REBUILDING})
"""After these a playback goes on with what it did before."""

SHOWN_AS_NEXT: Final = frozenset({State.TRAINING, State.REBUILDING})
"""Of these a snapshot tells what it goes on with afterwards."""

UNFINISHED: Final = frozenset({State.BUILDING, State.UNTIL, *PASSING})
"""Something that was asked for and has an end is not done yet."""

BUSY: Final = frozenset({State.BUILDING, State.TRAINING})
"""No command at all can be taken."""

LIVELY: Final = 30.0
"""Steps a second up to which every step is seen, and with it the trail of the episode."""


def shows_trail(state: State, speed: float | None) -> bool:
    """Return whether a playback in ``state`` shows the way that the agent went, at the wanted ``speed``."""
    if state is State.RUNNING:
        return speed is not None and speed <= LIVELY
    return state not in (State.UNTIL, *BUSY)
