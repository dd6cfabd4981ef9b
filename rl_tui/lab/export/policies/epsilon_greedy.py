"""ε-greedy."""

from typing import Final

TEXT: Final = """
def choose(state):
    # ε-greedy (section 2.2): the best action, but with probability ε any
    if rng.random() < $epsilon:
        return int(rng.integers(len(Q[state])))
    return argmax(Q[state])
"""

EXPECTED: Final = """
def expected_value(state):
    # Σ π(a|s) Q(s,a): the best with probability 1 - ε, and with ε the mean of all
    return (1 - $epsilon) * Q[state].max() + $epsilon * Q[state].mean()
"""
