"""The ways a run went on: the first one, and one more for each change that was made in its past."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rl_tui.lab.run.recipe import JournalEntry


@dataclass(frozen=True, slots=True)
class Branch:
    """One way a run went on, from step 0.

    ``journal`` is complete: what it shares with ``parent``, the number of the branch it was forked from (None
    for the first), comes first. ``fork`` is the step at which the two part, ``end`` the furthest step it has
    come to, and ``here`` the one at which it stands or was left.
    """

    name: str
    journal: tuple[JournalEntry, ...] = ()
    parent: int | None = None
    fork: int = 0
    end: int = 0
    here: int = 0


FIRST: Final = Branch("branch 1")
"""What every run begins on."""
