"""How near the best a policy comes, in one number that means the same in every world."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rl_tui.agents.exact.policies import uniform_over, uniform_policy
from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.exact.solution import NoExactAnswer
from rl_tui.agents.exact.solve import best_expected_return, solve
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


@dataclass(frozen=True, slots=True)
class Yardstick:
    """What returns in a world are measured by: the best one, and how much is at stake in an episode.

    The share of the best is 1 − (best − return) / stake: 1 for the best policy, less by the same for each
    point of return that is lost. The stake, above 0, is all that an episode of the best policy pays and costs
    together. So where there are only rewards the share is return / best, and where there are only costs it
    is 1 less the extra costs as a share of the least ones: −17 on a cliff of −13 is a share of 0.69.

    ``of_optimal`` is the return of the optimal policy for the world's γ, None where that is not known. It may
    be less than the best, which does not discount, and may look at the clock.
    """

    best: float
    stake: float
    of_optimal: float | None = None

    def share(self, value: float | None) -> float | None:
        """Return the share of the best of a policy that returns ``value``; None where that has no return."""
        return None if value is None else 1.0 - (self.best - value) / self.stake


def yardstick_of(mdp: TabularMDP, gamma: float) -> Yardstick | None:
    """Return what returns in ``mdp`` are measured by, None where no best return is known.

    The best policy whose episodes tell the stake is the one for ``gamma``. Where nothing is at stake in them,
    since the best is to get nothing, it is what a uniformly random policy loses.
    """
    best = best_expected_return(mdp)
    if best is None:
        return None
    of_optimal, turnover = _of_optimal_policy(mdp, gamma)
    stake = max(abs(best), turnover or 0.0)
    if stake == 0.0:
        at_random = expected_return(mdp, uniform_policy(mdp))
        stake = best - at_random if at_random is not None and at_random < best else 1.0
    return Yardstick(best, stake, of_optimal)


def _of_optimal_policy(mdp: TabularMDP, gamma: float) -> tuple[float | None, float | None]:
    """Return the return of the optimal policy, and what an episode of it pays and costs together."""
    try:
        policy = uniform_over(mdp, solve(mdp, gamma).greedy)
    except NoExactAnswer:
        return None, None
    unsigned = replace(mdp, reward=np.abs(mdp.reward))
    return expected_return(mdp, policy), expected_return(unsigned, policy)
