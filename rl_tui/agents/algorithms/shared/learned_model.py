"""A model of last outcomes (Sutton & Barto, 2nd ed., section 8.2)."""

from __future__ import annotations

from typing import Final

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import best_value
from rl_tui.worlds.mdp.space import FloatArray

# Special values instead of a next state
UNKNOWN: Final = -1
THE_END: Final = -2


@compiled
def modelled_value(q: FloatArray, tables: Tables, next_state: int) -> float:
    """Return max Q(S′,·), or 0 for the end or an unknown state."""
    value = 0.0
    if next_state >= 0:
        first, last = pairs_of(tables, next_state)
        value = best_value(q, first, last)
    return value
