"""The box on page 80, line by line, from the policy that takes all actions equally.

As in exercise 4.4, a state keeps its policy unless another action gains something. The order of the sweeps
may be given, as in section 4.6.
"""

import math
from collections.abc import Mapping

from plain_value_iteration import look_ahead

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def plain_policy_iteration(
    mdp: TabularMDP, hyperparameters: Hyperparameters, steps: int, orders: Mapping[int, str] | None = None
) -> tuple[dict[int, float], int, bool]:
    """``orders`` maps the number of a sweep, from 0, to evaluation or improvement."""
    q = dict.fromkeys(range(mdp.pairs), hyperparameters.initial_q)
    states = [state for state in range(mdp.states) if mdp.pairs_of(state)]
    v = dict.fromkeys(states, hyperparameters.initial_q)
    policy = {pair: 1 / len(mdp.pairs_of(state)) for state in states for pair in mdp.pairs_of(state)}
    orders = orders or {}

    def expected(state: int) -> float:
        total = 0.0
        for pair in mdp.pairs_of(state):
            q[pair] = look_ahead(mdp, v, hyperparameters.gamma, pair)
            total += policy[pair] * q[pair]
        return total

    def improved(state: int) -> bool:
        worth = expected(state)
        best = max(q[pair] for pair in mdp.pairs_of(state))
        slack = 1e-9 * max(1.0, abs(best))
        if worth >= best - slack:
            return False
        tied = [pair for pair in mdp.pairs_of(state) if q[pair] >= best - slack]
        chosen = tied if hyperparameters.ties == "random" else tied[:1]
        for pair in mdp.pairs_of(state):
            policy[pair] = 1 / len(chosen) if pair in chosen else 0.0
        return True

    taken, sweep, due = 0, 0, "evaluation"
    delta = math.inf  # the largest change in the last evaluation of the current policy
    while True:
        phase = orders.get(sweep, due)
        sweep += 1
        stable, delta = True, 0.0 if phase == "evaluation" else delta
        for state in states:
            if taken == steps:
                return q, taken, False
            taken += 1
            if phase == "evaluation":
                before, v[state] = v[state], expected(state)
                delta = max(delta, abs(before - v[state]))
            elif improved(state):
                stable = False
        at_rest = delta <= hyperparameters.accuracy
        if phase == "improvement" and stable and at_rest:
            return q, taken, True
        if not stable:
            delta = math.inf
        due = "improvement" if phase == "evaluation" and at_rest else "evaluation"
