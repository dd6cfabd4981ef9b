"""Results as they are drawn: the mean curves of runs, and the cells of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Value = bool | int | float | str
"""A value of a setting."""


@dataclass(frozen=True, slots=True)
class CurveTable:
    """A mean learning curve: the lists of ``curve`` in ``train --runs --json``, all of one length."""

    name: str
    """What it is of: scenario and algorithm, or the name of its file."""
    columns: Mapping[str, Sequence[float | None]]
    runs: int | None
    """Over how many runs it is the mean; None where nothing says so."""


@dataclass(frozen=True, slots=True)
class CellSpread:
    """What the runs of a cell come to in one measure; None where that has no value."""

    mean: float | None
    low: float | None
    """The ends of the interval of the mean."""
    high: float | None
    is_of_all: bool = True
    """Whether every run of the cell has a value."""
    is_restricted: bool = False
    """Whether some runs never arrived, and count with the episodes that they had."""


@dataclass(frozen=True, slots=True)
class SweepCell:
    """One combination of settings."""

    settings: Mapping[str, Value]
    spreads: Mapping[str, CellSpread]
    """By the names of the measures."""
    like_best: bool | None
    """Whether it could not be told from the best; None where nothing says so."""


@dataclass(frozen=True, slots=True)
class SweepTable:
    """The cells of a sweep."""

    scenario: str
    """Empty where several are swept."""
    names: tuple[str, ...]
    """The settings that it varies."""
    logarithmic: frozenset[str]
    """Those whose values stand at equal ratios."""
    measures: Mapping[str, str]
    """The titles of the measures by their names."""
    judged_by: str
    """The measure by which cells are compared with the best."""
    cells: Sequence[SweepCell]
    bests: Sequence[Mapping[str, Value]]
    """The settings of the best cell, of each world where several are swept."""
