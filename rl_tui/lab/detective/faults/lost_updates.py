"""Updates that leave nothing behind: a table of integers, or one that never moves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from rl_tui.lab.detective.evidence import Evidence
from rl_tui.lab.detective.faults.proof import FEWEST_STEPS, CodePlace, Proof, some_of, step_text, written
from rl_tui.lab.detective.source.code_names import CodeNames
from rl_tui.lab.detective.verdict import CodeFault
from rl_tui.worlds.mdp.space import BoolArray, IntArray

_MOST: Final = 2_000
"""Steps of which is asked whether a step size and a discount explain what was cut off."""
_MOST_NUMBERS: Final = 12
_FEWEST_REWARDS: Final = 5
_PATIENCE: Final = 1_000
_PATIENT_EPISODES: Final = 100
"""Rewards and episodes that a program may see before its first update while it runs: it may fill a memory."""


def proof_of_rounding(
    evidence: Evidence, dtype: str, numbers: Mapping[str, float], names: CodeNames, *, writes: bool
) -> Proof | None:
    """Return the proof that a table of integers cuts its updates off.

    Either numbers of the code explain what is kept as the whole part of an update, or nothing is kept at all
    of rewards though the code writes.
    """
    never_moves = not evidence.recording.changes.step.size
    if not dtype.startswith(("int", "uint")) or (never_moves and not writes):
        return None
    cut = _cut_off(evidence, numbers)
    if cut is None and writes:
        cut = _nothing_kept(evidence)
    if cut is None:
        return None
    at, text = cut
    return Proof(
        CodeFault.ROUNDING_TABLE,
        evidence.number[at],
        0,
        f"the table holds {dtype}: {text}; so at {len(at):,} steps",
        f"make it of floats: {names.table} = np.zeros((number of states, number of actions))",
        CodePlace.TABLE,
    )


def _cut_off(evidence: Evidence, numbers: Mapping[str, float]) -> tuple[IntArray, str] | None:
    """Return the steps whose update was cut off, if numbers of the code explain all of them."""
    plain = (evidence.changes_of == 0) | (evidence.only_change[0] == evidence.cell)
    at = some_of(np.flatnonzero(plain & ((evidence.changes_of == 1) | (evidence.reward != 0.0))), _MOST)
    before = evidence.history.before(evidence.cell[at], evidence.number[at])
    after = np.where(evidence.changes_of[at] == 1, evidence.only_change[2][at], before)
    best = evidence.rows(evidence.next_state[at], at).max(1, initial=-np.inf)
    ended = evidence.terminated[at]
    held = sorted({each for each in numbers.values() if 0.0 < each <= 1.0})[:_MOST_NUMBERS]
    for alpha in dict.fromkeys((*held, 1.0)):
        for gamma in dict.fromkeys((*held, 1.0)):
            full = before + alpha * (evidence.reward[at] + gamma * np.where(ended, 0.0, best) - before)
            fractional = np.abs(full - np.rint(full)) > 1e-9
            if (np.trunc(full) == after)[fractional].all() and fractional.sum() >= FEWEST_STEPS:
                first = int(np.argmax(fractional))
                step = step_text(evidence.number[at[first]])
                new, kept = written(full[first]), written(after[first])
                return at[fractional], f"at {step} the new estimate {new} was cut off to {kept}"
    return None


def _nothing_kept(evidence: Evidence) -> tuple[IntArray, str] | None:
    """Return the steps whose reward should have moved a 0 and did not, if no such step moved it."""
    at = some_of(np.flatnonzero(evidence.reward != 0.0))
    before = evidence.history.before(evidence.cell[at], evidence.number[at])
    best = evidence.rows(evidence.next_state[at], at).max(1, initial=-np.inf)
    should = (before == 0.0) & ((best == 0.0) | evidence.terminated[at])
    at = at[should]
    if len(at) < FEWEST_STEPS or evidence.changes_of[at].any():
        return None
    reward, step = written(evidence.reward[at[0]]), step_text(evidence.number[at[0]])
    return at, f"nothing is kept of the reward {reward} at {step}"


def proof_of_no_update(evidence: Evidence, names: CodeNames, *, writes: bool, is_over: bool) -> Proof | None:
    """Return the proof that nothing ever moves, though rewards came and the code writes to the table."""
    initial = evidence.recording.initial
    if not writes or initial is None or evidence.recording.changes.step.size:
        return None
    if evidence.recording.first or len(np.unique(np.nan_to_num(initial))) > 1:
        return None  # what was learned earlier, or read from a file, is only used
    rewarded = _tells(evidence, float(np.nan_to_num(initial).max(initial=0.0)))
    at = np.flatnonzero(rewarded)
    is_long = len(at) >= _PATIENCE and np.ptp(evidence.episode) >= _PATIENT_EPISODES
    if len(at) < _FEWEST_REWARDS or not (is_over or is_long):
        return None
    first = at[0]
    return Proof(
        CodeFault.LOSES_UPDATE,
        evidence.number[at],
        0,
        f"{len(at):,} steps brought a reward, the first at {step_text(evidence.number[first])} "
        f"({written(evidence.reward[first])}), and no number of the table ever moved",
        f"after each step put the new estimate into the table itself: {names.cell()} += "
        f"{names.alpha} * (target - {names.cell()})",
        CodePlace.CALL,
    )


def _tells(evidence: Evidence, initial: float) -> BoolArray:
    """Return which steps move an estimate of ``initial``, whatever the discount."""
    reward = evidence.reward
    if initial == 0.0:
        tells: BoolArray = reward != 0.0
    else:
        tells = evidence.terminated & (reward != initial)
    return tells
