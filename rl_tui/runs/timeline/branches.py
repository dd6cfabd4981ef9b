"""The branches of a run: the first one, and one more for each change that was made in its past."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.runs.recipe import JournalEntry, Recipe, WorldChange

if TYPE_CHECKING:
    from rl_tui.agents.learner_counters import Counters
    from rl_tui.runs.results import RunResults


@dataclass(frozen=True, slots=True)
class Branch:
    """One way a run went on, from step 0."""

    name: str
    """What it is called on screen."""
    journal: tuple[JournalEntry, ...] = ()
    """All that was changed; what it shares with its parent comes first."""
    parent: int | None = None
    """The number of the branch it was forked from, None for the first."""
    fork: int = 0
    """The step at which it parts from its parent."""
    end: int = 0
    """The furthest step it has come to."""
    here: int = 0
    """The step at which it stands, or was left."""


FIRST: Final = Branch("branch 1")
"""What every run begins on."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """All that is needed to come back to where a run was: small, and free of arrays."""

    recipe: Recipe
    """What the run was made from."""
    branches: tuple[Branch, ...] = (FIRST,)
    """Every branch of it, at least one."""
    branch: int = 0
    """The number of the branch in force."""

    @property
    def step(self) -> int:
        """Where the run stands."""
        return self.branches[self.branch].here

    @property
    def world_changes(self) -> list[WorldChange]:
        """What made the world what it is where the run stands."""
        changes = (entry.change for entry in self.branches[self.branch].journal if entry.step <= self.step)
        return [change for change in changes if isinstance(change, WorldChange)]


class Furthest(NamedTuple):
    """What a branch had reached at its end."""

    counters: Counters
    """Its steps and episodes."""
    results: RunResults
    """Its returns."""


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """Where a moment stands in time."""

    branches: tuple[Branch, ...] = (Branch("1"),)
    """All branches, in the order in which they began; at least one."""
    branch: int = 0
    """The place of the one in force, from 0."""
    furthest: Furthest | None = None
    """What that one had reached at its end, None where that is not known, as in a session that was loaded."""

    @property
    def current(self) -> Branch:
        """The branch in force."""
        return self.branches[self.branch]

    @property
    def in_past(self) -> bool:
        """Whether the run has been further than here: to change something now forks it."""
        return self.current.here < self.current.end
