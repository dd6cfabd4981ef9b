"""What a world was found to be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rl_tui.agents.exact.first_update import Wait
    from rl_tui.agents.exact.flips import Flip


class CheckStage(IntEnum):
    """What is worked out now, in this order."""

    FIGURES = 0
    FLIPS = 1
    TRIALS = 2
    DONE = 3


@dataclass(frozen=True, slots=True)
class TrialsMade:
    """How much was trained of each algorithm: under these ``seeds``, so many episodes, at most so many steps.

    No ``seeds``: none was needed, since each policy ends. Those ``in_part`` had more episodes to go when
    their steps were used up, or broke down: what they learn later is not known.
    """

    seeds: tuple[int, ...]
    episodes: int
    steps: int
    in_part: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class WorldReport:
    """What an author wants to know of a world, as far as it is worked out.

    None is what is not worked out yet, or not known: then ``unknown`` says why, by the name of the field.
    """

    stage: CheckStage = CheckStage.DONE
    """What is worked out now."""
    trying: str = ""
    """The algorithm that is trained now; empty where none is."""
    warnings: tuple[str, ...] = ()
    """What is doubtful of the world, and what to do, a line each."""
    unknown: Mapping[str, str] = field(default_factory=dict)
    """Why something is not known."""
    random_return: float | None = None
    """The exact expected return of the uniformly random policy, undiscounted, within the time limit."""
    best_return: float | None = None
    """That of the best policy, which may look at the clock."""
    shortest_way: int | None = None
    """The fewest steps in which the best policy for γ may come to an end, within the time limit."""
    first_update: Wait | None = None
    """The wait for the first update that tells anything, with the settings in force."""
    flips: tuple[Flip, ...] | None = None
    """Every γ at which the optimal actions change."""
    never_reached: tuple[int, ...] | None = None
    """The states that no episode comes to."""
    endless_states: tuple[int, ...] | None = None
    """The states from which no policy can reach an end; none where there is a time limit."""
    endless: tuple[str, ...] | None = None
    """The algorithms of which a greedy policy may never end, the time limit left aside, as far as tried."""
    tried: TrialsMade | None = None
    """How ``endless`` was found; None where it was not."""

    @property
    def is_empty(self) -> bool:
        """Whether nothing at all is known, the world having no table."""
        return self.stage is CheckStage.DONE and self.never_reached is None and not self.unknown
