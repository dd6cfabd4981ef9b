"""All that is needed to come back to where one run was: small, and free of arrays."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.timeline.branches import Branch


@dataclass(frozen=True, slots=True)
class RunRecord:
    """One run of a playground, to be made again from its seed."""

    recipe: Recipe
    """What the run was made from."""
    branches: tuple[Branch, ...]
    """Every branch of it; none before it begins."""
    branch: int = 0
    """The number of the branch in force."""

    @property
    def step(self) -> int:
        """Where the run stands."""
        return self.branches[self.branch].here if self.branches else 0
