"""Why a learner came back from learning."""

from __future__ import annotations

from enum import IntEnum
from typing import Final

LARGEST_ESTIMATE: Final = 1e12
LONGEST_EPISODE: Final = 10_000_000


class Stop(IntEnum):
    """Why the loop came back."""

    DONE = 0  # the steps or episodes that were asked for
    EPISODES_FULL = 1  # the episode log is full: drain it and go on
    DIVERGED = 2  # an estimate left ±1e12 or is not a number
    ENDLESS_EPISODE = 3  # an episode went beyond 10⁷ steps
    MEMORY_FULL = 4  # an episode is longer than the algorithm can remember
    CONVERGED = 5  # a planner is done
    WORLD_FAILED = 6  # the environment that is stepped broke down
    NOTICED = 7  # something that is watched for came about in the last step


# As numbers, for compiled code
DONE: Final = Stop.DONE.value
EPISODES_FULL: Final = Stop.EPISODES_FULL.value
DIVERGED: Final = Stop.DIVERGED.value
ENDLESS_EPISODE: Final = Stop.ENDLESS_EPISODE.value
MEMORY_FULL: Final = Stop.MEMORY_FULL.value
CONVERGED: Final = Stop.CONVERGED.value
NOTICED: Final = Stop.NOTICED.value
