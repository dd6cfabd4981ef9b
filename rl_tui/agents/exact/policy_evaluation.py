"""Exact values of a policy over an unlimited horizon (Sutton & Barto, 2nd ed., equation 4.4).

``Solution`` holds the optimal values and policy, which ``solve`` computes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray, Ways, exact_model
from rl_tui.common.errors import UserError
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# The exact solution of a world


class NoExactAnswer(UserError):  # noqa: N818 - it is an answer
    """There is no exact answer, for example because a loop gains forever at γ = 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Optimal values and policy for an unlimited horizon.

    Args:
        gamma: The discount.
        v: Value of each state, [S]; 0 for states without pairs.
        q: Value of each pair, [P].
        best: True for pairs within 1e-9 of the best of their state, [P].
        greedy: The best pairs shown as the optimal policy, [P]. At γ = 1 these are
            :func:`~rl_tui.agents.exact.solve.ending_ties`, because other choices among the best pairs may
            never end.
        value_at_start: Mean of `v` over the start distribution.
        policy: The evaluated policy, [N] pairs of the live states.
        iterations: Number of policies that policy iteration evaluated.
    """

    gamma: float
    v: FloatArray
    q: FloatArray
    best: BoolArray
    greedy: BoolArray
    value_at_start: float
    policy: IntArray
    iterations: int


class Returns(NamedTuple):
    """Undiscounted returns within the time limit.

    Without a time limit the horizon is unlimited, and None means no answer.

    Args:
        expected_return: Return of the greedy policy of a solution, uniform over ties.
        best_expected_return: Return of the best policy, which may use the elapsed time.
    """

    expected_return: float | None
    best_expected_return: float | None


# Evaluation of a policy


MOST_ROUNDS: Final = 50
PRECISION: Final = 1e-10
RELATIVE_PRECISION: Final = 1e-15
# Largest number of states with a dense matrix
MOST_DENSE: Final = 400

Solver = Callable[[FloatArray], FloatArray]


class SingularMatrixError(Exception):
    """The matrix has no inverse in floating-point numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class PolicyValue:
    """Values of a policy.

    Args:
        v: Value of each state, [S]; 0 for states without pairs. NaN, at γ = 1 only, if the policy may collect
            rewards forever.
        at_start: Mean over the start distribution, or None if that involves NaN.
    """

    v: FloatArray
    at_start: float | None


class _Moves(NamedTuple):
    """All n outcomes possible under a policy, in the order of the N live states.

    `source`, `outcome`, `target` and `weight` (its probability) are [n]. The outcomes of a live state begin
    at `first` and have the sum `total`, [N] each.
    """

    source: IntArray
    outcome: IntArray
    target: IntArray
    weight: ExtendedArray
    first: IntArray
    total: ExtendedArray


def _moves_of(model: ExactModel, policy: FloatArray) -> _Moves:
    """Return the possible outcomes under `policy`, [P]."""
    outcome = np.flatnonzero((policy > 0.0)[model.outcome_pair])
    pair = model.outcome_pair[outcome]
    source = model.pair_state[pair]
    weight = policy[pair] * model.probability[outcome]
    first = np.flatnonzero(np.diff(source, prepend=-1))
    total: ExtendedArray = np.add.reduceat(weight, first)
    return _Moves(source, outcome, model.landing[outcome], weight, first, total)


