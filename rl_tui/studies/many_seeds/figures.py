"""Results of the visible runs under many seeds, so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray, IntArray


class StudyState(StrEnum):
    """Progress of a study."""

    STARTING = "starting"  # no results yet
    RUNNING = "running"
    DONE = "done"  # all wanted seeds
    OUT_OF_TIME = "out of time"  # the CPU-time limit is reached
    FAILED = "failed"  # see SeedStudy.message
    REFUSED = "refused"  # not possible for these runs, see SeedStudy.message


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over seeds, with its standard error (n − 1), None for fewer than two."""

    mean: float
    stderr: float | None
    count: int
    """Number of seeds with a value."""


@dataclass(frozen=True, slots=True)
class PairedDifference:
    """The visible run minus another one, seed by seed."""

    mean: Estimate
    greater: int
    """Number of seeds in which the visible run has the larger value."""
    equal: int
    """Number of seeds with equal values."""


@dataclass(frozen=True, slots=True, eq=False)
class SeedCurve:
    """The mean return per episode over seeds in B bins."""

    episode: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    """Last episode of each bin, from 1, `[B]`."""
    mean: FloatArray = field(default_factory=lambda: np.empty(0))
    stderr: FloatArray = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, slots=True, eq=False)
class LaneStudy:
    """One run under many seeds, with names as in `train --runs --json`."""

    estimates: Mapping[str, Estimate]
    """Each number over the finished seeds, as in the document's `summary`."""
    this_seed: Mapping[str, float | None]
    """The same numbers for the first seed, which is that of the visible run."""
    differences: Mapping[str, PairedDifference] = field(default_factory=dict)
    """The visible run minus this one by number, empty for the visible run."""
    curve: SeedCurve = field(default_factory=SeedCurve)
    seeds: Mapping[str, FloatArray] = field(default_factory=dict)
    """Each figure of every seed that has it."""


@dataclass(frozen=True, slots=True, eq=False)
class SeedStudy:
    """A study of the visible runs under many seeds."""

    state: StudyState
    lanes: tuple[LaneStudy, ...] = ()
    """One for each run at the beginning of the study, empty without results."""
    shown: int = 0
    """Index of the visible run at the beginning. Differences refer to it."""
    seeds: int = 0
    """Seeds finished in every run: 8, 16, 32, …, 256, or fewer than 8 if time ran out."""
    most: int = 0
    """Number of seeds to reach."""
    episodes: int | None = None
    """Episodes of each seed, or None if `steps` end a run."""
    steps: int | None = None
    """Steps of each seed, or None."""
    message: str = ""
    """Why the study is limited or missing, usually empty."""
    how_long: str = ""
    """Time left, or a note that the machine is busy, empty if unknown."""
    is_outdated: bool = False
    """True if the runs have changed since."""

    @property
    def is_over(self) -> bool:
        """True if no further results will come."""
        return self.state not in (StudyState.STARTING, StudyState.RUNNING)
