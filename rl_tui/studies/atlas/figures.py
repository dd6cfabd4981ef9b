"""What an atlas knows by now: the figures of its cells, and which of them cannot be told from the best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from rl_tui.runs.measures import Measure


class AtlasState(StrEnum):
    """How far an atlas has come."""

    STARTING = "starting"  # no cell is there yet
    RUNNING = "running"
    DONE = "done"  # every run of every cell
    OUT_OF_TIME = "out of time"  # the processor time that it may take is used up
    FAILED = "failed"  # Atlas.message says why


@dataclass(frozen=True, slots=True)
class AtlasCell:
    """What the runs of one cell say together, those that are there."""

    runs: int
    """How many there are, those that broke down among them."""
    failed: int = 0
    """How many broke down."""
    figures: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """For each measure, by its id, what a document of a sweep has: mean, median, low, high, count …"""
    failure: str = ""
    """Why the first of them broke down."""

    def value(self, measure: Measure) -> float | None:
        """Return by what the cell is judged: the mean of ``measure``, None where no run has it.

        Where some runs never arrive it is the mean of arrival or the end of training, whichever comes first.
        """
        figures = self.figures.get(measure.id, {})
        found = figures.get("restricted_mean" if measure.may_never_arrive else "mean")
        return None if found is None else float(found)


@dataclass(frozen=True, slots=True)
class AtlasStandings:
    """How the cells compare by one measure."""

    best: int
    """The number of the best cell."""
    alike: frozenset[int]
    """The cells that cannot be told from the best, itself among them."""


@dataclass(frozen=True, slots=True)
class Atlas:
    """All that is known. Cells have their numbers in the plan: the last setting runs fastest."""

    state: AtlasState = AtlasState.STARTING
    cells: Mapping[int, AtlasCell] = field(default_factory=dict)
    """The cells that have a run already."""
    impossible: Mapping[int, str] = field(default_factory=dict)
    """Why cells cannot be: their settings do not work together."""
    standings: Mapping[str, AtlasStandings] = field(default_factory=dict)
    """By the id of a measure; empty while there are runs to come."""
    episodes: int | None = None
    """Episodes of each run, once it is known how many there is time for."""
    done: int = 0
    """Rows, a row is one run of a cell, that are there, or will never be."""
    planned: int = 0
    """Rows in all."""
    steps: int = 0
    """Steps that were taken."""
    message: str = ""
    """Why it failed or ends early, in one line; mostly empty."""

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come."""
        return self.state not in (AtlasState.STARTING, AtlasState.RUNNING)
