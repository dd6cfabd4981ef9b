"""Updates that read one estimate of the next state, of an allowed or a second drawn action."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.programs.diagnosis.sample import EXACT, Sample
from rl_tui.programs.diagnosis.trial import FEWEST, FEWEST_INFORMATIVE, Trial, constant_trial
from rl_tui.programs.evidence.verdict import UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray

_CLEARLY: Final = 3
"""Two estimates are distinct if they move the cell by this multiple of the tolerance."""


def one_entry_trial(sample: Sample) -> Trial | None:
    """Return the trial in which every inner step reads one estimate of the next state.

    The actions are allowed ones if no state contradicts that: an action with a higher estimate is then
    forbidden there, and never read. Several contradictions show that the action was drawn.
    """
    if sample.evidence.precision > EXACT:
        return None  # close estimates would look equal
    for target in (UpdateTarget.BEST, UpdateTarget.NEXT_ACTION):
        first = constant_trial(sample, target, sample.reward)
        if first is None or not first.alpha or first.gamma <= 0.0:
            continue
        trial = replace(first, target=UpdateTarget.DRAWN, value=_nearest(first))
        if trial.holds and trial.tells_gamma and not np.any(_inner(trial) & ~trial.explained):
            return _named(trial)
    return None


def _inner(trial: Trial) -> BoolArray:
    inner: BoolArray = trial.counted & ~trial.sample.ended
    return inner


def _nearest(trial: Trial) -> FloatArray:
    sample = trial.sample
    wanted = (sample.change / trial.alpha - sample.reward + sample.old) / trial.gamma
    place = np.abs(sample.rows - wanted[:, None]).argmin(1)
    return np.where(sample.ended, 0.0, sample.rows[np.arange(len(sample)), place])


def _named(trial: Trial) -> Trial | None:
    sample = trial.sample
    near = (_CLEARLY * sample.slack / np.abs(np.multiply(trial.alpha, trial.gamma)))[:, None]
    off = sample.rows - trial.value[:, None]
    is_read, is_above = np.abs(off) <= near, off > near
    telling = _inner(trial) & trial.informative
    departs = telling & is_above.any(1)
    known = departs | (telling & (is_read.sum(1) == 1))
    states = sample.evidence.states
    shape = (states, sample.evidence.actions)
    excluded, read, departing = np.zeros(shape, np.int64), np.zeros(shape, np.int64), np.zeros(states, int)
    np.add.at(excluded, sample.next_state[departs], is_above[departs])
    alone = known & (is_read.sum(1) == 1)
    np.add.at(read, sample.next_state[alone], is_read[alone])
    np.add.at(departing, sample.next_state[departs], 1)
    contradictions = int(np.minimum(excluded, read).sum())
    repeated = int(np.maximum(departing - 1, 0).sum())
    if contradictions == 0 and repeated >= FEWEST:
        return replace(trial, target=UpdateTarget.ALLOWED)
    taken = sample.rows[np.arange(len(sample)), np.maximum(sample.next_action, 0)]
    others = departs & (np.abs(taken - trial.value) > near[:, 0])
    best = telling & ~is_above.any(1) & (is_read.sum(1) == 1)
    fewest = min(contradictions, int(others.sum()), int(best.sum()))
    return trial if fewest >= FEWEST_INFORMATIVE else None
