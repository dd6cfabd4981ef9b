"""The gradient bandit."""

from typing import Final

TABLES: Final = """
H = new_table(0.0)  # how much each arm is preferred
mean_reward, rewards = 0.0, 0
"""

TEXT: Final = """
def probabilities(state):
    # π(a) = exp H(a) / Σ exp H(b)   (equation 2.11); less the greatest, which cancels out
    weights = np.exp(H[state] - H[state].max())
    return weights / weights.sum()


def choose(state):
    return int(rng.choice(len(H[state]), p=probabilities(state)))
"""

NOTE: Final = """
# H(A) <- H(A) + α (R - R̄)(1 - π(A)), H(a) <- H(a) - α (R - R̄) π(a)   (equation 2.12)
taken = np.eye(len(H[state]))[action]
$baseline
H[state] += $policy_alpha * (reward - baseline) * (taken - probabilities(state))
$mean
"""
BASELINE: Final = "baseline = mean_reward if rewards else reward  # the mean of the rewards before this one"
NO_BASELINE: Final = "baseline = 0.0"
MEAN: Final = """rewards += 1
mean_reward += (reward - mean_reward) / rewards"""

EXPECTED: Final = """
def expected_value(state):
    # Σ π(a|s) Q(s,a)
    return probabilities(state) @ Q[state]
"""
