"""Exact values of a policy over an unlimited horizon (Sutton & Barto, 2nd ed., equation 4.4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.exact_model import ExactModel, ExtendedArray, Ways, exact_model
from rl_tui.common.errors import UserError
from rl_tui.common.packages import is_installed
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# The exact solution of a world


class NoExactAnswer(UserError):  # noqa: N818 - it is an answer
    """There is no exact answer, for example because a loop gains forever."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Optimal values and policy for an unlimited horizon.

    Args:
        v: [S]; 0 without pairs.
        q: [P].
        best: True for pairs within 1e-9 of the best of their state, [P].
        greedy: The best pairs, [P]. At γ = 1 only those of :func:`~rl_tui.agents.exact.solve.ending_ties`,
            because others may never end.
        value_at_start: Mean of `v` over the start distribution.
        policy: The evaluated policy, [N] pairs.
        iterations: Number of policies evaluated.
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
    """Undiscounted returns within the time limit, if any. None means no answer.

    Args:
        expected_return: Greedy policy, uniform over ties.
        best_expected_return: Best policy, which may use the elapsed time.
    """

    expected_return: float | None
    best_expected_return: float | None


# Evaluation of a policy


MOST_ROUNDS: Final = 50
PRECISION: Final = 1e-10
RELATIVE_PRECISION: Final = 1e-15
# Largest number of states with a dense matrix
MOST_DENSE: Final = 400
# The same without SciPy, which solves sparse systems
MOST_WITHOUT_SCIPY: Final = 2_000

Solver = Callable[[FloatArray], FloatArray]


class SingularMatrixError(Exception):
    """The matrix has no inverse in floating-point numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class PolicyValue:
    """Values of a policy.

    Args:
        v: [S]; 0 without pairs. NaN, at γ = 1 only, if the policy may collect rewards forever.
        at_start: Mean over the start distribution, or None for NaN.
    """

    v: FloatArray
    at_start: float | None


class _Moves(NamedTuple):
    """Outcomes possible under a policy, [n]. Those of a live state begin at `first`, [N], with the sum
    `total`, [N].
    """

    source: IntArray
    outcome: IntArray
    target: IntArray
    weight: ExtendedArray
    first: IntArray
    total: ExtendedArray


def _moves_of(model: ExactModel, policy: FloatArray) -> _Moves:
    outcome = np.flatnonzero((policy > 0.0)[model.outcome_pair])
    pair = model.outcome_pair[outcome]
    source = model.pair_state[pair]
    weight = policy[pair] * model.probability[outcome]
    first = np.flatnonzero(np.diff(source, prepend=-1))
    total: ExtendedArray = np.add.reduceat(weight, first)
    return _Moves(source, outcome, model.landing[outcome], weight, first, total)


class PolicyChain:
    """The Markov chain of `policy`, [P], over an unlimited horizon.

    Each number raises NoExactAnswer if rounding would spoil it.
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
        """Return the values. At γ = 1 an endless part without rewards adds 0."""
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
        """Return the expected length of an episode, or None."""
        if not self.always_ends():
            return None
        _, may_fail = self._find_endings()
        length = np.zeros(self._model.end + 1, dtype=np.longdouble)
        self.solve(1.0, self._model.is_live & ~may_fail, length, np.ones_like(self._model.reward))
        return self._model.mdp.average_at_start(length)

    def always_ends(self) -> bool:
        """Return True if every episode ends with probability 1."""
        _, may_fail = self._find_endings()
        return not may_fail[self._model.mdp.start_state].any()

    def solve(
        self, gamma: float, unknown: BoolArray, v: ExtendedArray, reward: ExtendedArray | None = None
    ) -> float:
        """Solve v(s) = E[R + γ v(S′)] for the `unknown` live states, [S+1], in place.

        At γ = 1 the policy must leave them. All other values `v`, [S+1], are given. `reward`, [O], replaces
        the world's own.

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
        """Return NaN where no values exist, [S+1]."""
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
        # States, [S+1], that may end, and that may never end
        if self._endings is None:
            is_end = np.arange(self._model.end + 1) == self._model.end
            can_end = self._may_come_to(is_end)
            self._endings = can_end, self._may_come_to(~can_end)
        return self._endings

    def _may_come_to(self, goals: BoolArray) -> BoolArray:
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
    """Return True if `policy`, [P], ends every episode with probability 1."""
    return PolicyChain(exact_model(mdp), policy).always_ends()


def _chain_solver(moves: _Moves, gamma: float, unknown: BoolArray) -> Solver:
    # Solves I − γ P in the `unknown` states, [S+1]
    index = np.cumsum(unknown) - 1
    size = int(index[-1]) + 1
    source, target, weight = moves.source, moves.target, moves.weight.astype(np.float64)
    leaving = unknown[source] & (target != source) & (weight > 0.0)
    staying_inside = leaving & unknown[target]
    rows, columns = index[source[staying_inside]], index[target[staying_inside]]
    # summing what leaves keeps the digits that 1 − γ p(s | s) would lose
    left = np.bincount(index[source[leaving]], weights=weight[leaving], minlength=size)
    diagonal = np.arange(size)
    solver_of = _dense if size <= MOST_DENSE or not may_be_sparse(size) else _sparse
    return solver_of(
        np.concatenate((rows, diagonal)),
        np.concatenate((columns, diagonal)),
        np.concatenate((-gamma * weight[staying_inside], (1.0 - gamma) + gamma * left)),
        size,
    )


def why_unsolved(states: int) -> str:
    """Return which package exact values need here, as a sentence, or ""."""
    if states <= MOST_WITHOUT_SCIPY or is_installed("scipy"):
        return ""
    return f"exact values of more than {MOST_WITHOUT_SCIPY:,} states need SciPy: pip install scipy"


def may_be_sparse(states: int) -> bool:
    """Return True if SciPy can solve a system of this size, False if NumPy must.

    Raises:
        NoExactAnswer: SciPy is missing and NumPy would be too slow.
    """
    if why := why_unsolved(states):
        raise NoExactAnswer(why)
    return is_installed("scipy")


def _too_ill_conditioned(gamma: float) -> NoExactAnswer:
    if gamma < 1.0:
        return NoExactAnswer(f"γ = {gamma!r} is too near to 1 for exact values; choose a smaller γ")
    return NoExactAnswer("γ = 1: a terminal state is too unlikely for exact values; choose γ below 1")


def _dense(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    # b → A⁻¹ b. Entries of A at the same place are summed
    matrix = np.bincount(rows * size + columns, weights=entries, minlength=size * size).reshape(size, size)
    try:
        inverse: FloatArray = np.linalg.inv(matrix)
    except np.linalg.LinAlgError as fault:
        raise SingularMatrixError from fault
    return lambda right: inverse @ right


def _sparse(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    # scipy takes 0.25 s to import, and most worlds never need it
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        # columns of a chain have little in common; one at a time takes two thirds of the time
        factors = splu(csc_matrix((entries, (rows, columns)), shape=(size, size)), relax=1, panel_size=1)
    except RuntimeError as fault:
        raise SingularMatrixError from fault
    solve: Solver = factors.solve
    return solve
