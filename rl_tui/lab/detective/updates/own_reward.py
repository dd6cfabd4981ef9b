"""A reward of the program's own: two visits of one transition have it in common, so it cancels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rl_tui.lab.detective.updates.pair_solving import plainest, solved_pairs
from rl_tui.lab.detective.updates.sample import EXACT, Sample
from rl_tui.lab.detective.updates.trial import FEWEST_INFORMATIVE, Trial
from rl_tui.lab.detective.verdict import UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


def own_reward_trial(sample: Sample, target: UpdateTarget, numbers: Mapping[str, float]) -> Trial | None:
    """Return the trial whose reward is a function of (s, a, s′, r), not r itself; None if there is none."""
    value = np.where(sample.ended, 0.0, sample.value(target))
    group = _transitions(sample)
    order = np.argsort(group, kind="stable")
    same = np.flatnonzero(group[order][1:] == group[order][:-1])
    one, other = order[same], order[same + 1]
    old = sample.old[one] - sample.old[other]
    change = sample.change[other] - sample.change[one]
    slack = sample.slack[one] + sample.slack[other]
    clear = (np.abs(old) > 100 * slack) & (sample.change[one] != 0) & (sample.change[other] != 0)
    digits = 6 if sample.evidence.precision < EXACT else 3
    values = value[other] - value[one]
    values[np.abs(values) <= 100 * slack] = 0.0
    precision = max(sample.evidence.precision, 1e-8)
    trials = []
    for a, b in solved_pairs(old[clear], values[clear], change[clear], digits, 3):
        gamma = 0.0 if np.isnan(b) else plainest(b / a, numbers, precision)
        a = plainest(a, numbers, precision)
        reward = sample.change / a + sample.old - gamma * value
        middle, shared = _middles(group, reward)
        trial = Trial(sample, target, middle, value, a, gamma, own_reward=True)
        own = np.abs(middle - sample.reward) * abs(a) > 10 * sample.slack
        if np.sum(own & shared & trial.explained) >= FEWEST_INFORMATIVE and trial.explained[shared].any():
            trials.append(replace(trial, reward=np.where(shared, middle, np.nan)))
    return min(trials, key=lambda trial: trial.unexplained, default=None)


def _transitions(sample: Sample) -> IntArray:
    """Return which transition (s, a, s′, r) each step is, [n], as a number."""
    _, reward = np.unique(sample.reward, return_inverse=True)
    states = len(sample.evidence.initial) // sample.evidence.actions
    whole = (sample.cell * states + sample.next_state) * 2 + sample.ended
    rewards = int(reward.max(initial=0)) + 1
    result: IntArray = np.unique(whole * rewards + reward.ravel(), return_inverse=True)[1].ravel()
    return result


def _middles(group: IntArray, numbers: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return of each place the median of its group's ``numbers``, [n], and whether the group has several."""
    order = np.lexsort((numbers, group))
    begins = np.flatnonzero(np.diff(group[order], prepend=-1))
    lengths = np.diff(np.append(begins, len(order)))
    middles = numbers[order][begins + (lengths - 1) // 2]
    return middles[group], (lengths > 2)[group]
