"""Monte Carlo: at the end of an episode the cells taken in it move towards the returns that followed."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Final

import numpy as np

from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.updates.pair_solving import most_frequent, plainest
from rl_tui.lab.detective.updates.sample import EXACT
from rl_tui.lab.detective.updates.trial import FEWEST, FEWEST_INFORMATIVE, SHARE
from rl_tui.lab.detective.verdict import Rule, UpdateFound
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

_MOST_STEPS: Final = 40_000
_LONGEST: Final = 400
"""Longer episodes are left out."""
AT_ENDS: Final = 0.9
"""The share of changes that come at ends of episodes, of cells taken in them; others were seen late."""
_USUAL: Final = (1.0, 0.9, 0.95, 0.98, 0.99, 0.999)


def monte_carlo_update(evidence: Evidence, numbers: Mapping[str, float]) -> UpdateFound | None:
    """Return Monte Carlo's update if the returns of the episodes prove it, else None."""
    moved = evidence.changes_of > 0
    ends = evidence.terminated | evidence.truncated
    if not np.any(moved) or np.mean(ends[moved]) < AT_ENDS:
        return None
    used = evidence.learns & (np.arange(len(evidence)) < _MOST_STEPS)
    visits = _Visits(evidence, np.flatnonzero(used))
    if len(visits.old) < FEWEST or visits.inside < AT_ENDS:
        return None
    named = [each for each in numbers.values() if 0.0 < each <= 1.0]
    found = [(gamma, visits.step_size(gamma)) for gamma in dict.fromkeys((*named, *_USUAL))]
    held = [(gamma, size) for gamma, size in found if size is not None]
    if not held:
        return None
    gamma, size = held[0]
    return UpdateFound(
        Rule.MONTE_CARLO,
        alpha=None if size == 0.0 else plainest(size, numbers, evidence.precision),
        alpha_schedule="1/N" if size == 0.0 else "constant",
        gamma=gamma if len(held) == 1 else None,
        fits=visits.inside,
        informative=int(np.sum(visits.left > 0)),
    )


class _Visits:
    """The changes [m] of cells that their episode took exactly once, with the step that did.

    ``inside`` is the share of all changes whose cell was taken in their episode. ``left`` is the number of
    steps that followed the visit in its episode.
    """

    def __init__(self, evidence: Evidence, used: IntArray) -> None:
        self._reward = evidence.reward[used]
        self._exact = evidence.precision < EXACT
        episode, cells = evidence.episode[used], len(evidence.initial)
        self._order = np.lexsort((used, episode))
        lengths = np.unique(episode, return_counts=True)[1]
        self._left = np.empty(len(used), np.int64)
        ends = np.repeat(np.cumsum(lengths), lengths)
        self._left[self._order] = ends - 1 - np.arange(len(used))
        changes = evidence.changes
        step = np.clip(changes.step - evidence.number[0], 0, len(evidence) - 1)
        kept = np.isin(step, used)
        of_change = evidence.episode[step[kept]] * cells + changes.cell[kept]
        visited, first, count = np.unique(
            episode * cells + evidence.cell[used], return_index=True, return_counts=True
        )
        at = np.searchsorted(visited, of_change).clip(0, max(len(visited) - 1, 0))
        inside = visited[at] == of_change
        self.inside = float(np.mean(inside)) if len(inside) else 0.0
        once = inside & (count[at] == 1)
        self._at = first[at[once]]
        self.left: IntArray = self._left[self._at]
        self._cell = changes.cell[kept][once]
        self.old, self.new = changes.before[kept][once], changes.after[kept][once]
        self._again = np.ones(len(self._cell), np.bool_)  # a change of a cell that had changed before
        self._again[np.unique(self._cell, return_index=True)[1]] = False

    def step_size(self, gamma: float) -> float | None:
        """Return the constant step size towards the returns under ``gamma``, 0 for 1/N, None if neither."""
        distance = self._returns(gamma)[self._at] - self.old
        size = (self.new - self.old) / distance
        telling = np.isfinite(size) & (np.abs(distance) > 1e-6) & (self.left < _LONGEST)
        if np.sum(telling) < FEWEST or np.sum(telling & (self.left > 0)) < FEWEST_INFORMATIVE:
            return None
        near = 1e-6 if self._exact else 2e-3
        usual = most_frequent(size[telling][:, None], 5 if self._exact else 2, 1)
        if usual and np.mean(np.abs(size[telling] - usual[0][0]) <= near * abs(usual[0][0])) > SHARE:
            return usual[0][0] if np.sum(telling & self._again) >= FEWEST_INFORMATIVE else None
        return 0.0 if self._falls(size, telling, near) else None

    def _falls(self, size: FloatArray, telling: BoolArray, near: float) -> bool:
        """Return whether 1/size is a whole number that grows from each change of a cell to its next."""
        count = 1.0 / size
        whole = np.abs(count - np.rint(count)) <= near * np.maximum(1.0, np.abs(count))
        if np.mean((whole & (count > 0.5))[telling]) <= SHARE:
            return False
        places = np.flatnonzero(telling & whole)
        places = places[np.argsort(self._cell[places], kind="stable")]
        same = self._cell[places][1:] == self._cell[places][:-1]
        grown = np.diff(np.rint(count[places]))[same]
        return len(grown) >= FEWEST and bool(np.mean(grown >= 1) > SHARE)

    def _returns(self, gamma: float) -> FloatArray:
        """Return Σ γᵏ·reward from each step to the end of its episode, [used]; for the last steps of it."""
        result = self._reward.copy()
        by_left = np.argsort(self._left, kind="stable")
        left = self._left[by_left]
        next_of = np.empty(len(result), np.int64)
        next_of[self._order[:-1]] = self._order[1:]
        bounds = np.searchsorted(left, np.arange(min(_LONGEST, int(left[-1]) + 1 if len(left) else 0) + 1))
        for low, high in pairwise(bounds[1:]):
            at = by_left[low:high]
            result[at] += gamma * result[next_of[at]]
        return result
