"""Value iteration."""

from typing import Final

TEXT: Final = """
# Sweep over all states until no value moves by more than ACCURACY   (equation 4.10)
V = {state: Q[state].max() for state in states}
sweeps, change = 0, np.inf
while change > ACCURACY:
    sweeps, change = sweeps + 1, 0.0
    for state in states:
        # Q(s,a) <- Σ p(s',r|s,a) [r + γ V(s')],  V(s) <- max Q(s,·)
        for action in range(len(Q[state])):
            Q[state][action] = look_ahead(state, action)
        change = max(change, abs(Q[state].max() - V[state]))
        V[state] = Q[state].max()
"""
