"""Whether an update takes the reward of the step before."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.lab.detective.faults.predictions import Predictions
from rl_tui.lab.detective.faults.proof import Proof, some_of, step_text, written
from rl_tui.lab.detective.source.code_names import CodeNames
from rl_tui.lab.detective.verdict import CodeFault, MovedCell
from rl_tui.worlds.mdp.space import FloatArray

_MOST: Final = 20_000
"""Steps that are looked at."""


class RewardUsed(NamedTuple):
    """The reward in the target of each step, [N], with the proof if that is not the step's own."""

    reward: FloatArray
    proof: Proof | None


def reward_used(predictions: Predictions, names: CodeNames) -> RewardUsed:
    """Return which reward is used, by the steps on which the one before would move the cell otherwise."""
    evidence = predictions.evidence
    if not predictions.is_known or predictions.update.reward == "own":
        return RewardUsed(evidence.reward, None)
    if predictions.update.place is MovedCell.ONE_LATE:
        return RewardUsed(evidence.reward, None)
    within = np.where(evidence.episode_step == 0, 0.0, evidence.reward_before)
    for before in (evidence.reward_before, within):
        proof = _proof(predictions, before, names)
        if proof.is_enough:
            return RewardUsed(before, proof)
    return RewardUsed(evidence.reward, None)


def _proof(predictions: Predictions, before: FloatArray, names: CodeNames) -> Proof:
    evidence = predictions.evidence
    differs = (evidence.reward != before) & evidence.learns & predictions.is_plain
    readings = predictions.readings(some_of(np.flatnonzero(differs), _MOST))
    at = readings.at
    values = predictions.values(at)
    ended = evidence.terminated[at] | evidence.truncated[at]
    without = np.where(ended[:, None], 0.0, values)  # whether it bootstraps there is another question
    values = np.concatenate((values, without), axis=1)
    late = predictions.after(readings, before[at], values)
    now = predictions.after(readings, evidence.reward[at], values)
    seen = predictions.witnesses(readings, late, now)
    speaking = at[seen.one]
    text = ""
    if len(speaking):
        first = speaking[0]
        text = (
            f"at {step_text(evidence.number[first])} the reward was {written(evidence.reward[first])}, and "
            f"the update took {written(before[first])}, the one it had before; so at all "
            f"{len(speaking):,} steps that tell the two apart"
        )
    return Proof(
        CodeFault.SHIFTED_REWARD,
        evidence.number[speaking],
        int(seen.other.sum()),
        text,
        f"take the {names.reward} that {names.environment}.step({names.action}) returned for this "
        f"{names.state} and {names.action}: {names.target()}",
        neither=int(seen.neither.sum()),
    )
