"""Thompson sampling."""

from typing import Final

TABLES: Final = (
    "pulls, paid = new_table(0.0), new_table(0.0)  # how often each arm was pulled, and its rewards"
)

GAUSSIAN: Final = """
def choose(state):
    # Posterior sampling (section 2.10): with the prior N(0, 1) the mean of an arm is distributed as
    # N(total / (σ² + n), σ² / (σ² + n)); draw one from each, and take the arm of the best draw
    spread = np.sqrt(VARIANCE / (VARIANCE + pulls[state]))
    return argmax(rng.normal(paid[state] / (VARIANCE + pulls[state]), spread))
"""

BERNOULLI: Final = """
def choose(state):
    # Posterior sampling (section 2.10): after s wins and f failures the chance of an arm to win is
    # distributed as Beta(1 + s, 1 + f); draw one from each, and take the arm of the best draw
    wins, failures = paid[state], pulls[state] - paid[state]
    return argmax(rng.beta(1 + wins, 1 + failures))
"""

NOTE: Final = """
pulls[state][action] += 1
paid[state][action] += reward
"""

EXPECTED: Final = """
def expected_value(state):
    # Never asked for: every pull ends its episode, so no update looks ahead
    return 0.0
"""
