"""The exact solution of a world."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.agents.exact.backward_induction import best_values
from rl_tui.agents.exact.exact_model import ExactModel, Ways, exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, Returns, Solution
from rl_tui.agents.exact.policy_figures import expected_return, uniform_over
from rl_tui.agents.exact.policy_iteration import Optimum, policy_iteration
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Reachable and endless states


def endless_states(mdp: TabularMDP) -> BoolArray:
    """Return the reachable states, [S], that never end under any policy."""
    return np.zeros(mdp.states, dtype=np.bool_) if mdp.time_limit else states_without_end(mdp)


def states_without_end(mdp: TabularMDP) -> BoolArray:
    """Return :func:`endless_states` without the time limit.

    There are none if only the time limit ends episodes, because then it is the end.
    """
    live = _is_live(mdp)
    endless = live & ~_comes_to_an_end(mdp, np.ones(len(mdp.next_state), dtype=np.bool_))
    return np.zeros_like(endless) if mdp.time_limit and (endless == live).all() else endless


def endless_part(mdp: TabularMDP, policy: FloatArray) -> int | None:
    """Return a state that `policy`, [P], may reach and that never ends, or None.

    The time limit is ignored. A finite chain runs forever with positive probability exactly if there is one.
    """
    followed = policy[mdp.outcome_pair] > 0.0
    goes_on = followed & ~mdp.terminated
    edges_before = np.append(0, np.cumsum(goes_on))
    first_edge = edges_before[mdp.first_outcome[mdp.first_pair]]
    reached = reachable(first_edge, mdp.next_state[goes_on], mdp.start_state[mdp.start_probability > 0.0])
    lost = np.flatnonzero(reached & _is_live(mdp) & ~_comes_to_an_end(mdp, followed))
    return int(lost[0]) if len(lost) else None


def steps_from_start(mdp: TabularMDP) -> IntArray:
    """Return the fewest steps, [S], from a start, or −1, without a time limit."""
    ways = Ways(mdp.next_state, mdp.pair_state[mdp.outcome_pair], mdp.states)
    return ways.steps_to(mdp.start_state[mdp.start_probability > 0.0].tolist())


def never_reached(mdp: TabularMDP) -> IntArray:
    """Return the states, [N], that cannot be reached within the time limit."""
    steps = steps_from_start(mdp)
    is_too_far = steps > mdp.time_limit if mdp.time_limit else np.zeros(mdp.states, dtype=np.bool_)
    return np.flatnonzero((steps < 0) | is_too_far)


def shortest_way(mdp: TabularMDP, usable: BoolArray) -> int | None:
    """Return the fewest steps to an end by `usable` pairs, [P], or None.

    The time limit is ignored.
    """
    model = exact_model(mdp)
    from_start = model.steps_to([model.end], usable)[mdp.start_state[mdp.start_probability > 0.0]]
    known = from_start[from_start >= 0]
    return int(known.min()) if len(known) else None


def staying_states(model: ExactModel, usable: BoolArray) -> BoolArray:
    """Return the states, [S+1], where some choice among the `usable` pairs, [P], never ends.

    Each has a usable pair with all outcomes inside this largest set.
    """
    inside = model.is_live
    used = usable[model.outcome_pair]
    source, target = model.outcome_pair[used], model.landing[used]
    order = np.argsort(target, kind="stable")
    arriving = source[order].tolist()
    first = np.searchsorted(target[order], np.arange(model.end + 2)).tolist()
    owner = model.pair_state.tolist()
    stays = usable.tolist()
    staying = np.bincount(model.pair_state[usable], minlength=model.end + 1).tolist()
    outside = np.flatnonzero(~inside).tolist()
    for state in outside:
        for pair in arriving[first[state] : first[state + 1]]:
            if stays[pair]:
                stays[pair] = False
                staying[owner[pair]] -= 1
                if staying[owner[pair]] == 0:
                    outside.append(owner[pair])
    inside[outside] = False
    return inside


def _is_live(mdp: TabularMDP) -> BoolArray:
    return np.asarray(np.diff(mdp.first_pair) > 0)


def _comes_to_an_end(mdp: TabularMDP, usable: BoolArray) -> BoolArray:
    source = mdp.pair_state[mdp.outcome_pair]
    goes_on = usable & ~mdp.terminated
    ways = Ways(source[goes_on], mdp.next_state[goes_on], mdp.states)
    return ways.leading_to(np.unique(source[usable & mdp.terminated]))


# Optimal values and policy


TIE: Final = 1e-9


def solve(mdp: TabularMDP, gamma: float, near: FloatArray | None = None) -> Solution:
    """Compute the optimal values and policy, exact to 1e-9.

    Values `near` the best, [S], save time and may change the last digit.

    Raises:
        NoExactAnswer: At γ = 1 there is no best value, or γ is too close to 1 to compute it.
        ValueError: `gamma` is out of range.
    """
    if not 0.0 <= gamma <= 1.0:
        raise ValueError(f"gamma is {gamma}; expected a number in [0, 1]")
    model = exact_model(mdp)
    optimum = policy_iteration(model, gamma, near=near)
    advantage = optimum.advantage
    best = advantage >= np.repeat(model.best(advantage), model.pairs_each) - TIE
    best[optimum.policy] = True  # in case values are so large that rounding exceeds the tolerance
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
    """Return the return of the greedy policy; see :class:`Returns`."""
    return expected_return(mdp, uniform_over(mdp, solution.greedy))


def returns(mdp: TabularMDP, solution: Solution) -> Returns:
    """Return both returns."""
    if mdp.time_limit:
        return Returns(greedy_return(mdp, solution), best_expected_return(mdp))
    if solution.gamma == 1.0 or bool(mdp.terminated.all()):  # discounting has no effect
        best: float | None = solution.value_at_start
        is_best = True
    else:
        optimum = _undiscounted(exact_model(mdp), solution.policy)
        best = None if optimum is None else mdp.average_at_start(optimum.v)
        is_best = optimum is not None and np.array_equal(optimum.policy, solution.policy)
    has_ties = int(solution.greedy.sum()) > len(solution.policy)
    return Returns(best if is_best and not has_ties else greedy_return(mdp, solution), best)


def best_expected_return(mdp: TabularMDP) -> float | None:
    """Return the return of the best policy, which may use the elapsed time.

    Without a time limit it must end with probability 1; None if γ = 1 has no answer.
    """
    if mdp.time_limit:
        return mdp.average_at_start(best_values(mdp, 1.0, mdp.time_limit))
    optimum = _undiscounted(exact_model(mdp), None)
    return None if optimum is None else mdp.average_at_start(optimum.v)


def _undiscounted(model: ExactModel, start: IntArray | None) -> Optimum | None:
    # `start`, [N] pairs, saves time
    try:
        return policy_iteration(model, 1.0, start=start)
    except NoExactAnswer:
        return None


def ending_ties(model: ExactModel, tied: BoolArray) -> BoolArray:
    """Return the `tied` pairs, [P], among which every choice ends with probability 1.

    They are the best pairs of each live state at γ = 1. The rank of a state is the fewest steps to an end by
    tied pairs. A tied pair is dropped if it stays among states in which some choice never ends, and none of
    its outcomes has a lower rank.

    Proof: a choice that may run forever would reach a closed set of such states. Each of its pairs was kept
    because of an outcome with lower rank, which is impossible for the state of least rank.
    """
    rank = model.steps_to([model.end], tied)
    lower = rank[model.landing] < rank[model.pair_state][model.outcome_pair]
    descends = np.logical_or.reduceat(lower, model.mdp.first_outcome[:-1])
    if (descends | ~tied).all():
        return tied
    endless = staying_states(model, tied)
    stays = np.logical_and.reduceat(endless[model.landing], model.mdp.first_outcome[:-1])
    return tied & (descends | ~stays)
