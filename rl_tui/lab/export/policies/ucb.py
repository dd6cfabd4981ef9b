"""Upper confidence bounds."""

from typing import Final

TEXT: Final = """
def bounds(state):
    # Q(s,a) + c √(ln t / N(s,a))   (equation 2.10); what was never tried comes before all else
    log_t = np.log(N[state].sum() + 1)
    bonus = CONFIDENCE * np.sqrt(log_t / np.maximum(N[state], 1))
    return np.where(N[state] == 0, np.inf, Q[state] + bonus)


def choose(state):
    return argmax(bounds(state))
"""

EXPECTED: Final = """
def expected_value(state):
    # Σ π(a|s) Q(s,a): it takes what has the highest bound
    highest = bounds(state)
    return $among_highest
"""
AMONG_EQUALS: Final = "Q[state][highest == highest.max()].mean()"
FIRST_OF_EQUALS: Final = "Q[state][argmax(highest)]"
