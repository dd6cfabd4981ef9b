"""Exact evaluation of any policy over an unlimited horizon (Sutton & Barto, 2nd ed., equation 4.4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray, exact_model
from rl_tui.agents.exact.solution import NoExactAnswer
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST_ROUNDS: Final = 50
PRECISION: Final = 1e-10
RELATIVE_PRECISION: Final = 1e-15
# Up to so many states the matrix is dense
MOST_DENSE: Final = 400

Solver = Callable[[FloatArray], FloatArray]


class SingularMatrixError(Exception):
    """The matrix has no inverse in floating-point numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class PolicyValue:
    """The values ``v``, [S], of a policy; 0 where a state owns no pair.

    NaN, at γ = 1 only, where the policy may run for ever into a part of the world that goes on paying.
    ``at_start`` is the average over the start distribution, None where that meets a NaN.
    """

    v: FloatArray
    at_start: float | None


def evaluate(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyValue:
    """Return the exact value of ``policy``, [P] probabilities that sum to 1 in each state.

    There is no time limit; ``gamma`` is in [0, 1]. At γ = 1 an endless part that pays nothing adds 0. Raises
    NoExactAnswer where rounding would spoil the answer.
    """
    model = exact_model(mdp)
    return policy_value(model, policy, gamma)


def policy_value(model: ExactModel, policy: FloatArray, gamma: float) -> PolicyValue:
    """Return what :func:`evaluate` does, of a model at hand."""
    if gamma == 1.0:
        v = _undiscounted(model, policy)
    else:
        v = np.zeros(model.end + 1, dtype=np.longdouble)
        solve_chain(model, policy, gamma, model.is_live, v)
    at_start = model.mdp.average_at_start(v)
    return PolicyValue(v[:-1].astype(np.float64), None if np.isnan(at_start) else at_start)


def ending_probability(model: ExactModel, policy: FloatArray) -> float:
    """Return the probability that ``policy``, [P], ever ends an episode that starts at the start."""
    can_end, may_fail = _ways_to_end(model, policy)
    chance = np.where(can_end, 1.0, 0.0).astype(np.longdouble)
    unsure = can_end & may_fail
    chance[unsure] = 0.0
    solve_chain(model, policy, 1.0, unsure, chance, np.zeros_like(model.reward))
    return min(1.0, max(0.0, model.mdp.average_at_start(chance)))


def always_ends(mdp: TabularMDP, policy: FloatArray) -> bool:
    """Return True if ``policy``, [P], ends every episode with probability 1, given time enough."""
    _, may_fail = _ways_to_end(exact_model(mdp), policy)
    return not may_fail[mdp.start_state].any()


def _ways_to_end(model: ExactModel, policy: FloatArray) -> tuple[BoolArray, BoolArray]:
    """Return from which states, [S+1], ``policy`` may come to an end, and from which it may never do so."""
    usable = policy > 0.0
    can_end = model.steps_to([model.end], usable) >= 0
    return can_end, model.steps_to(np.flatnonzero(~can_end[:-1]), usable) >= 0


def _undiscounted(model: ExactModel, policy: FloatArray) -> ExtendedArray:
    """Return the values at γ = 1, [S+1], NaN where there are none."""
    usable = policy > 0.0
    paying = model.pair_state[model.outcome_pair[(model.reward != 0.0) & usable[model.outcome_pair]]]
    to_be_paid = model.steps_to(np.unique(paying), usable) >= 0
    # A state from which no end and no part without rewards can be reached is paid for ever
    settled = np.flatnonzero(~to_be_paid)
    endless = model.steps_to(settled, usable) < 0
    undefined = model.steps_to(np.flatnonzero(endless), usable) >= 0
    v = np.zeros(model.end + 1, dtype=np.longdouble)
    solve_chain(model, policy, 1.0, to_be_paid & ~undefined, v)
    v[undefined] = np.nan
    return v


def solve_chain(
    model: ExactModel,
    policy: FloatArray,
    gamma: float,
    unknown: BoolArray,
    v: ExtendedArray,
    reward: ExtendedArray | None = None,
) -> float:
    """Set v(s) = E[R + γ v(S′)] in the ``unknown`` states, given ``v``, [S+1], in all others.

    ``unknown``, [S+1], marks live states from which ``policy`` comes to others where γ = 1. ``reward``, [O],
    takes the place of the world's own. Returns what rounding may have left, judged by the last correction.

    Raises NoExactAnswer where that is more than 1e-10 (and 1e-15 of the largest value).
    """
    if not unknown.any():
        return 0.0
    weights = policy.astype(np.longdouble)
    inside = unknown[model.live]
    places = model.live[inside]
    try:
        solver = _chain_solver(model, policy, gamma, unknown)
    except SingularMatrixError:
        raise _too_ill_conditioned(gamma) from None
    error = np.inf
    for _ in range(MOST_ROUNDS):
        residual = model.mixed(weights, model.advantage(v, gamma, reward))[inside]
        correction = solver(residual.astype(np.float64))
        v[places] += correction
        before, error = error, float(np.abs(correction).max())
        scale = float(np.abs(v[places]).max())
        if error <= np.finfo(np.longdouble).eps * scale or not error < before / 2:
            break
    if not error <= max(PRECISION, RELATIVE_PRECISION * scale):
        raise _too_ill_conditioned(gamma)
    return error


def _chain_solver(model: ExactModel, policy: FloatArray, gamma: float, unknown: BoolArray) -> Solver:
    """Return the solver of I − γ P under ``policy``, restricted to the ``unknown`` states."""
    index = np.cumsum(unknown) - 1
    size = int(index[-1]) + 1
    source = model.pair_state[model.outcome_pair]
    weight = policy[model.outcome_pair] * model.probability.astype(np.float64)
    leaving = unknown[source] & (model.landing != source) & (weight > 0.0)
    staying_inside = leaving & unknown[model.landing]
    rows, columns = index[source[staying_inside]], index[model.landing[staying_inside]]
    # Summed from what leaves, the diagonal keeps the digits that 1 − γ p(s | s) would lose
    left = np.bincount(index[source[leaving]], weights=weight[leaving], minlength=size)
    diagonal = np.arange(size)
    solver_of = _dense if size <= MOST_DENSE else _sparse
    return solver_of(
        np.concatenate((rows, diagonal)),
        np.concatenate((columns, diagonal)),
        np.concatenate((-gamma * weight[staying_inside], (1.0 - gamma) + gamma * left)),
        size,
    )


def _too_ill_conditioned(gamma: float) -> NoExactAnswer:
    if gamma < 1.0:
        return NoExactAnswer(f"γ = {gamma!r} is too near to 1 for an exact answer; choose a smaller γ")
    return NoExactAnswer("γ = 1: an end is too unlikely for an exact answer; choose γ below 1")


def _dense(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    """Return the function b → A⁻¹ b for A, [size, size], with these entries, summed where they meet.

    Raises :class:`SingularMatrixError`.
    """
    matrix = np.bincount(rows * size + columns, weights=entries, minlength=size * size).reshape(size, size)
    try:
        inverse: FloatArray = np.linalg.inv(matrix)
    except np.linalg.LinAlgError as fault:
        raise SingularMatrixError from fault
    return lambda right: inverse @ right


def _sparse(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    """Return what :func:`_dense` does, without taking memory for all that is 0."""
    # scipy takes a quarter of a second to import and most worlds never need it
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        factors = splu(csc_matrix((entries, (rows, columns)), shape=(size, size)))
    except RuntimeError as fault:
        raise SingularMatrixError from fault
    solve: Solver = factors.solve
    return solve
