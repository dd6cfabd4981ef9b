"""Faults in the numbers of an update: a discount applied twice, or a step size out of range."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.programs.diagnosis.faults.cells import Proof, some_of, written
from rl_tui.programs.diagnosis.faults.predictions import Predictions
from rl_tui.programs.evidence.code_names import CodeNames
from rl_tui.programs.evidence.verdict import CodeFault, MovedCell
from rl_tui.worlds.mdp.space import FloatArray

_NEAR: Final = 1e-6
DISCOUNT: Final = re.compile(r"gamma|discount|γ|^(g|df)$", re.IGNORECASE)
"""Names of a discount."""


def proof_of_gamma_twice(
    predictions: Predictions, reward: FloatArray, numbers: Mapping[str, float], names: CodeNames
) -> Proof | None:
    """Prove that γ² moves the table where the code has γ. This relies on the name of a number."""
    gamma = predictions.update.gamma
    if not predictions.is_known or gamma is None or not 0.0 < gamma < 1.0:
        return None
    name = discount_twice(gamma, numbers)
    if name is None:
        return None
    evidence = predictions.evidence
    inner = ~(evidence.terminated | evidence.truncated) & (evidence.changes_of == 1)
    readings = predictions.readings(some_of(np.flatnonzero(inner)))
    values, own = predictions.values(readings.at), reward[readings.at]
    twice = predictions.after(readings, own, values)
    once = predictions.after(readings, own, values / numbers[name])
    seen = predictions.witnesses(readings, twice, once)
    steps, root = evidence.number[readings.at[seen.one]], written(numbers[name])
    return Proof(
        CodeFault.GAMMA_TWICE,
        steps,
        int(seen.other.sum()),
        f"The table changes as with γ {written(gamma)}. Your `{name}` is {root}, and {root}² = "
        f"{written(gamma)}.",
        f"discount once: {replace(names, gamma=name).target()}",
        certainty="declared",
        neither=int(seen.neither.sum()),
    )


def discount_twice(gamma: float, numbers: Mapping[str, float]) -> str | None:
    """Return the name of the discount whose square is `gamma`, or None if the code has `gamma` itself."""
    if any(math.isclose(each, gamma, rel_tol=_NEAR) for each in numbers.values()):
        return None
    roots = [
        name
        for name, each in numbers.items()
        if math.isclose(each * each, gamma, rel_tol=_NEAR) and DISCOUNT.search(name.rpartition(".")[2])
    ]
    return min(roots, key=len, default=None)


def proof_of_step_size(predictions: Predictions, reward: FloatArray, names: CodeNames) -> Proof | None:
    """Prove a constant step size above 1, or not above 0."""
    update = predictions.update
    alpha = update.alpha
    if not predictions.is_known or update.alpha_schedule != "constant" or alpha is None:
        return None
    if 0.0 < alpha <= 1.0 + _NEAR or update.place is MovedCell.ONE_LATE or update.reward == "own":
        return None
    evidence = predictions.evidence
    changed = evidence.changes_of == 1
    readings = predictions.readings(some_of(np.flatnonzero(changed)))
    values, own = predictions.values(readings.at), reward[readings.at]
    values = np.concatenate((values, np.zeros((len(own), 1))), axis=1)
    moved = predictions.after(readings, own, values)
    nearest = 1.0 if alpha > 1.0 else 0.0
    allowed = readings.before[:, None] + nearest / alpha * (moved - readings.before[:, None])
    seen = predictions.witnesses(readings, moved, allowed)
    steps, way = evidence.number[readings.at[seen.one]], "beyond" if alpha > 1.0 else "away from"
    return Proof(
        CodeFault.STEP_SIZE_OUT_OF_RANGE,
        steps,
        int(seen.other.sum()),
        f"{names.alpha} is {written(alpha)}, so each update moves the estimate {way} its target.",
        f"choose 0 < {names.alpha} ≤ 1: {names.cell()} += {names.alpha} * (target - {names.cell()})",
        neither=int(seen.neither.sum()),
    )
