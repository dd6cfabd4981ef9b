"""Policy iteration."""

from typing import Final

TEXT: Final = """
# Begin with the policy that takes every action equally often   (box on page 80)
policy = {state: np.full(len(Q[state]), 1 / len(Q[state])) for state in states}
V = {state: Q[state].mean() for state in states}
sweeps, is_stable = 0, False
while not is_stable:
    # Policy evaluation: V(s) <- Σ π(a|s) Σ p(s',r|s,a) [r + γ V(s')]
    change = np.inf
    while change > ACCURACY:
        sweeps, change = sweeps + 1, 0.0
        for state in states:
            for action in range(len(Q[state])):
                Q[state][action] = look_ahead(state, action)
            value = policy[state] @ Q[state]
            change = max(change, abs(value - V[state]))
            V[state] = value
    # Policy improvement: π(s) <- argmax Q(s,·), wherever that gains anything
    sweeps, is_stable = sweeps + 1, True
    for state in states:
        for action in range(len(Q[state])):
            Q[state][action] = look_ahead(state, action)
        slack = 1e-9 * max(1.0, abs(Q[state].max()))
        if policy[state] @ Q[state] < Q[state].max() - slack:
            is_stable = False
            best = Q[state] >= Q[state].max() - slack
            $improve
"""

AMONG_EQUALS: Final = "policy[state] = best / best.sum()"
FIRST_OF_EQUALS: Final = "policy[state] = np.eye(len(best))[np.argmax(best)]"
