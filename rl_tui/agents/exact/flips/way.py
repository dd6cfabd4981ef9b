"""The way from the start: where optimal actions lead if what is likeliest happens."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray

# Chances that floats cannot hold, such as 1/3, may differ by less
AS_LIKELY: Final = 1e-9


def way_from_start(model: ExactModel, optimal: BoolArray) -> BoolArray | None:
    """Return the states, [S+1], to which likeliest outcomes of ``optimal`` pairs, [P], lead from the start.

    Where several are likeliest, or optimal, or a start, all are followed. The way comes to the end, or it
    goes round where no luck at all leads to the end. Where it goes round only until a slip leads out, it
    does not tell what becomes of the episode: None.
    """
    highest = np.maximum.reduceat(model.probability, model.mdp.first_outcome[:-1])
    followed = optimal[model.outcome_pair] & (model.probability >= highest[model.outcome_pair] - AS_LIKELY)
    source = model.pair_state[model.outcome_pair][followed]
    first_edge = np.searchsorted(source, np.arange(model.end + 2))
    way = reachable(first_edge, model.landing[followed], model.mdp.start_state)
    may_end = model.steps_to([model.end], optimal) >= 0
    return way if way[model.end] or not (way & may_end).any() else None
