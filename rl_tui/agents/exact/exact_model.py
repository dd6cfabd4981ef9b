"""A finite MDP as exact solvers take it: in extended precision, with one state for every end."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.space import BoolArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

ExtendedArray = npt.NDArray[np.longdouble]


@dataclass(frozen=True, slots=True, eq=False)
class ExactModel:
    """What the solvers share of ``mdp``.

    State number S, one beyond the last, stands for every end: terminated outcomes land there, and values are
    [S+1] arrays that hold the value of the end too, 0 unless the question is another. ``live`` lists the N
    states that own pairs. Probabilities are scaled to sum to 1 in their pair; numbers are numpy's long
    double, which holds more digits than a float on most machines.
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
        """The state that stands for every end: S."""
        return self.mdp.states

    @property
    def is_live(self) -> BoolArray:
        """Which states own pairs, [S+1]."""
        mask = np.zeros(self.end + 1, dtype=np.bool_)
        mask[self.live] = True
        return mask

    @property
    def pairs_each(self) -> IntArray:
        """How many pairs each live state owns, [N]."""
        return np.diff(self.mdp.first_pair)[self.live]

    def advantage(self, v: ExtendedArray, gamma: float, reward: ExtendedArray | None = None) -> ExtendedArray:
        """Return q(s, a) − v(s) of every pair, [P], for state values ``v``, [S+1] (equation 4.6).

        ``reward``, [O], takes the place of the world's own. Differences of values keep the digits that
        γ v(s′) − v(s) would lose where γ is near 1 and values are large.
        """
        rewards = self.reward if reward is None else reward
        own = v[self.pair_state]
        gain = self.probability * (rewards + gamma * (v[self.landing] - own[self.outcome_pair]))
        summed: ExtendedArray = np.add.reduceat(gain, self.mdp.first_outcome[:-1])
        return summed - (1.0 - np.longdouble(gamma)) * own

    def mixed(self, policy: ExtendedArray, of_pairs: ExtendedArray) -> ExtendedArray:
        """Return the average of ``of_pairs``, [P], under ``policy``, [P], in every live state, [N]."""
        mean: ExtendedArray = np.add.reduceat(policy * of_pairs, self.mdp.first_pair[self.live])
        return mean

    def best(self, of_pairs: ExtendedArray) -> ExtendedArray:
        """Return the highest of ``of_pairs``, [P], in every live state, [N]."""
        highest: ExtendedArray = np.maximum.reduceat(of_pairs, self.mdp.first_pair[self.live])
        return highest

    def steps_to(self, goals: Iterable[int], usable: BoolArray) -> IntArray:
        """Return the fewest steps, [S+1], in which luck may lead from each state to one of ``goals``.

        Only ``usable`` pairs, [P], are taken; the end may be a goal. −1 where no goal can be reached.
        """
        used = usable[self.outcome_pair]
        source, target = self.pair_state[self.outcome_pair][used], self.landing[used]
        order = np.argsort(target, kind="stable")
        before = source[order].tolist()
        first = np.searchsorted(target[order], np.arange(self.end + 2)).tolist()
        steps = [-1] * (self.end + 1)
        queue = list(goals)
        for goal in queue:
            steps[goal] = 0
        for state in queue:
            for previous in before[first[state] : first[state + 1]]:
                if steps[previous] < 0:
                    steps[previous] = steps[state] + 1
                    queue.append(previous)
        return np.array(steps, dtype=np.int64)


def exact_model(mdp: TabularMDP) -> ExactModel:
    """Return the solvers' view of ``mdp``."""
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