class PolicyChain:
    """The Markov chain of a policy, and its exact figures over an unlimited horizon.

    Searches and factorizations are reused. Each figure raises NoExactAnswer if rounding would spoil it.

    Args:
        model: The world.
        policy: Probability of each pair, [P].
    """

    def __init__(self, model: ExactModel, policy: FloatArray) -> None:
        self._model = model
        self._moves = _moves_of(model, policy)
        self._ways: Ways | None = None
        self._endings: tuple[BoolArray, BoolArray] | None = None
        # only the latest, because a large world takes hundreds of megabytes
        self._factorised: tuple[float, bytes] | None = None
        self._solver: Solver | None = None

    def value(self, gamma: float) -> PolicyValue:
        """Return the values for `gamma` in [0, 1]. At γ = 1 an endless part without rewards adds 0."""
        model = self._model
        if gamma == 1.0:
            v = self._undiscounted()
        else:
            v = np.zeros(model.end + 1, dtype=np.longdouble)
            self.solve(gamma, model.is_live, v)
        at_start = model.mdp.average_at_start(v)
        return PolicyValue(v[:-1].astype(np.float64), None if np.isnan(at_start) else at_start)

    def chance_of_ending(self) -> float:
        """Return the probability that an episode ever ends."""
        can_end, may_fail = self._find_endings()
        chance = np.where(can_end, 1.0, 0.0).astype(np.longdouble)
        unsure = can_end & may_fail
        chance[unsure] = 0.0
        self.solve(1.0, unsure, chance, np.zeros_like(self._model.reward))
        return min(1.0, max(0.0, self._model.mdp.average_at_start(chance)))

    def expected_length(self) -> float | None:
        """Return the expected number of steps of an episode, or None if it may never end."""
        if not self.always_ends():
            return None
        _, may_fail = self._find_endings()
        length = np.zeros(self._model.end + 1, dtype=np.longdouble)
        self.solve(1.0, self._model.is_live & ~may_fail, length, np.ones_like(self._model.reward))
        return self._model.mdp.average_at_start(length)

    def always_ends(self) -> bool:
        """Return True if every episode ends with probability 1, given enough time."""
        _, may_fail = self._find_endings()
        return not may_fail[self._model.mdp.start_state].any()

    def solve(
        self, gamma: float, unknown: BoolArray, v: ExtendedArray, reward: ExtendedArray | None = None
    ) -> float:
        """Solve v(s) = E[R + γ v(S′)] for some states, given the values of all others.

        Args:
            gamma: Discount, 0 to 1.
            unknown: True for the live states to solve, [S+1]. At γ = 1 the policy must leave them.
            v: Values, [S+1], changed in place.
            reward: Rewards to use instead of the world's own, [O].

        Returns:
            Size of the last correction, an estimate of the rounding error.

        Raises:
            NoExactAnswer: The error exceeds 1e-10 and 1e-15 of the largest value.
        """
        if not unknown.any():
            return 0.0
        model, moves = self._model, self._moves
        inside = unknown[model.live]
        places = model.live[inside]
        rewards = model.reward if reward is None else reward
        earned = np.add.reduceat(moves.weight * rewards[moves.outcome], moves.first)
        stops = (1.0 - np.longdouble(gamma)) * moves.total
        solver = self._solver_of(gamma, unknown)
        error = np.inf
        for _ in range(MOST_ROUNDS):
            # Differences keep the digits that γ v(s′) − v(s) would lose for γ near 1
            gain = np.add.reduceat(moves.weight * (v[moves.target] - v[moves.source]), moves.first)
            residual = (earned + gamma * gain - stops * v[model.live])[inside]
            correction = solver(residual.astype(np.float64))
            v[places] += correction
            before, error = error, float(np.abs(correction).max())
            scale = float(np.abs(v[places]).max())
            if error <= np.finfo(np.longdouble).eps * scale or not error < before / 2:
                break
        if not error <= max(PRECISION, RELATIVE_PRECISION * scale):
            raise _too_ill_conditioned(gamma)
        return error

    def _undiscounted(self) -> ExtendedArray:
        """Return the values at γ = 1, [S+1], with NaN where they do not exist."""
        model, moves = self._model, self._moves
        paying = np.zeros(model.end + 1, dtype=np.bool_)
        paying[moves.source[model.reward[moves.outcome] != 0.0]] = True
        to_be_paid = self._may_come_to(paying)
        # A state that reaches neither an end nor a part without rewards collects rewards forever
        undefined = self._may_come_to(~self._may_come_to(~to_be_paid))
        v = np.zeros(model.end + 1, dtype=np.longdouble)
        self.solve(1.0, to_be_paid & ~undefined, v)
        v[undefined] = np.nan
        return v

    def _find_endings(self) -> tuple[BoolArray, BoolArray]:
        """Return the states, [S+1], that may end, and those that may never end."""
        if self._endings is None:
            is_end = np.arange(self._model.end + 1) == self._model.end
            can_end = self._may_come_to(is_end)
            self._endings = can_end, self._may_come_to(~can_end)
        return self._endings

    def _may_come_to(self, goals: BoolArray) -> BoolArray:
        """Return the states that can reach one of `goals`, including the goals, [S+1] both."""
        if self._ways is None:
            self._ways = Ways(self._moves.source, self._moves.target, self._model.end + 1)
        return self._ways.leading_to(np.flatnonzero(goals))

    def _solver_of(self, gamma: float, unknown: BoolArray) -> Solver:
        wanted = gamma, unknown.tobytes()
        if self._solver is None or self._factorised != wanted:
            self._solver = None  # frees memory before the next one is made
            try:
                self._solver = _chain_solver(self._moves, gamma, unknown)
            except SingularMatrixError:
                raise _too_ill_conditioned(gamma) from None
            self._factorised = wanted
        return self._solver


def always_ends(mdp: TabularMDP, policy: FloatArray) -> bool:
    """Return True if `policy`, [P], ends every episode with probability 1, given enough time."""
    return PolicyChain(exact_model(mdp), policy).always_ends()


def _chain_solver(moves: _Moves, gamma: float, unknown: BoolArray) -> Solver:
    """Return the solver of I − γ P under `moves`, restricted to the `unknown` states, [S+1]."""
    index = np.cumsum(unknown) - 1
    size = int(index[-1]) + 1
    source, target, weight = moves.source, moves.target, moves.weight.astype(np.float64)
    leaving = unknown[source] & (target != source) & (weight > 0.0)
    staying_inside = leaving & unknown[target]
    rows, columns = index[source[staying_inside]], index[target[staying_inside]]
    # summing what leaves keeps the digits that 1 − γ p(s | s) would lose
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
        return NoExactAnswer(f"γ = {gamma!r} is too near to 1 for exact values; choose a smaller γ")
    return NoExactAnswer("γ = 1: a terminal state is too unlikely for exact values; choose γ below 1")


def _dense(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    """Return b → A⁻¹ b for the matrix A, [size, size]. Entries at the same place are summed.

    Raises:
        SingularMatrixError: A has no inverse.
    """
    matrix = np.bincount(rows * size + columns, weights=entries, minlength=size * size).reshape(size, size)
    try:
        inverse: FloatArray = np.linalg.inv(matrix)
    except np.linalg.LinAlgError as fault:
        raise SingularMatrixError from fault
    return lambda right: inverse @ right


def _sparse(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    """Return the same as :func:`_dense`, with a sparse matrix."""
    # scipy takes 0.25 s to import, and most worlds never need it
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        # columns of a chain have little in common; one at a time takes two thirds of the time (measured with
        # 8,000 states)
        factors = splu(csc_matrix((entries, (rows, columns)), shape=(size, size)), relax=1, panel_size=1)
    except RuntimeError as fault:
        raise SingularMatrixError from fault
    solve: Solver = factors.solve
    return solve
