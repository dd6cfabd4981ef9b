"""The states of a playback."""

from __future__ import annotations

from enum import Enum, auto
from typing import Final


class State(Enum):
    """The activity of a playback."""

    BUILDING = auto()
    """The world is built, then the learner."""
    SEEKING = auto()
    """Runs move to another step; then it resumes."""
    TRAINING = auto()
    """It takes an exact number of steps without snapshots; then it resumes."""
    REBUILDING = auto()
    """Learning waits for a large edited world, built in another thread; then it resumes."""
    UNTIL = auto()
    """It runs at full speed until a condition is met."""
    RUNNING = auto()
    """It runs at the chosen speed."""
    PAUSED = auto()
    """It waits for commands."""
    SPENT = auto()
    """The budget is used up."""
    DONE = auto()
    """A planner has converged."""
    STOPPED = auto()
    """The run broke down."""


ENDED: Final = frozenset({State.SPENT, State.DONE, State.STOPPED})
"""The visible run has ended, unless something is changed."""

PASSING: Final = frozenset({State.SEEKING, State.TRAINING, State.REBUILDING})
"""Temporary states, after which the previous activity resumes."""

SHOWN_AS_NEXT: Final = frozenset({State.TRAINING, State.REBUILDING})
"""States in which snapshots report the next state."""

UNFINISHED: Final = frozenset({State.BUILDING, State.UNTIL, *PASSING})
"""A requested operation with an end is unfinished."""

BUSY: Final = frozenset({State.BUILDING, State.TRAINING})
"""No command can be handled."""

LIVELY: Final = 30.0
"""Steps per second up to which every step and its trail are shown."""


def shows_trail(state: State, speed: float | None) -> bool:
    """Return True if this `speed` shows the trail."""
    if state is State.RUNNING:
        return speed is not None and speed <= LIVELY
    return state not in (State.UNTIL, *BUSY)
