"""Results for pictures: mean curves, and cells of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Value = bool | int | float | str


@dataclass(frozen=True, slots=True)
class CurveTable:
    """The lists of `curve` in `train --runs --json`, with equal lengths."""

    name: str
    """Scenario and algorithm, or the name of the file."""
    columns: Mapping[str, Sequence[float | None]]
    runs: int | None
    """Number of runs in the mean, or None if unknown."""


@dataclass(frozen=True, slots=True)
class CellSpread:
    """The mean of a cell in one metric with its interval."""

    mean: float | None
    low: float | None
    """Lower end of the interval of the mean."""
    high: float | None
    is_of_all: bool = True
    """True if every run of the cell has a value."""
    is_restricted: bool = False
    """True if some runs never arrived, and count with their number of episodes."""


@dataclass(frozen=True, slots=True)
class SweepCell:
    """One combination of settings."""

    settings: Mapping[str, Value]
    spreads: Mapping[str, CellSpread]
    """Results by the names of the metrics."""
    like_best: bool | None
    """True if statistically tied with the best, or None if not tested."""


@dataclass(frozen=True, slots=True)
class SweepTable:
    """The cells of a sweep."""

    scenario: str
    """Name of the scenario, empty if several are swept."""
    names: tuple[str, ...]
    """Settings that vary."""
    logarithmic: frozenset[str]
    """Settings with values at equal ratios."""
    measures: Mapping[str, str]
    """Titles of the metrics by name."""
    judged_by: str
    """Metric that ranks the cells."""
    cells: Sequence[SweepCell]
    bests: Sequence[Mapping[str, Value]]
    """Settings of the best cell, for each world if several are swept."""
