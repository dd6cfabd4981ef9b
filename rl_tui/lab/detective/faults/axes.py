"""Whether the maximum is taken over states where it should be over the actions of the next state."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.lab.detective.faults.predictions import Predictions
from rl_tui.lab.detective.faults.proof import Proof, some_of, step_text, written
from rl_tui.lab.detective.source.code_names import CodeNames
from rl_tui.lab.detective.verdict import CodeFault, MovedCell, UpdateTarget
from rl_tui.worlds.mdp.space import FloatArray

_FEW: Final = 2_000
"""Steps that are looked at: a column is as long as there are states."""


def proof_of_axis(predictions: Predictions, reward: FloatArray, names: CodeNames) -> Proof | None:
    """Return the proof that the largest value of a column stands in the target."""
    update = predictions.update
    if (
        update.target is not UpdateTarget.COLUMN
        or not predictions.is_known
        or update.place is MovedCell.ONE_LATE
    ):
        return None
    evidence = predictions.evidence
    inner = ~(evidence.terminated | evidence.truncated) & (evidence.changes_of == 1)
    readings = predictions.readings(some_of(np.flatnonzero(inner), _FEW))
    at = readings.at
    column, best = predictions.values(at), predictions.values(at, UpdateTarget.BEST)
    over_states = predictions.after(readings, reward[at], column)
    over_actions = predictions.after(readings, reward[at], best)
    seen = predictions.witnesses(readings, over_states, over_actions)
    speaking = at[seen.one]
    text = ""
    if len(speaking):
        first = int(np.argmax(seen.one))
        text = (
            f"at {step_text(evidence.number[speaking[0]])} the target held {written(column[first, 0])}, the "
            f"largest value of any state for action {evidence.action[speaking[0]]}; the largest of the next "
            f"state is {written(best[first, 0])}; so at all {len(speaking):,} steps that tell the two apart"
        )
    return Proof(
        CodeFault.WRONG_AXIS,
        evidence.number[speaking],
        int(seen.other.sum()),
        text,
        f"take the maximum over the actions of the next state, {names.best()}: {names.target()}",
        neither=int(seen.neither.sum()),
    )
