"""Policy iteration by linear solve (Sutton & Barto, 2nd ed., section 4.3, box on page 80)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.agents.exact.backward_induction import best_values, model_of
from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray
from rl_tui.agents.exact.policy_evaluation import MOST_DENSE, NoExactAnswer, PolicyChain, may_be_sparse
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

SMALLEST_GAIN: Final = 1e-12
NOISE: Final = 32 * float(np.finfo(np.longdouble).eps)
LONGEST_WARM_UP: Final = 1_000
LONGEST_FROM_NEAR: Final = 250
# After a sweep with relative changes up to this, little is left to improve
AT_REST: Final = 1e-13
BETWEEN_LOOKS: Final = 5
MOST_NAMES: Final = 6


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """Optimal values `v`, [S+1], and advantages q − v, [P].

    `policy`, [N] pairs, is the final one; at γ = 1 it ends with probability 1.
    """

    v: ExtendedArray
    advantage: ExtendedArray
    policy: IntArray
    iterations: int


def policy_iteration(
    model: ExactModel, gamma: float, start: IntArray | None = None, near: FloatArray | None = None
) -> Optimum:
    """Compute the best values over an unlimited horizon.

    At γ = 1 they are the best over all policies that end with probability 1. The search then starts from
    `start`, [N] pairs, if it ends. For γ below 1, values `near` the best, [S], save time and may change the
    last digit.

    Raises:
        NoExactAnswer: At γ = 1 a state cannot reach an end, or a loop gains forever.
    """
    if gamma < 1.0:
        policy = _far_sighted(model, gamma, near)
    elif start is not None and not len(model.endless(_probabilities(model, start) > 0.0)):
        policy = start
    else:
        policy = _way_out(model)
    v = np.zeros(model.end + 1, dtype=np.longdouble)
    seen: set[bytes] = set()
    while True:
        seen.add(policy.tobytes())
        error = PolicyChain(model, _probabilities(model, policy)).solve(gamma, model.is_live, v)
        advantage = model.advantage(v, gamma)
        better = _improved(model, policy, advantage, _least_gain(v, gamma, error))
        # A repeated policy is equally good; only rounding made a difference
        if better.tobytes() in seen:
            return Optimum(v, advantage, policy, len(seen))
        if gamma == 1.0:
            _check_that_it_ends(model, better)
        policy = better


def _least_gain(v: ExtendedArray, gamma: float, error: float) -> float:
    noise = NOISE * float(np.abs(v).max())
    return max(SMALLEST_GAIN, noise, 4 * error) if gamma == 1.0 else max(SMALLEST_GAIN * (1 - gamma), noise)


def _improved(model: ExactModel, policy: IntArray, advantage: ExtendedArray, least_gain: float) -> IntArray:
    # Actions with a gain up to the least one are kept
    highest = model.best(advantage)
    best = np.flatnonzero(advantage == np.repeat(highest, model.pairs_each))
    first = np.flatnonzero(np.diff(model.pair_state[best], prepend=-1))
    return np.where(highest - advantage[policy] > least_gain, best[first], policy)


def _far_sighted(model: ExactModel, gamma: float, near: FloatArray | None) -> IntArray:
    # Greedy for a long finite horizon
    mdp = model.mdp
    if mdp.states <= MOST_DENSE or not may_be_sparse(mdp.states):
        v = best_values(mdp, gamma, min(mdp.states, LONGEST_WARM_UP))
    else:
        v = _swept(model, gamma, near)
    first = mdp.first_pair[model.live]
    return _improved(model, first, model.advantage(np.append(v, 0.0).astype(np.longdouble), gamma), 0.0)


def _swept(model: ExactModel, gamma: float, near: FloatArray | None) -> FloatArray:
    # Until changes are negligible
    from scipy.sparse import csr_array

    mdp = model.mdp
    sweep = model_of(mdp, mdp.reward, gamma)
    shape = mdp.pairs, mdp.states
    following = csr_array((sweep.weight, sweep.next_state, sweep.first_outcome), shape=shape)
    reward, each, first = sweep.pair_reward, int(model.pairs_each[0]), mdp.first_pair[model.live]
    is_even = bool((model.pairs_each == each).all())
    if is_even:  # grouped by action, the best of each state is found four times as fast
        order = np.arange(mdp.pairs).reshape(-1, each).T.ravel()
        following, reward = following[order], reward[order]

    def best_after(v: FloatArray) -> FloatArray:
        of_pairs = reward + following @ v
        best: FloatArray = (
            of_pairs.reshape(each, -1).max(axis=0) if is_even else np.maximum.reduceat(of_pairs, first)
        )
        return best

    starts = [] if near is None else [(near, LONGEST_FROM_NEAR)]
    for start, longest in (*starts, (np.zeros(mdp.states), LONGEST_WARM_UP)):
        v = np.where(model.is_live[:-1], start, 0.0)
        for number in range(1, longest + 1):
            before = v[model.live]
            v[model.live] = best = best_after(v)
            if number % BETWEEN_LOOKS == 0 and np.abs(best - before).max() <= AT_REST * np.abs(best).max():
                return v
    return v


def _way_out(model: ExactModel) -> IntArray:
    # The actions most likely to approach an end, so that every episode ends
    steps = model.steps_to([model.end], np.ones(model.mdp.pairs, dtype=np.bool_))
    lost = model.live[steps[model.live] < 0]
    if len(lost):
        name = model.mdp.state_names[lost[0]]
        raise NoExactAnswer(f"γ = 1: state {name} cannot reach a terminal state; choose γ below 1")
    nearer = steps[model.landing] < steps[model.pair_state][model.outcome_pair]
    chance = np.add.reduceat(np.where(nearer, model.probability, 0.0), model.mdp.first_outcome[:-1])
    return _improved(model, model.mdp.first_pair[model.live], chance, 0.0)


def _check_that_it_ends(model: ExactModel, policy: IntArray) -> None:
    # Improving an ending policy never ends if a loop gains on average
    usable = _probabilities(model, policy) > 0.0
    endless = model.endless(usable)
    if len(endless):
        loop = _names(model, _loop_from(model, usable, int(endless[0])))
        raise NoExactAnswer(f"γ = 1: the loop through {loop} earns without end; choose γ below 1")


def _names(model: ExactModel, states: IntArray) -> str:
    names = [model.mdp.state_names[state] for state in states]
    if len(names) > MOST_NAMES:
        names[MOST_NAMES:] = [f"{len(names) - MOST_NAMES} more"]
    return ", ".join(names)


def _loop_from(model: ExactModel, usable: BoolArray, state: int) -> IntArray:
    # A loop from `state` that `usable` pairs, [P], never leave
    used = usable[model.outcome_pair]
    source, target = model.pair_state[model.outcome_pair][used], model.landing[used]
    while True:
        reached = np.zeros(model.end + 1, dtype=np.bool_)
        reached[state] = True
        count = 0
        while count < (count := int(reached.sum())):
            reached[target[reached[source]]] = True
        no_way_back = reached & (model.steps_to([state], usable) < 0)
        if not no_way_back.any():
            return np.flatnonzero(reached)
        state = int(np.argmax(no_way_back))


def _probabilities(model: ExactModel, policy: IntArray) -> FloatArray:
    result = np.zeros(model.mdp.pairs)
    result[policy] = 1.0
    return result
