"""The Monte Carlo update, found from the returns of episodes, and which visits of a pair it counts."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np

from rl_tui.programs.diagnosis.sample import EXACT
from rl_tui.programs.diagnosis.trial import FEWEST, FEWEST_INFORMATIVE, SHARE, most_frequent, plainest
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CountedVisits, Rule, UpdateFound
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

AT_ENDS: Final = 0.9
"""Share of changes at ends of episodes, in cells taken there."""
_MOST_STEPS: Final = 40_000
_LONGEST: Final = 400
_USUAL: Final = (1.0, 0.9, 0.95, 0.98, 0.99, 0.999)
_TELLING: Final = 1e-6
"""Least distance of an estimate from a return that counts."""
_LEAST: Final = 1e-7
"""Least change relative to the estimate that determines a number of returns."""


def monte_carlo_update(evidence: Evidence) -> UpdateFound | None:
    """Return the Monte Carlo update, if returns prove it."""
    moved = evidence.changes_of > 0
    if not np.any(moved) or np.mean(evidence.ends[moved]) < AT_ENDS:
        return None
    used = evidence.learns & (np.arange(len(evidence)) < _MOST_STEPS)
    episodes = _Episodes(evidence, np.flatnonzero(used))
    if np.sum(episodes.once) < FEWEST or episodes.inside < AT_ENDS:
        return None
    named = [each for each in evidence.numbers.values() if 0.0 < each <= 1.0]
    found = [(gamma, episodes.step_size(gamma)) for gamma in dict.fromkeys((*named, *_USUAL))]
    held = [(gamma, size) for gamma, size in found if size is not None]
    if not held:
        return None
    counted = {episodes.counted_visits(*each) for each in held} - {None}
    gamma, size = held[0]
    return UpdateFound(
        Rule.MONTE_CARLO,
        alpha=None if size == 0.0 else plainest(size, evidence),
        alpha_schedule="1/N" if size == 0.0 else "constant",
        gamma=gamma if len(held) == 1 else None,
        fits=episodes.inside,
        informative=int(np.sum(episodes.left[episodes.once] > 0)),
        visits=counted.pop() if len(counted) == 1 else None,
    )


class _Episodes:
    """The m changes of cells that were taken in their episode. `once`, `[m]`, is True for those taken once.
    `left`, `[m]`, counts the steps after the first visit, and `inside` is the share of changes in cells of
    their episode.
    """

    def __init__(self, evidence: Evidence, used: IntArray) -> None:
        self._reward = evidence.reward[used]
        self._near = 1e-6 if evidence.precision < EXACT else 2e-3
        self._digits = 5 if evidence.precision < EXACT else 2
        episode, cells = evidence.episode[used], len(evidence.initial)
        self._order = np.lexsort((used, episode))
        lengths = np.unique(episode, return_counts=True)[1]
        self._left = np.empty(len(used), np.int64)
        ends = np.repeat(np.cumsum(lengths), lengths)
        self._left[self._order] = ends - 1 - np.arange(len(used))
        taken = episode * cells + evidence.cell[used]
        self._by_pair = np.argsort(taken, kind="stable")  # the visits of each episode and cell, oldest first
        visited, begins, count = np.unique(taken[self._by_pair], return_index=True, return_counts=True)
        changes = evidence.changes
        step = np.clip(changes.step - evidence.number[0], 0, len(evidence) - 1)
        kept = np.isin(step, used)
        of_change = evidence.episode[step[kept]] * cells + changes.cell[kept]
        at = np.searchsorted(visited, of_change).clip(0, max(len(visited) - 1, 0))
        inside = visited[at] == of_change
        self.inside = float(np.mean(inside)) if len(inside) else 0.0
        self._begins, self._pair = begins, at[inside]
        self._begin, self._count = begins[self._pair], count[self._pair]
        self.once: BoolArray = self._count == 1
        self.left: IntArray = self._left[self._by_pair[self._begin]]
        self._cell = changes.cell[kept][inside]
        self._old, self._new = changes.before[kept][inside], changes.after[kept][inside]
        self._again = np.ones(len(self._cell), np.bool_)  # a change of a cell that had changed before
        self._again[np.unique(self._cell, return_index=True)[1]] = False
        self._visits_before = _visits_before(evidence, of_change[inside], cells)

    def step_size(self, gamma: float) -> float | None:
        """Return the constant step size towards returns, 0 for 1/N, or None."""
        distance = self._returns(gamma)[self._by_pair[self._begin]] - self._old
        size = (self._new - self._old) / distance
        telling = self.once & np.isfinite(size) & (np.abs(distance) > _TELLING) & (self.left < _LONGEST)
        if np.sum(telling) < FEWEST or np.sum(telling & (self.left > 0)) < FEWEST_INFORMATIVE:
            return None
        usual = most_frequent(size[telling][:, None], self._digits, 1)
        if usual and np.mean(np.abs(size[telling] - usual[0][0]) <= self._near * abs(usual[0][0])) > SHARE:
            return usual[0][0] if np.sum(telling & self._again) >= FEWEST_INFORMATIVE else None
        return 0.0 if self._falls(size, telling) else None

    def _falls(self, size: FloatArray, telling: BoolArray) -> bool:
        count = 1.0 / size
        whole = self._are_whole(count)
        if np.mean((whole & (count > 0.5))[telling]) <= SHARE:
            return False
        places = np.flatnonzero(telling & whole)
        places = places[np.argsort(self._cell[places], kind="stable")]
        same = self._cell[places][1:] == self._cell[places][:-1]
        grown = np.diff(np.rint(count[places]))[same]
        return len(grown) >= FEWEST and bool(np.mean(grown >= 1) > SHARE)

    def _are_whole(self, numbers: FloatArray) -> BoolArray:
        whole: BoolArray = np.abs(numbers - np.rint(numbers)) <= self._near * np.maximum(1.0, np.abs(numbers))
        return whole

    def _returns(self, gamma: float) -> FloatArray:
        """Return the return of each step, for the last steps of each episode."""
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

    def counted_visits(self, gamma: float, size: float) -> CountedVisits | None:
        """Return which visits of a cell in an episode have moved it by `size` (0 for 1/N), None if unknown.
        Enough changes must fit one answer only, and nearly all of them must fit it.
        """
        returns = self._returns(gamma)[self._by_pair]
        least = _LEAST * np.maximum(np.abs(self._old), np.abs(self._new))
        known = (self.left < _LONGEST) & (np.abs(self._new - self._old) > least)
        fits = self._by_averages(returns, known) if size == 0.0 else self._by_steps(returns, size)
        for visits, fit in fits.items():
            others = [other for each, other in fits.items() if each != visits]
            decides = all(np.sum(fit & ~other & known) >= FEWEST_INFORMATIVE for other in others)
            if decides and np.mean(fit[known]) > SHARE:
                return visits
        return None

    def _by_averages(self, returns: FloatArray, known: BoolArray) -> dict[CountedVisits, BoolArray]:
        """Return the changes that fit averages of the `returns` counted by each answer, `[m]`. The number of
        returns before a `known` change must be whole, and grow with the changes of the cell.
        """
        last = self._begin + self._count - 1
        counted: dict[CountedVisits, tuple[FloatArray, IntArray]] = {
            "first": (returns[self._begin], np.ones_like(self._count)),
            "every": (np.add.reduceat(returns, self._begins)[self._pair], self._count),
            "last": (returns[last], np.ones_like(self._count)),
        }
        order = np.lexsort((self._visits_before, self._cell))
        order = order[known[order]]
        follows = np.diff(self._cell[order]) == 0
        most = np.diff(self._visits_before[order])
        fits: dict[CountedVisits, BoolArray] = {}
        for visits, (sums, count) in counted.items():
            before = (sums - count * self._new) / (self._new - self._old)
            fit = self._are_whole(before) & (before > -0.5)
            grown = np.diff(np.rint(before[order]))
            grows = (grown >= count[order][:-1]) & (grown <= most)
            fit[order[1:][follows & ~grows]] = False
            fits[visits] = fit
        return fits

    def _by_steps(self, returns: FloatArray, size: float) -> dict[CountedVisits, BoolArray]:
        """Return the changes that fit steps of `size` towards the `returns` counted by each answer, `[m]`."""
        last = self._begin + self._count - 1
        forwards, backwards, together = (self._old.copy() for _ in range(3))
        for place in range(int(self._count[self.left < _LONGEST].max(initial=0))):
            at = np.flatnonzero(self._count > place)
            nearer, further = returns[self._begin[at] + place], returns[last[at] - place]
            forwards[at] += size * (nearer - forwards[at])
            backwards[at] += size * (further - backwards[at])
            together[at] += size * (nearer - self._old[at])
        every = [self._are_new(each, returns) for each in (backwards, forwards, together)]
        first, late = (self._old + size * (returns[at] - self._old) for at in (self._begin, last))
        return {
            "first": self._are_new(first, returns),
            "every": max(every, key=np.sum),
            "last": self._are_new(late, returns),
        }

    def _are_new(self, predicted: FloatArray, returns: FloatArray) -> BoolArray:
        size = np.maximum(np.abs(self._old), np.abs(returns[self._begin]))
        are_new: BoolArray = np.abs(predicted - self._new) <= self._near * np.maximum(size, 1e-280)
        return are_new


def _visits_before(evidence: Evidence, taken: IntArray, cells: int) -> IntArray:
    """Return the place of each of `taken`, `[m]`, among all visits by cell and episode. It counts `cells` for
    each episode. For one cell, it grows with the number of visits.
    """
    span = int(evidence.episode.max(initial=0)) + 1
    visits = np.sort(evidence.cell * span + evidence.episode)
    place: IntArray = np.searchsorted(visits, taken % cells * span + taken // cells)
    return place
