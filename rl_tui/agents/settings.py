"""The hyper-parameters as the kernels take them."""

from __future__ import annotations

from typing import NamedTuple

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Hyperparameters


class Settings(NamedTuple):
    """What an update rule is told. ``alpha`` does not count where ``sample_average`` is true."""

    alpha: float
    sample_average: bool
    gamma: float


class EpsilonGreedy(NamedTuple):
    """The ε-greedy action rule; ``random_ties`` is false where the first of equal best actions is taken."""

    epsilon: float
    epsilon_min: float
    epsilon_decay: float
    random_ties: bool


def settings_of(hyperparameters: Hyperparameters) -> Settings:
    """Return the part that the update rule uses."""
    alpha = hyperparameters.alpha
    sample_average = alpha == SAMPLE_AVERAGE
    return Settings(0.0 if isinstance(alpha, str) else alpha, sample_average, hyperparameters.gamma)


def action_rule_of(hyperparameters: Hyperparameters) -> EpsilonGreedy:
    """Return the part that chooses actions."""
    return EpsilonGreedy(
        hyperparameters.epsilon,
        hyperparameters.epsilon_min,
        hyperparameters.epsilon_decay,
        hyperparameters.ties == "random",
    )
