"""Faults at the last step of an episode."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from rl_tui.programs.diagnosis.faults.cells import CodePlace, Proof, some_of, step_text, written
from rl_tui.programs.diagnosis.faults.predictions import Predictions, Readings
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.verdict import CodeFault, MovedCell, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray

_LEAST_DISCOUNT: Final = 1e-3
"""A smaller discount may be a rounding error."""
_EITHER_END: Final = "done"
"""Name of a flag that is also true at a truncation, if that is what it is found to do."""


class _Ends(NamedTuple):
    """Last steps of one kind, with the new values expected with and without bootstrapping."""

    readings: Readings
    values: FloatArray
    with_next: FloatArray
    without: FloatArray


def proofs_at_ends(
    predictions: Predictions, reward: FloatArray, names: CodeNames, *, done_is_either: bool, may_be_own: bool
) -> tuple[Proof, ...]:
    """Return the proofs from last steps.

    Args:
        predictions: Predictions of a known update.
        reward: Reward that it uses, `[N]`.
        names: Names in the code.
        done_is_either: True if the program receives one flag for terminal and truncated ends, so that a
            missing bootstrap is not its fault.
        may_be_own: True if its rewards may differ, or it sets estimates to a constant. An updated estimate
            may then stay the same.
    """
    update = predictions.update
    if not predictions.is_known or update.reward == "own" or update.place is MovedCell.ONE_LATE:
        return ()
    evidence = predictions.evidence
    ended = evidence.surely_ended & evidence.learns
    cut_off = evidence.truncated & ~evidence.terminated & evidence.learns
    proofs = [] if may_be_own else [_lost_at_end(predictions, ended, reward, names)]
    if update.target is not UpdateTarget.NOTHING and (update.gamma or 0.0) >= _LEAST_DISCOUNT:
        proofs.append(_bootstraps(predictions, ended, reward, names))
        if not done_is_either:
            proofs.append(_left_out(predictions, cut_off, reward, names))
    return tuple(proofs)


def _ends(predictions: Predictions, which: BoolArray, reward: FloatArray) -> _Ends:
    readings = predictions.readings(some_of(np.flatnonzero(which)))
    values, own = predictions.values(readings.at), reward[readings.at]
    return _Ends(
        readings,
        values,
        predictions.after(readings, own, values),
        predictions.after(readings, own, np.zeros((len(own), 1))),
    )


def _bootstraps(predictions: Predictions, ended: BoolArray, reward: FloatArray, names: CodeNames) -> Proof:
    ends = _ends(predictions, ended, reward)
    seen = predictions.witnesses(ends.readings, ends.with_next, ends.without)
    return Proof(
        CodeFault.BOOTSTRAPS_AFTER_END,
        predictions.evidence.number[ends.readings.at[seen.one]],
        int(seen.other.sum()),
        _seen(
            predictions,
            ends,
            seen.one,
            "the episode ended in a terminal state, but the target contained the value of that state",
            has_next=True,
        ),
        f"leave out the next value after a terminal step: {names.target()}",
        neither=int(seen.neither.sum()),
    )


def _left_out(predictions: Predictions, cut_off: BoolArray, reward: FloatArray, names: CodeNames) -> Proof:
    ends = _ends(predictions, cut_off, reward)
    if names.terminated == _EITHER_END:
        names = replace(names, terminated="terminated")
    seen = predictions.witnesses(ends.readings, ends.without, ends.with_next)
    return Proof(
        CodeFault.NO_BOOTSTRAP_AFTER_TRUNCATION,
        predictions.evidence.number[ends.readings.at[seen.one]],
        int(seen.other.sum()),
        _seen(
            predictions,
            ends,
            seen.one,
            "the time limit stopped the episode, but the target left out the value of the next state",
            has_next=False,
        ),
        f"test only {names.terminated}, not truncated: {names.target()}",
        neither=int(seen.neither.sum()),
    )


def _lost_at_end(predictions: Predictions, ended: BoolArray, reward: FloatArray, names: CodeNames) -> Proof:
    """Prove that last steps change nothing, in episodes whose other steps do."""
    ends = _ends(predictions, ended & _follows_a_change(predictions), reward)
    readings = ends.readings
    expected = np.concatenate((ends.with_next, ends.without), axis=1)
    seen = predictions.witnesses(readings, readings.before[:, None], expected)
    steps = predictions.evidence.number[readings.at[seen.one]]
    changed = int((seen.other | seen.neither).sum())  # whatever changed it, such a step has an update
    text = ""
    if len(steps):
        first = int(np.argmax(seen.one))
        text = (
            f"At {step_text(steps[0])} an episode ended with the reward "
            f"{written(reward[readings.at[first]])}, but the table did not change. The estimate "
            f"{written(readings.before[first])} should become {written(ends.without[first, 0])}."
        )
    return Proof(
        CodeFault.LOSES_UPDATE,
        steps,
        changed,
        text,
        f"update after the last step of an episode too, before you leave the loop: {names.target()}",
        CodePlace.CALL,
    )


def _follows_a_change(predictions: Predictions) -> BoolArray:
    """Return True for steps after a change in the same episode, `[N]`."""
    evidence = predictions.evidence
    changing = np.flatnonzero(evidence.changes_of > 0)
    first = np.full(int(evidence.episode.max(initial=0)) + 1, len(evidence))
    np.minimum.at(first, evidence.episode[changing], changing)
    follows: BoolArray = first[evidence.episode] < np.arange(len(evidence))
    return follows


def _seen(predictions: Predictions, ends: _Ends, which: BoolArray, what: str, *, has_next: bool) -> str:
    """Return sentences about the first step of `which`. `has_next` is True if the program's targets contain
    the next value.
    """
    if not which.any():
        return ""
    first = int(np.argmax(which))
    readings, evidence = ends.readings, predictions.evidence
    at = readings.at[first]
    state, action = divmod(int(predictions.moved_cell[at]), evidence.actions)
    value = _value_taken(ends, first)
    bootstrapped = _nearest(ends.with_next[first], readings.after[first])
    before, after = written(readings.before[first]), written(readings.after[first])
    moved = f"stayed {after}" if before == after else f"changed from {before} to {after}"
    expected = ends.without[first, 0] if has_next else bootstrapped
    return (
        f"At {step_text(evidence.number[at])} {what}. Q({state}, {action}) {moved}. It should be "
        f"{written(expected)}, {'without' if has_next else 'with'} γ · {written(value)}."
    )


def _value_taken(ends: _Ends, first: int) -> float:
    place = int(np.abs(ends.with_next[first] - ends.readings.after[first]).argmin())
    return float(ends.values[first, place])


def _nearest(values: FloatArray, wanted: float) -> float:
    return float(values[np.abs(values - wanted).argmin()])
