"""What a run has achieved so far: returns of its episodes, and how good its greedy policy is."""

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
    """Finished episodes in B bins of equal width, oldest first; the last bin may be part-filled."""

    episode: IntArray = field(default_factory=_no_counts)
    """[B], the last episode (from 1) in the bin."""
    return_mean: FloatArray = field(default_factory=_no_numbers)
    """[B], the mean undiscounted return."""
    return_low: FloatArray = field(default_factory=_no_numbers)
    """[B], the lowest undiscounted return."""
    return_high: FloatArray = field(default_factory=_no_numbers)
    """[B], the highest undiscounted return."""
    length_mean: FloatArray = field(default_factory=_no_numbers)
    """[B], the mean length in steps."""
    samples: FloatArray = field(default_factory=_no_numbers)
    """[S], the undiscounted returns of the first episode and of every so many-th after it, for quartiles."""
    sample_every: int = 1
    """The distance of two samples in episodes: a power of two, at most an eighth of a bin, or 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Exact evaluations of the greedy policy at M steps, which depend on the step number only."""

    step: IntArray = field(default_factory=_no_counts)
    """[M], how many steps had been taken."""
    episode: IntArray = field(default_factory=_no_counts)
    """[M], how many episodes had ended."""
    expected_return: FloatArray = field(default_factory=_no_numbers)
    """[M], the exact expected undiscounted return; NaN where the policy has none."""


@dataclass(frozen=True, slots=True, eq=False)
class RunResults:
    """What a run has achieved at one step."""

    curve: Curve = field(default_factory=Curve)
    """Return and length of all finished episodes, in bins."""
    marks: Marks = field(default_factory=Marks)
    """The exact returns of the greedy policy on the way."""
    return_last_100: float | None = None
    """Mean return of the last 100 episodes, or of as many as there are; None before the first has ended."""
    length_last_100: float | None = None
    """Mean length of the last 100 episodes in steps; None before the first has ended."""
    greedy_return: float | None = None
    """Exact expected undiscounted return of the greedy policy of Q; None if it has none or it is too dear."""
    greedy_ends: float | None = None
    """Where that policy has no return: the probability (0 to 1) that an episode of it ends; else None."""
    bandit: BanditFigures | None = None
    """How the pulls of a bandit were spent; None where the world is no bandit."""
    behaviour_return: float | None = None
    """As ``greedy_return``, of the agent as it acts in this episode; None where it explores not by an ε.

    None also in worlds in which it is not worked out quickly.
    """
