"""Results of a run so far."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray, IntArray

if TYPE_CHECKING:
    from rl_tui.runs.bandit import BanditFigures


def _no_numbers() -> FloatArray:
    return np.empty(0)


def _no_counts() -> IntArray:
    return np.empty(0, np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Finished episodes in B bins of equal width, the last perhaps partly filled."""

    episode: IntArray = field(default_factory=_no_counts)
    """Last episode (from 1) in each bin, `[B]`."""
    return_mean: FloatArray = field(default_factory=_no_numbers)
    """Mean undiscounted return, `[B]`."""
    return_low: FloatArray = field(default_factory=_no_numbers)
    """Lowest undiscounted return, `[B]`."""
    return_high: FloatArray = field(default_factory=_no_numbers)
    """Highest undiscounted return, `[B]`."""
    length_mean: FloatArray = field(default_factory=_no_numbers)
    """Mean length in steps, `[B]`."""
    samples: FloatArray = field(default_factory=_no_numbers)
    """Undiscounted returns of evenly spaced episodes, beginning with the first, `[S]`, for quartiles."""
    sample_every: int = 1
    """Distance between two samples in episodes: a power of two, at most an eighth of a bin, or 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Exact evaluations of the greedy policy at M steps."""

    step: IntArray = field(default_factory=_no_counts)
    """Steps taken, `[M]`."""
    episode: IntArray = field(default_factory=_no_counts)
    """Episodes finished, `[M]`."""
    expected_return: FloatArray = field(default_factory=_no_numbers)
    """Exact expected undiscounted return, `[M]`, or NaN if the policy has none."""


@dataclass(frozen=True, slots=True, eq=False)
class RunResults:
    """Results of a run at one step."""

    curve: Curve = field(default_factory=Curve)
    """Returns and lengths of all finished episodes, in bins."""
    marks: Marks = field(default_factory=Marks)
    """Exact returns of the greedy policy at earlier steps."""
    return_last_100: float | None = None
    """Mean return of the last 100 episodes or fewer, or None before the first has ended."""
    length_last_100: float | None = None
    """Mean length of the last 100 episodes or fewer, in steps, or None before the first has ended."""
    greedy_return: float | None = None
    """Exact expected undiscounted return of the greedy policy, or None if it has none or takes too long."""
    greedy_ends: float | None = None
    """If the greedy policy has no return: the probability (0 to 1) that its episodes end, else None."""
    bandit: BanditFigures | None = None
    """Regret and pulls of a bandit, else None."""
    first_reward_episode: int = 0
    """First episode (from 1) with a non-zero reward; 0 before it, and where only the curve knows."""
    behaviour_return: float | None = None
    """Exact expected return of the agent in this episode. None if it does not explore by ε, or if the
    evaluation is slow.
    """
