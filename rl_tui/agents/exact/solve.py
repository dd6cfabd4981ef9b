"""The exact answer of a world: its optimal values and policy, and, asked for apart, what that earns."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.agents.exact.backward_induction import best_values
from rl_tui.agents.exact.exact_model import ExactModel, exact_model
from rl_tui.agents.exact.policies import uniform_over
from rl_tui.agents.exact.policy_figures import expected_return
from rl_tui.agents.exact.policy_iteration import Optimum, policy_iteration
from rl_tui.agents.exact.solution import NoExactAnswer, Returns, Solution
from rl_tui.agents.exact.ways_out import staying_states
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

TIE: Final = 1e-9


def solve(mdp: TabularMDP, gamma: float, near: FloatArray | None = None) -> Solution:
    """Return the optimal values and policy of ``mdp`` for ``gamma`` in [0, 1], exact to 1e-9.

    Values ``near`` the best, [S], such as those of a world that is almost the same, save time; all that
    depends on them is rounding in the last place.

    Raises NoExactAnswer, in one line, where γ = 1 leaves no best value or γ < 1 is too near to 1 to compute
    it.
    """
    if not 0.0 <= gamma <= 1.0:
        raise ValueError(f"gamma is {gamma}; expected a number in [0, 1]")
    model = exact_model(mdp)
    optimum = policy_iteration(model, gamma, near=near)
    advantage = optimum.advantage
    best = advantage >= np.repeat(model.best(advantage), model.pairs_each) - TIE
    best[optimum.policy] = True  # where values are so large that rounding is more than that
    greedy = ending_ties(model, best) if gamma == 1.0 else best
    return Solution(
        gamma=gamma,
        v=optimum.v[:-1].astype(np.float64),
        q=(optimum.v[model.pair_state] + advantage).astype(np.float64),
        best=best,
        greedy=greedy,
        value_at_start=mdp.average_at_start(optimum.v),
        policy=optimum.policy,
        iterations=optimum.iterations,
    )


def greedy_return(mdp: TabularMDP, solution: Solution) -> float | None:
    """Return what the greedy policy of ``solution``, that of ``mdp``, earns: see :class:`Returns`."""
    return expected_return(mdp, uniform_over(mdp, solution.greedy))


def returns(mdp: TabularMDP, solution: Solution) -> Returns:
    """Return what the greedy policy of ``solution``, that of ``mdp``, and the best policy earn."""
    if mdp.time_limit:
        return Returns(greedy_return(mdp, solution), best_expected_return(mdp))
    if solution.gamma == 1.0 or bool(mdp.terminated.all()):  # nothing is discounted
        best: float | None = solution.value_at_start
        is_best = True
    else:
        optimum = _undiscounted(exact_model(mdp), solution.policy)
        best = None if optimum is None else mdp.average_at_start(optimum.v)
        is_best = optimum is not None and np.array_equal(optimum.policy, solution.policy)
    has_ties = int(solution.greedy.sum()) > len(solution.policy)
    return Returns(best if is_best and not has_ties else greedy_return(mdp, solution), best)


def best_expected_return(mdp: TabularMDP) -> float | None:
    """Return the expected return of the best policy that may look at the clock, within the time limit.

    Without a time limit that of the best policy that ends with probability 1; None where γ = 1 has no answer.
    """
    if mdp.time_limit:
        return mdp.average_at_start(best_values(mdp, 1.0, mdp.time_limit))
    optimum = _undiscounted(exact_model(mdp), None)
    return None if optimum is None else mdp.average_at_start(optimum.v)


def _undiscounted(model: ExactModel, start: IntArray | None) -> Optimum | None:
    """Return the optimum at γ = 1, None where there is none; ``start``, [N] pairs, may be a good policy."""
    try:
        return policy_iteration(model, 1.0, start=start)
    except NoExactAnswer:
        return None


def ending_ties(model: ExactModel, tied: BoolArray) -> BoolArray:
    """Return those of the ``tied`` pairs, [P], among which every choice ends with probability 1.

    ``tied`` marks the best pairs of each live state at γ = 1, by some of which an end can be reached from
    everywhere. A state's rank is the fewest steps in which luck may lead from it to an end by tied pairs. A
    tied pair is dropped if it stays for certain among states in which some choice never ends, and none of
    its outcomes has a lower rank; nothing is dropped where no choice can go on for ever.

    Proof: a choice that may go on for ever would come to a closed set of states, in which some choice never
    ends; so each of its pairs was kept for an outcome of lower rank, which the state of least rank in the
    set cannot have. A choice among best pairs that ends with probability 1 attains V*, since along it
    V*(s) = E[R + V*(S′)] adds up, step by step, to the expected return.
    """
    rank = model.steps_to([model.end], tied)
    lower = rank[model.landing] < rank[model.pair_state][model.outcome_pair]
    descends = np.logical_or.reduceat(lower, model.mdp.first_outcome[:-1])
    if (descends | ~tied).all():
        return tied
    endless = staying_states(model, tied)
    stays = np.logical_and.reduceat(endless[model.landing], model.mdp.first_outcome[:-1])
    return tied & (descends | ~stays)
