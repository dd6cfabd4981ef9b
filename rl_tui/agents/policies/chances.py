"""π(a|s) for the screen: the one that the kernels have, interpreted."""

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
"""Each is asked for alone and looks at all of them: interpreted, more would hold up the screen."""

MOST_LOOKS: Final = 200_000
"""Estimates that may be looked at for all states, where each action of each is asked for alone."""


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


def all_chances(
    space: FiniteSpace,
    hyperparameters: Hyperparameters,
    rule: Any,
    epsilon: float,
    q: FloatArray,
    visits: IntArray,
) -> FloatArray | None:
    """Return π(a|s) of every pair, [P], of ``rule``, the one in force, with what it has learned.

    ``epsilon`` is the one in force. None where it has no closed form, as for Thompson sampling, and where so
    many actions are possible that asking for each would take long; ε-greedy is quick in any world.
    """
    if POLICY_BY_ID[hyperparameters.policy].explores_by_epsilon:
        return softened(space, greedy_policy(space, q, hyperparameters.ties), epsilon)
    counts = np.diff(space.first_pair)
    if int(np.dot(counts, counts)) > MOST_LOOKS:
        return None
    now, first_pair = in_force(rule, epsilon), space.first_pair.tolist()
    # lists are read several times as fast as arrays, number by number
    estimates, taken = q.tolist(), visits.tolist()
    chances = np.array(
        [
            probability_of(now, estimates, taken, first, last, pair)
            for first, last in pairwise(first_pair)
            for pair in range(first, last)
        ]
    )
    return None if np.isnan(chances).any() else chances
