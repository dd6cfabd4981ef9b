"""The branches of a run: the first, and one more for each change made in its past."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.runs.recipe import JournalEntry, Recipe, WorldChange

if TYPE_CHECKING:
    from rl_tui.agents.learner_counters import Counters
    from rl_tui.runs.results import RunResults


@dataclass(frozen=True, slots=True)
class Branch:
    """A continuation of a run, described from step 0."""

    name: str
    """Name on screen."""
    journal: tuple[JournalEntry, ...] = ()
    """All changes. Those shared with the parent come first."""
    parent: int | None = None
    """Number of the parent branch, or None for the first."""
    fork: int = 0
    """Step at which it leaves its parent."""
    end: int = 0
    """Furthest step reached."""
    here: int = 0
    """Current step, or the step at which it was left."""


FIRST: Final = Branch("branch 1")
"""The branch on which every run begins."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Everything needed to restore the position of a run."""

    recipe: Recipe
    branches: tuple[Branch, ...] = (FIRST,)
    """All branches, at least one."""
    branch: int = 0
    """Number of the current branch."""

    @property
    def step(self) -> int:
        """Current step."""
        return self.branches[self.branch].here

    @property
    def world_changes(self) -> list[WorldChange]:
        """Edits of the world so far."""
        changes = (entry.change for entry in self.branches[self.branch].journal if entry.step <= self.step)
        return [change for change in changes if isinstance(change, WorldChange)]


class Furthest(NamedTuple):
    """The end of a branch."""

    counters: Counters
    """Steps and episodes there."""
    results: RunResults


@dataclass(frozen=True, slots=True, eq=False)
class Timeline:
    """The position of a moment among all branches."""

    branches: tuple[Branch, ...] = (Branch("1"),)
    """All branches in the order in which they began, at least one."""
    branch: int = 0
    """Number of the current branch, from 0."""
    furthest: Furthest | None = None
    """End of the current branch, or None if unknown, as in a loaded session."""

    @property
    def current(self) -> Branch:
        """The current branch."""
        return self.branches[self.branch]

    @property
    def in_past(self) -> bool:
        """True if the run has been further. A change then begins a branch."""
        return self.current.here < self.current.end
