"""The exact value of a policy, for tests."""

from __future__ import annotations

from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policy_evaluation import PolicyChain, PolicyValue
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def evaluate(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyValue:
    """Return the exact value of ``policy``, [P] probabilities that sum to 1 in each state.

    There is no time limit; ``gamma`` is in [0, 1]. At γ = 1 an endless part without rewards adds 0. Raises
    NoExactAnswer if rounding would spoil the value.
    """
    return PolicyChain(exact_model(mdp), policy).value(gamma)
