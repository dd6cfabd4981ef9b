"""The deterministic model of Dyna-Q and prioritized sweeping (Sutton & Barto, 2nd ed., section 8.2).

It takes what a pair led to last for what it leads to always.
"""

from __future__ import annotations

from typing import Final

from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.tables import Tables, pairs_of
from rl_tui.agents.policies.family import best_value
from rl_tui.worlds.mdp.space import FloatArray

# In place of the state that a pair leads to
UNKNOWN: Final = -1
THE_END: Final = -2


@compiled
def modelled_value(q: FloatArray, tables: Tables, next_state: int) -> float:
    """Return max Q(S′,·) of a state in the model, 0 where the episode ends or nothing is known."""
    value = 0.0
    if next_state >= 0:
        first, last = pairs_of(tables, next_state)
        value = best_value(q, first, last)
    return value
