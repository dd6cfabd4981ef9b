"""Softmax."""

from typing import Final

TEXT: Final = """
def probabilities(state):
    # π(a|s) = exp(Q(s,a)/τ) / Σ exp(Q(s,b)/τ)   (exercise 2.9); the greatest cancels out
    weights = np.exp((Q[state] - Q[state].max()) / TEMPERATURE)
    return weights / weights.sum()


def choose(state):
    return int(rng.choice(len(Q[state]), p=probabilities(state)))
"""

EXPECTED: Final = """
def expected_value(state):
    # Σ π(a|s) Q(s,a)
    return probabilities(state) @ Q[state]
"""
