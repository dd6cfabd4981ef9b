"""The results of a settings map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from rl_tui.runs.measures import Measure


class AtlasState(StrEnum):
    """Progress of a settings map."""

    STARTING = "starting"  # no cell has a result yet
    RUNNING = "running"
    DONE = "done"  # every run of every cell
    OUT_OF_TIME = "out of time"  # the CPU-time limit is reached
    FAILED = "failed"  # see Atlas.message


@dataclass(frozen=True, slots=True)
class AtlasCell:
    """Results of the runs of one cell so far."""

    runs: int
    """Number of runs, including failed ones."""
    failed: int = 0
    figures: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """For each metric id the numbers in a sweep document: mean, median, low, high, count, …."""
    failure: str = ""
    """Why the first failed run broke down."""

    def value(self, measure: Measure) -> float | None:
        """Return the mean of `measure` (restricted if some runs never arrive), or None."""
        figures = self.figures.get(measure.id, {})
        found = figures.get("restricted_mean" if measure.may_never_arrive else "mean")
        return None if found is None else float(found)


@dataclass(frozen=True, slots=True)
class AtlasStandings:
    """Comparison of the cells by one metric."""

    best: int
    alike: frozenset[int]
    """Cells statistically tied with the best, including itself."""


@dataclass(frozen=True, slots=True)
class Atlas:
    """The results so far, by the cells' numbers in the plan."""

    state: AtlasState = AtlasState.STARTING
    cells: Mapping[int, AtlasCell] = field(default_factory=dict)
    impossible: Mapping[int, str] = field(default_factory=dict)
    """Reasons why the settings of a cell do not work together."""
    standings: Mapping[str, AtlasStandings] = field(default_factory=dict)
    """Comparison by each metric id, empty until all runs are done."""
    episodes: int | None = None
    """Episodes of each run, or None before the available time is known."""
    done: int = 0
    """Rows that are done or impossible. A row is one run of a cell."""
    planned: int = 0
    """Rows in all."""
    steps: int = 0
    message: str = ""
    """Reason for a failure or an early end in one line, usually empty."""

    @property
    def is_over(self) -> bool:
        """True if no further results will come."""
        return self.state not in (AtlasState.STARTING, AtlasState.RUNNING)
