"""A finite MDP in extended precision, with one end state."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

ExtendedArray = npt.NDArray[np.longdouble]


@dataclass(frozen=True, slots=True, eq=False)
class ExactModel:
    """Data of `mdp` for the solvers, in numpy's long double.

    State S is the end of all terminated outcomes. Value arrays are [S+1]. `live` lists the N states with
    pairs. Probabilities of each pair are scaled to sum to 1.
    """

    mdp: TabularMDP
    live: IntArray
    pair_state: IntArray
    outcome_pair: IntArray
    landing: IntArray
    probability: ExtendedArray
    reward: ExtendedArray

    @property
    def end(self) -> int:
        """The common end state, S."""
        return self.mdp.states

    @property
    def is_live(self) -> BoolArray:
        """True for states with pairs, [S+1]."""
        mask = np.zeros(self.end + 1, dtype=np.bool_)
        mask[self.live] = True
        return mask

    @property
    def pairs_each(self) -> IntArray:
        """Number of pairs of each live state, [N]."""
        return np.diff(self.mdp.first_pair)[self.live]

    def advantage(self, v: ExtendedArray, gamma: float) -> ExtendedArray:
        """Return q(s, a) − v(s), [P] (equation 4.6), for `v`, [S+1].

        Differences keep the digits that γ v(s′) − v(s) would lose for γ near 1.
        """
        own = v[self.pair_state]
        gain = self.probability * (self.reward + gamma * (v[self.landing] - own[self.outcome_pair]))
        summed: ExtendedArray = np.add.reduceat(gain, self.mdp.first_outcome[:-1])
        return summed - (1.0 - np.longdouble(gamma)) * own

    def best(self, of_pairs: ExtendedArray) -> ExtendedArray:
        """Return the highest pair value, [P], in every live state, [N]."""
        highest: ExtendedArray = np.maximum.reduceat(of_pairs, self.mdp.first_pair[self.live])
        return highest

    def steps_to(self, goals: Iterable[int], usable: BoolArray) -> IntArray:
        """Return the fewest steps, [S+1], to one of `goals` by `usable` pairs, [P], or −1."""
        return self._ways(usable).steps_to(goals)

    def endless(self, usable: BoolArray) -> IntArray:
        """Return the live states, [n], that `usable` pairs, [P], never end."""
        may_end = self._ways(usable).leading_to(np.array([self.end]))
        return self.live[~may_end[self.live]]

    def _ways(self, usable: BoolArray) -> Ways:
        used = usable[self.outcome_pair]
        return Ways(self.pair_state[self.outcome_pair][used], self.landing[used], self.end + 1)


class Ways:
    """Edges between states, [n], for backward searches."""

    def __init__(self, source: IntArray, target: IntArray, states: int) -> None:
        ways = np.sort(target * states + source)
        ways = ways[np.diff(ways, prepend=-1) > 0]  # without duplicates, which slips cause
        self._before: IntArray = ways % states
        self._first: IntArray = np.searchsorted(ways, states * np.arange(states + 1))
        self._states = states

    def steps_to(self, goals: Iterable[int]) -> IntArray:
        """Return the fewest steps, [S+1], to one of `goals`, or −1."""
        before, first = self._before.tolist(), self._first.tolist()
        steps = [-1] * self._states
        queue = list(goals)
        for goal in queue:
            steps[goal] = 0
        for state in queue:
            for previous in before[first[state] : first[state + 1]]:
                if steps[previous] < 0:
                    steps[previous] = steps[state] + 1
                    queue.append(previous)
        return np.array(steps, dtype=np.int64)

    def leading_to(self, goals: IntArray) -> BoolArray:
        """Return the states, [S+1], that can reach one of `goals`, [n], and these."""
        return reachable(self._first, self._before, goals)


def exact_model(mdp: TabularMDP) -> ExactModel:
    """Return the solvers' view of `mdp`."""
    probability = mdp.probability.astype(np.longdouble)
    total = np.add.reduceat(probability, mdp.first_outcome[:-1])
    return ExactModel(
        mdp=mdp,
        live=np.flatnonzero(np.diff(mdp.first_pair)),
        pair_state=mdp.pair_state,
        outcome_pair=mdp.outcome_pair,
        landing=np.where(mdp.terminated, mdp.states, mdp.next_state),
        probability=probability / total[mdp.outcome_pair],
        reward=mdp.reward.astype(np.longdouble),
    )
