"""Updates without effect: a table of integers, or one that never moves."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.programs.diagnosis.faults.cells import (
    FEWEST_STEPS,
    Proof,
    some_of,
    step_text,
    written,
)
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.code_places import ProgramCode
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import CodeFault
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.worlds.mdp.space import BoolArray, IntArray

_MOST: Final = 2_000
"""Most steps checked for a step size and a discount that explain truncated values."""
_MOST_NUMBERS: Final = 12
_FEWEST_REWARDS: Final = 5
_PATIENCE: Final = 1_000
_PATIENT_EPISODES: Final = 100
"""Rewards and episodes before the first update that a running program may need, for instance to fill a
memory.
"""


def proof_of_rounding(evidence: Evidence, names: CodeNames, *, writes: bool) -> Proof | None:
    """Prove that a table of integers truncates its updates, by numbers in the code or by lost rewards."""
    never_moves = not evidence.changes.step.size
    if not evidence.dtype.startswith(("int", "uint")) or (never_moves and not writes):
        return None
    cut = _cut_off(evidence)
    if cut is None and writes:
        cut = _nothing_kept(evidence)
    if cut is None:
        return None
    at, text = cut
    return Proof(
        CodeFault.ROUNDING_TABLE,
        evidence.number[at],
        0,
        f"The table holds {evidence.dtype}. {text}",
        f"create a table of floats: {names.table} = np.zeros((number of states, number of actions))",
        ProgramCode.table_line,
    )


def _cut_off(evidence: Evidence) -> tuple[IntArray, str] | None:
    plain = evidence.stays | (evidence.only_change[0] == evidence.cell)
    at = some_of(np.flatnonzero(plain & ((evidence.changes_of == 1) | (evidence.reward != 0.0))), _MOST)
    before = evidence.history.before(evidence.cell[at], evidence.number[at])
    after = np.where(evidence.changes_of[at] == 1, evidence.only_change[2][at], before)
    best = evidence.rows(evidence.next_state[at], at).max(1, initial=-np.inf)
    ended = evidence.terminated[at]
    held = sorted({each for each in evidence.numbers.values() if 0.0 < each <= 1.0})[:_MOST_NUMBERS]
    for alpha in dict.fromkeys((*held, 1.0)):
        for gamma in dict.fromkeys((*held, 1.0)):
            full = before + alpha * (evidence.reward[at] + gamma * np.where(ended, 0.0, best) - before)
            fractional = np.abs(full - np.rint(full)) > 1e-9
            if (np.trunc(full) == after)[fractional].all() and fractional.sum() >= FEWEST_STEPS:
                first = int(np.argmax(fractional))
                step = step_text(evidence.number[at[first]])
                new, kept = written(full[first]), written(after[first])
                return at[fractional], f"At {step} the new estimate should be {new}, but it became {kept}."
    return None


def _nothing_kept(evidence: Evidence) -> tuple[IntArray, str] | None:
    at = some_of(np.flatnonzero(evidence.reward != 0.0))
    before = evidence.history.before(evidence.cell[at], evidence.number[at])
    best = evidence.rows(evidence.next_state[at], at).max(1, initial=-np.inf)
    should = (before == 0.0) & ((best == 0.0) | evidence.terminated[at])
    at = at[should]
    if len(at) < FEWEST_STEPS or evidence.changes_of[at].any():
        return None
    reward, step = written(evidence.reward[at[0]]), step_text(evidence.number[at[0]])
    return at, f"At {step} the reward {reward} should change an estimate of 0, but it stayed 0."


def proof_of_no_update(
    evidence: Evidence, names: CodeNames, code: ProgramCode, *, is_over: bool
) -> Proof | None:
    """Prove that written rewards move nothing, or that an agent lacks its update."""
    lacks_update = code.lacks_update
    if evidence.recording.first or evidence.changes.step.size or len(np.unique(evidence.initial)) > 1:
        return None  # an earlier or loaded table is only used
    rewarded = _tells(evidence, float(evidence.initial.max(initial=0.0)))
    at = np.flatnonzero(rewarded)
    only_at_ends = bool(evidence.ends[at].all())
    writes = code.always_writes or (is_over and only_at_ends and code.writes_until_the_end)
    if not (lacks_update or writes):
        return None
    is_long = len(at) >= _PATIENCE and np.ptp(evidence.episode) >= _PATIENT_EPISODES
    is_long_enough = lacks_update or (len(at) >= _FEWEST_REWARDS and (is_over or is_long))
    if not (len(at) and is_long_enough):
        return None
    first = at[0]
    return Proof(
        CodeFault.LOSES_UPDATE,
        evidence.number[at],
        0,
        f"{_reward_at(int(evidence.number[first]), evidence.reward[first])}, but no number of the table ever "
        "changed.",
        _fix(evidence, at, names, code),
        ProgramCode.call_line,
    )


def _reward_at(step: int, reward: float) -> str:
    return f"At {step_text(step)} the reward was {written(reward)}"


def _fix(evidence: Evidence, rewarded: IntArray, names: CodeNames, code: ProgramCode) -> str:
    update = names.update()
    if code.lacks_update:
        return f"add the missing update: {names.target()}; {update}"
    left = code.left_before_update()
    if left is not None and evidence.ends[rewarded].all():
        return (
            f"update before line {left.line}, which leaves the loop at the end of an episode, where all "
            f"rewards are: {names.target()}"
        )
    if not code.always_writes:
        return (
            f"also update after the last step of an episode, where all rewards are: {names.target()}; "
            f"{update}"
        )
    return f"write the new estimate into the table itself after each step: {update}"


def proof_of_missing_update(log: ProgramLog, code: ProgramCode) -> Proof | None:
    """Prove that an agent without a table lacks its update."""
    steps, first = log.recording.steps, log.recording.first
    at = np.flatnonzero(steps.reward != 0.0)
    if not len(at) or not code.lacks_update:
        return None
    return Proof(
        CodeFault.LOSES_UPDATE,
        at + first,
        0,
        f"{_reward_at(int(at[0]) + first, steps.reward[at[0]])}, but no estimate was ever written.",
        "add the missing update: Q(S, A) ← Q(S, A) + α [R + γ max Q(S′, a) − Q(S, A)]",
        ProgramCode.call_line,
    )


def _tells(evidence: Evidence, initial: float) -> BoolArray:
    reward = evidence.reward
    if initial == 0.0:
        tells: BoolArray = reward != 0.0
    else:
        tells = evidence.terminated & (reward != initial)
    return tells
