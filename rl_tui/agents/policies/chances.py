"""The probability of each action under a policy, for the screen: the kernels themselves only draw."""

from __future__ import annotations

import math

import numpy as np

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.worlds.mdp.space import FloatArray, IntArray


def action_chances(
    hyperparameters: Hyperparameters, epsilon: float, q: FloatArray, visits: IntArray
) -> FloatArray | None:
    """Return π(a|s) of the A actions of one state, [A], from their estimates and visits, [A] each.

    ``epsilon`` is the one in force. None for policies that keep a memory of their own, as those for bandits
    do.
    """
    if not len(q):
        return np.empty(0)
    if hyperparameters.policy == "epsilon-greedy":
        return (1.0 - epsilon) * _shared(q, hyperparameters) + epsilon / len(q)
    if hyperparameters.policy == "softmax":
        weight = np.exp((q - q.max()) / hyperparameters.temperature)
        return np.asarray(weight / weight.sum())
    if hyperparameters.policy == "ucb":
        return _shared(_upper_bounds(q, visits, hyperparameters.confidence), hyperparameters)
    return None


def _shared(preference: FloatArray, hyperparameters: Hyperparameters) -> FloatArray:
    """Return the chances where the most preferred is taken: ties share, or the first has all."""
    best = preference == preference.max()
    if hyperparameters.ties == "random":
        return np.asarray(best / best.sum())
    chances = np.zeros(len(preference))
    chances[int(np.argmax(best))] = 1.0
    return chances


def _upper_bounds(q: FloatArray, visits: IntArray, confidence: float) -> FloatArray:
    """Return Q + c √(ln t / N), infinite for what was never tried (equation 2.10)."""
    log_time = math.log(1 + int(visits.sum()))
    bounds = np.full(len(q), math.inf)
    tried = visits > 0
    bounds[tried] = q[tried] + confidence * np.sqrt(log_time / visits[tried])
    return bounds
