"""The report of a world check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rl_tui.agents.exact.first_update import Wait
    from rl_tui.agents.exact.flips import Flip


class CheckStage(IntEnum):
    """Current stage of the computation, in order."""

    FIGURES = 0
    FLIPS = 1
    TRIALS = 2
    DONE = 3


@dataclass(frozen=True, slots=True)
class TrialsMade:
    """The extent of the trials, none (no `seeds`) if every policy ends.

    The algorithms `in_part` used up their steps early or broke down.
    """

    seeds: tuple[int, ...]
    episodes: int
    steps: int
    in_part: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class WorldReport:
    """Results so far. None means pending, or `unknown` with a reason."""

    stage: CheckStage = CheckStage.DONE
    trying: str = ""
    """Algorithm in training, or ""."""
    warnings: tuple[str, ...] = ()
    """Warnings with remedies, one line each."""
    unknown: Mapping[str, str] = field(default_factory=dict)
    random_return: float | None = None
    """Exact expected undiscounted return of the random policy within the time limit."""
    best_return: float | None = None
    """The same of the best policy, which may depend on the time."""
    shortest_way: int | None = None
    """Fewest steps in which the optimal policy for γ may end, within the time limit."""
    first_update: Wait | None = None
    """Wait for the first update with the current settings."""
    flips: tuple[Flip, ...] | None = None
    """Every γ at which the optimal actions change."""
    never_reached: tuple[int, ...] | None = None
    """States that no episode reaches."""
    endless_states: tuple[int, ...] | None = None
    """States from which no policy reaches a terminal state, empty with a time limit."""
    endless: tuple[str, ...] | None = None
    """Algorithms whose greedy policy may never end without a time limit, as far as tried."""
    tried: TrialsMade | None = None
    """Extent of the trials for `endless`, or None."""

    @property
    def is_empty(self) -> bool:
        """True if nothing is known for lack of a table."""
        return self.stage is CheckStage.DONE and self.never_reached is None and not self.unknown
