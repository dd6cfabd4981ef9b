"""π(a|s) for the screen: the one that the kernels have, interpreted."""

from __future__ import annotations

import importlib
from typing import Final

import numpy as np

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.policies.family import in_force, learns, probability_of
from rl_tui.worlds.mdp.space import FloatArray, IntArray, all_pairs

MOST_ACTIONS: Final = 100
"""Each is asked for alone and looks at all of them: interpreted, more would hold up the screen."""


def action_chances(
    hyperparameters: Hyperparameters, epsilon: float, q: FloatArray, visits: IntArray
) -> FloatArray | None:
    """Return π(a|s) of the A actions of one state, [A], from their estimates and visits, [A] each.

    ``epsilon`` is the one in force. None for more than ``MOST_ACTIONS``, where an estimate that ran away is
    NaN, and for policies that learn, as those for bandits do: what they have learned is not at hand here.
    """
    actions = len(q)
    if actions > MOST_ACTIONS or np.isnan(q).any():
        return None
    here = all_pairs(("here",), [str(action) for action in range(actions)], time_limit=0)
    module = importlib.import_module(POLICY_BY_ID[hyperparameters.policy].module)
    rule = in_force(module.new_rule(here, hyperparameters), epsilon)
    if learns(rule) or not actions:
        return None
    return np.array([probability_of(rule, q, visits, 0, actions, action) for action in range(actions)])
