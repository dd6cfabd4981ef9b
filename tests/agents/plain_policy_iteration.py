"""The box of page 80 as it is printed, from the policy that takes all actions equally.

As in exercise 4.4, the policy of a state is left alone where no other gains anything.
"""

import math

from plain_value_iteration import look_ahead

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def plain_policy_iteration(
    mdp: TabularMDP, hyperparameters: Hyperparameters, steps: int
) -> tuple[dict[int, float], int, bool]:
    """Return Q, the steps taken and whether the policy came to rest."""
    q = dict.fromkeys(range(mdp.pairs), hyperparameters.initial_q)
    states = [state for state in range(mdp.states) if mdp.pairs_of(state)]
    v = dict.fromkeys(states, hyperparameters.initial_q)
    policy = {pair: 1 / len(mdp.pairs_of(state)) for state in states for pair in mdp.pairs_of(state)}
    taken = 0

    def expected(state: int) -> float:
        total = 0.0
        for pair in mdp.pairs_of(state):
            q[pair] = look_ahead(mdp, v, hyperparameters.gamma, pair)
            total += policy[pair] * q[pair]
        return total

    while True:
        delta = math.inf
        while delta > hyperparameters.accuracy:
            delta = 0.0
            for state in states:
                if taken == steps:
                    return q, taken, False
                taken += 1
                before, v[state] = v[state], expected(state)
                delta = max(delta, abs(before - v[state]))
        stable = True
        for state in states:
            if taken == steps:
                return q, taken, False
            taken += 1
            worth = expected(state)
            best = max(q[pair] for pair in mdp.pairs_of(state))
            slack = 1e-9 * max(1.0, abs(best))
            if worth < best - slack:
                stable = False
                tied = [pair for pair in mdp.pairs_of(state) if q[pair] >= best - slack]
                chosen = tied if hyperparameters.ties == "random" else tied[:1]
                for pair in mdp.pairs_of(state):
                    policy[pair] = 1 / len(chosen) if pair in chosen else 0.0
        if stable:
            return q, taken, True
