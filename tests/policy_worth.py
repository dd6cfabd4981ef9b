"""The exact value of a policy, for tests."""

from __future__ import annotations

from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policy_evaluation import PolicyChain, PolicyValue
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def evaluate(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyValue:
    """Return the exact value of ``policy``, [P]. Raises NoExactAnswer if rounding would spoil it."""
    return PolicyChain(exact_model(mdp), policy).value(gamma)
