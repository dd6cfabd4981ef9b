"""What many seeds say of the runs on screen: means with their errors, as far as they are worked out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray, IntArray


class StudyState(StrEnum):
    """How far a study has come."""

    STARTING = "starting"  # nothing is there yet
    RUNNING = "running"
    DONE = "done"  # all seeds that were wanted
    OUT_OF_TIME = "out of time"  # the processor time that it may take is used up
    FAILED = "failed"  # SeedStudy.message says why
    REFUSED = "refused"  # these runs have nothing to be worked out; SeedStudy.message says why


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over seeds. ``stderr`` is its standard error (of n − 1), None for fewer than two seeds."""

    mean: float
    stderr: float | None
    count: int
    """The seeds that have this figure."""


@dataclass(frozen=True, slots=True)
class PairedDifference:
    """The lane shown less another one, seed by seed: both had the same seeds."""

    mean: Estimate
    greater: int
    """In how many seeds the lane shown has the greater figure."""
    equal: int
    """In how many both have the same."""


@dataclass(frozen=True, slots=True, eq=False)
class SeedCurve:
    """The mean return per episode over seeds, in bins, [B] each; all empty where there is none."""

    episode: IntArray = field(default_factory=lambda: np.empty(0, np.int64))
    """The last episode of each bin, from 1."""
    mean: FloatArray = field(default_factory=lambda: np.empty(0))
    stderr: FloatArray = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, slots=True, eq=False)
class LaneStudy:
    """One lane under many seeds. Figures have the names that ``train --runs --json`` gives them."""

    estimates: Mapping[str, Estimate]
    """Each figure over the seeds that are done, as in the document's ``summary``."""
    this_seed: Mapping[str, float | None]
    """The same figures of the first seed, which is that of the run on screen."""
    differences: Mapping[str, PairedDifference] = field(default_factory=dict)
    """The lane that was shown less this one, by figure; empty for that lane itself."""
    curve: SeedCurve = field(default_factory=SeedCurve)
    seeds: Mapping[str, FloatArray] = field(default_factory=dict)
    """Each figure of every seed that has it."""


@dataclass(frozen=True, slots=True, eq=False)
class SeedStudy:
    """A study of the runs on screen under many seeds, as far as it has come."""

    state: StudyState
    lanes: tuple[LaneStudy, ...] = ()
    """One for each lane when the study began, one where there was one run; empty while nothing is there."""
    shown: int = 0
    """Which of them was shown when it began; differences are from it."""
    seeds: int = 0
    """How many seeds are done in every lane: 8, 16, 32 … 256; fewer than 8 where time was up before."""
    most: int = 0
    """How many seeds it is to come to."""
    episodes: int | None = None
    """Episodes of each seed; None where it is ``steps`` that end a run."""
    steps: int | None = None
    """Steps of each seed, where they end it."""
    message: str = ""
    """Why it is bounded as it is, or why there is none; mostly empty."""
    how_long: str = ""
    """How long the rest takes, or that the machine is busy; empty where neither is known."""
    is_outdated: bool = False
    """Whether runs have been changed since it began, so that it tells of other ones."""

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come."""
        return self.state not in (StudyState.STARTING, StudyState.RUNNING)
