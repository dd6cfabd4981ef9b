"""All that is needed to come back to where a playground was: small, and free of arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

from rl_tui.lab.live.until import Breakpoints
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.timeline.branches import Branch


@dataclass(frozen=True, slots=True)
class LaneRecord:
    """One run: its recipe, every branch of it, and the number of the one in force; none before it begins."""

    recipe: Recipe
    branches: tuple[Branch, ...]
    branch: int = 0

    @property
    def step(self) -> int:
        """Where it stands."""
        return self.branches[self.branch].here if self.branches else 0


@dataclass(frozen=True, slots=True)
class Record:
    """The runs of a playground, at least one, the number of the one shown, and where they are to stop.

    ``speed`` is the wanted steps a second, None for as fast as it goes.
    """

    lanes: tuple[LaneRecord, ...]
    shown: int = 0
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    speed: float | None = None
