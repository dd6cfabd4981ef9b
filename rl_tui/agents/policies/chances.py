"""Action probabilities π(a|s) for the screen, from the interpreted kernels."""

from __future__ import annotations

import importlib
from itertools import pairwise
from typing import Any, Final

import numpy as np

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.exact.policy_figures import greedy_policy, softened
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.policies.family import in_force, learns, probability_of
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray, all_pairs

MOST_ACTIONS: Final = 100
"""Largest number of actions. Each is computed separately, so more would delay the screen."""

MOST_LOOKS: Final = 200_000
"""Largest number of estimates read for all states together."""


def action_chances(
    hyperparameters: Hyperparameters, epsilon: float, q: FloatArray, visits: IntArray
) -> FloatArray | None:
    """Compute π(a|s), [A], of one state from estimates and visits, [A].

    Returns:
        None for more than ``MOST_ACTIONS`` actions, NaN estimates, and policies that learn.
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


def all_chances(
    space: FiniteSpace,
    hyperparameters: Hyperparameters,
    rule: Any,
    epsilon: float,
    q: FloatArray,
    visits: IntArray,
) -> FloatArray | None:
    """Compute π(a|s) of every pair, [P], from the current rule, estimates and visits, [P].

    Returns:
        None without a closed form (Thompson sampling), and if there are too many actions, except for
        ε-greedy.
    """
    if POLICY_BY_ID[hyperparameters.policy].explores_by_epsilon:
        return softened(space, greedy_policy(space, q, hyperparameters.ties), epsilon)
    counts = np.diff(space.first_pair)
    if int(np.dot(counts, counts)) > MOST_LOOKS:
        return None
    now, first_pair = in_force(rule, epsilon), space.first_pair.tolist()
    # reading lists number by number is several times as fast as arrays
    estimates, taken = q.tolist(), visits.tolist()
    chances = np.array(
        [
            probability_of(now, estimates, taken, first, last, pair)
            for first, last in pairwise(first_pair)
            for pair in range(first, last)
        ]
    )
    return None if np.isnan(chances).any() else chances
