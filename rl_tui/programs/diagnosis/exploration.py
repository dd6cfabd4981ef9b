"""The ε that a program uses, which is never a finding."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.programs.diagnosis.faults.predictions import Predictions
from rl_tui.programs.evidence.code_names import EPSILONS, declared
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import ExplorationFound, UpdateFound, UpdateTarget
from rl_tui.studies.statistics.intervals import share_interval
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

_MOST: Final = 2_000
"""Most choices counted, the latest, because ε may fall."""
_MOST_EXAMINED: Final = 6_000
_FEWEST: Final = 100


def exploration_of(evidence: Evidence, update: UpdateFound) -> ExplorationFound | None:
    """Estimate ε from the latest choices in states with one best action, or return None.

    A random action is the best one with probability 1/A, so ε is the share of other actions, times A/(A − 1).
    If actions are forbidden, the best one may be.

    An episode without changes may be an evaluation, or a greedy one whose estimates have converged. To leave
    out only the greedy ones would raise ε, so there is no estimate if the two cannot be told apart.
    """
    actions = evidence.actions
    if actions < 2 or update.target is UpdateTarget.ALLOWED or not evidence.learns.any():
        return None
    last = np.flatnonzero(evidence.learns)[-1]  # episodes after the last change may all be evaluations
    at, rows = _clear(evidence, np.arange(last + 1)[-_MOST_EXAMINED:])
    without = ~evidence.learns[at]
    if without.any():
        evaluations = _evaluations(evidence, update)
        if evaluations is None:
            return None
        is_evaluation = np.isin(evidence.episode[at], evaluations)
        if len(evaluations) and (without & ~is_evaluation).any():
            return None
        kept = ~is_evaluation & (
            evidence.episode[at] != evidence.episode[last]
        )  # it was chosen for its change
        at, rows = at[kept], rows[kept]
    at, rows = at[-_MOST:], rows[-_MOST:]
    if len(at) < _FEWEST:
        return None
    others = int((evidence.action[at] != rows.argmax(1)).sum())
    factor = actions / (actions - 1)
    shares = (others / len(at), *share_interval(others, len(at)))
    epsilon, low, high = (min(1.0, factor * share) for share in shares)
    name, written = declared(evidence.numbers, EPSILONS) or ("", None)
    return ExplorationFound(epsilon, low, high, len(at), name, written)


def _clear(evidence: Evidence, at: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the steps of `at` with one best action, and the rows of their states."""
    at = at[at > 0]
    rows, before = evidence.mean_rows(evidence.state[at], at), evidence.mean_rows(evidence.state[at], at - 1)
    best = rows.max(1, keepdims=True)
    is_clear: BoolArray = (rows == best).sum(1) == 1
    is_clear &= (before == before.max(1, keepdims=True)).sum(1) == 1
    is_clear &= rows.argmax(1) == before.argmax(1)  # the action may be chosen before the last update
    return at[is_clear], rows[is_clear]


def _evaluations(evidence: Evidence, update: UpdateFound) -> IntArray | None:
    """Return the episodes in which the update would change the table, but nothing changed, or None."""
    predictions = Predictions(evidence, update)
    if not predictions.is_known or update.reward == "own":
        return None
    readings = predictions.readings(np.flatnonzero(~evidence.learns))
    values = predictions.values(readings.at)
    values = np.column_stack((values, np.zeros(len(values))))  # at an end there may be no next value
    after = predictions.after(readings, evidence.reward[readings.at], values)
    missed = predictions.witnesses(readings, readings.before[:, None], after).one
    return np.unique(evidence.episode[readings.at[missed]])
