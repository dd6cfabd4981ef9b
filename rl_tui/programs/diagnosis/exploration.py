"""The ε that a program uses: how often it does not take the best action. It is shown, and never a finding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from rl_tui.programs.evidence.code_names import declared_epsilon
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import ExplorationFound, UpdateFound, UpdateTarget
from rl_tui.studies.statistics.intervals import share_interval

_MOST: Final = 2_000
"""Most choices counted, the latest, because ε may fall."""
_MOST_EXAMINED: Final = 6_000
_FEWEST: Final = 100


def exploration_of(
    evidence: Evidence, update: UpdateFound, numbers: Mapping[str, float]
) -> ExplorationFound | None:
    """Return the ε of the latest choices in states with one best action, or None if it cannot be estimated.

    A random action is the best one with probability 1/A, so ε is the share of other actions, times
    A/(A − 1). With allowed actions only, the best one may be forbidden.
    """
    actions = evidence.actions
    if actions < 2 or update.target is UpdateTarget.ALLOWED:
        return None
    at = np.flatnonzero(evidence.learns)[-_MOST_EXAMINED:]
    at = at[at > 0]
    rows, before = evidence.rows(evidence.state[at], at), evidence.rows(evidence.state[at], at - 1)
    best = rows.max(1, keepdims=True)
    is_clear = ((rows == best).sum(1) == 1) & ((before == before.max(1, keepdims=True)).sum(1) == 1)
    is_clear &= rows.argmax(1) == before.argmax(1)  # the action may be chosen before the last update
    at, rows = at[is_clear][-_MOST:], rows[is_clear][-_MOST:]
    if len(at) < _FEWEST:
        return None
    others = int((evidence.action[at] != rows.argmax(1)).sum())
    factor = actions / (actions - 1)
    shares = (others / len(at), *share_interval(others, len(at)))
    epsilon, low, high = (min(1.0, factor * share) for share in shares)
    name, written = declared_epsilon(numbers) or ("", None)
    return ExplorationFound(epsilon, low, high, len(at), name, written)
