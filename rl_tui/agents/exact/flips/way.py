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
    """Return the states, [S+1], to which ``optimal`` pairs, [P], most likely lead from the start.

    From a state the way goes on to where its actions lead with the highest chance, all outcomes that land
    there taken together; to stay is not to go on. Where several places are likeliest, or several actions
    optimal, or the start is drawn, all are followed. The way comes to the end, or it goes round where no luck
    at all leads to the end. Where it goes round only until a slip leads out, it does not tell what becomes of
    the episode: None.
    """
    source = model.pair_state[model.outcome_pair]
    moves = np.flatnonzero(optimal[model.outcome_pair] & (model.landing != source))
    places, place_of = np.unique(
        model.outcome_pair[moves] * (model.end + 1) + model.landing[moves], return_inverse=True
    )
    pair, landing = np.divmod(places, model.end + 1)
    chance = np.bincount(place_of, weights=model.probability[moves].astype(np.float64))
    highest = np.zeros(model.mdp.pairs)
    np.maximum.at(highest, pair, chance)
    followed = chance >= highest[pair] - AS_LIKELY
    first_edge = np.searchsorted(model.pair_state[pair[followed]], np.arange(model.end + 2))
    way = reachable(first_edge, landing[followed], model.mdp.start_state)
    may_end = model.steps_to([model.end], optimal) >= 0
    return way if way[model.end] or not (way & may_end).any() else None
