"""The box on page 83, line by line. A sweep stops early when the steps are used up."""

import math

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def plain_value_iteration(
    mdp: TabularMDP, hyperparameters: Hyperparameters, steps: int
) -> tuple[dict[int, float], int, bool]:
    q = dict.fromkeys(range(mdp.pairs), hyperparameters.initial_q)
    states = [state for state in range(mdp.states) if mdp.pairs_of(state)]
    v = dict.fromkeys(states, hyperparameters.initial_q)
    taken, delta = 0, math.inf
    while delta > hyperparameters.accuracy:
        delta = 0.0
        for state in states:
            if taken == steps:
                return q, taken, False
            taken += 1
            for pair in mdp.pairs_of(state):
                q[pair] = look_ahead(mdp, v, hyperparameters.gamma, pair)
            before, v[state] = v[state], max(q[pair] for pair in mdp.pairs_of(state))
            delta = max(delta, abs(before - v[state]))
    return q, taken, True


def look_ahead(mdp: TabularMDP, v: dict[int, float], gamma: float, pair: int) -> float:
    reward, value = 0.0, 0.0
    for outcome in mdp.outcomes_of(pair):
        reward += float(mdp.probability[outcome] * mdp.reward[outcome])
        if not mdp.terminated[outcome]:
            value += float(mdp.probability[outcome] * v[int(mdp.next_state[outcome])])
    return reward + gamma * value
