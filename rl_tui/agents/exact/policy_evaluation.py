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
    """There is no exact answer (at γ = 1: a state that cannot reach an end, a loop that gains for ever)."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The optimal values and policy for an unlimited horizon.

    ``v`` is [S] (0 where a state owns no pair), ``q`` [P]. ``best`` [P] marks the pairs within 1e-9 of the
    best of their state, ``greedy`` [P] those of them that are shown as the optimal policy: all below γ = 1;
    at γ = 1 those of :func:`~rl_tui.agents.exact.solve.ending_ties`, since a choice among the best
    pairs may never end there, and earns what they promise only if it does. ``value_at_start`` averages v over
    the start distribution. ``policy`` has a pair for each of the N states that own some, best to within
    rounding: the one whose values these are. ``iterations`` counts the policies that policy iteration
    evaluated.
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
    """What an optimal policy earns undiscounted, within the time limit.

    ``expected_return`` is that of the greedy policy of a solution, uniform over its ties;
    ``best_expected_return`` that of the best policy that may look at the clock. Without a time limit both are
    of an unlimited horizon, None where that has no answer.
    """

    expected_return: float | None
    best_expected_return: float | None


# Evaluation of a policy


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


class _Moves(NamedTuple):
    """All that may happen when a policy is followed, n outcomes in the order of the N live states.

    The k-th happens in the state ``source`` with the probability ``weight``, is the world's ``outcome``, and
    leads to ``target``, [n] each. Those of a live state begin at ``first`` and sum to ``total``, [N] each.
    """

    source: IntArray
    outcome: IntArray
    target: IntArray
    weight: ExtendedArray
    first: IntArray
    total: ExtendedArray


def _moves_of(model: ExactModel, policy: FloatArray) -> _Moves:
    """Return what may happen under ``policy``, [P]."""
    outcome = np.flatnonzero((policy > 0.0)[model.outcome_pair])
    pair = model.outcome_pair[outcome]
    source = model.pair_state[pair]
    weight = policy[pair] * model.probability[outcome]
    first = np.flatnonzero(np.diff(source, prepend=-1))
    total: ExtendedArray = np.add.reduceat(weight, first)
    return _Moves(source, outcome, model.landing[outcome], weight, first, total)


class PolicyChain:
    """The Markov chain that ``policy``, [P], makes of a model, and its figures over an unlimited horizon.

    What was searched or factorised for one question serves the next. Each figure raises NoExactAnswer where
    rounding would spoil it.
    """

    def __init__(self, model: ExactModel, policy: FloatArray) -> None:
        self._model = model
        self._moves = _moves_of(model, policy)
        self._ways: Ways | None = None
        self._endings: tuple[BoolArray, BoolArray] | None = None
        # Only the last: that of a large world takes hundreds of megabytes
        self._factorised: tuple[float, bytes] | None = None
        self._solver: Solver | None = None

    def value(self, gamma: float) -> PolicyValue:
        """Return the values for ``gamma`` in [0, 1]. At γ = 1 an endless part that pays nothing adds 0."""
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
        """Return the expected number of steps of an episode, None where it may never end."""
        if not self.always_ends():
            return None
        _, may_fail = self._find_endings()
        length = np.zeros(self._model.end + 1, dtype=np.longdouble)
        self.solve(1.0, self._model.is_live & ~may_fail, length, np.ones_like(self._model.reward))
        return self._model.mdp.average_at_start(length)

    def always_ends(self) -> bool:
        """Return True if every episode ends with probability 1, given time enough."""
        _, may_fail = self._find_endings()
        return not may_fail[self._model.mdp.start_state].any()

    def solve(
        self, gamma: float, unknown: BoolArray, v: ExtendedArray, reward: ExtendedArray | None = None
    ) -> float:
        """Set v(s) = E[R + γ v(S′)] in the ``unknown`` states, given ``v``, [S+1], in all others.

        ``unknown``, [S+1], marks live states from which the policy comes to others where γ = 1. ``reward``,
        [O], takes the place of the world's own. Returns what rounding may have left, judged by the last
        correction.

        Raises NoExactAnswer where that is more than 1e-10 (and 1e-15 of the largest value).
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
            # Differences of values keep the digits that γ v(s′) − v(s) would lose where γ is near 1
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
        """Return the values at γ = 1, [S+1], NaN where there are none."""
        model, moves = self._model, self._moves
        paying = np.zeros(model.end + 1, dtype=np.bool_)
        paying[moves.source[model.reward[moves.outcome] != 0.0]] = True
        to_be_paid = self._may_come_to(paying)
        # A state from which no end and no part without rewards can be reached is paid for ever
        undefined = self._may_come_to(~self._may_come_to(~to_be_paid))
        v = np.zeros(model.end + 1, dtype=np.longdouble)
        self.solve(1.0, to_be_paid & ~undefined, v)
        v[undefined] = np.nan
        return v

    def _find_endings(self) -> tuple[BoolArray, BoolArray]:
        """Return from which states, [S+1], it may come to an end, and from which it may never do so."""
        if self._endings is None:
            is_end = np.arange(self._model.end + 1) == self._model.end
            can_end = self._may_come_to(is_end)
            self._endings = can_end, self._may_come_to(~can_end)
        return self._endings

    def _may_come_to(self, goals: BoolArray) -> BoolArray:
        """Return from which states luck may lead to one of ``goals``, themselves among them, [S+1] both."""
        if self._ways is None:
            self._ways = Ways(self._moves.source, self._moves.target, self._model.end + 1)
        return self._ways.leading_to(np.flatnonzero(goals))

    def _solver_of(self, gamma: float, unknown: BoolArray) -> Solver:
        wanted = gamma, unknown.tobytes()
        if self._solver is None or self._factorised != wanted:
            self._solver = None  # its memory, before another's is taken
            try:
                self._solver = _chain_solver(self._moves, gamma, unknown)
            except SingularMatrixError:
                raise _too_ill_conditioned(gamma) from None
            self._factorised = wanted
        return self._solver


def always_ends(mdp: TabularMDP, policy: FloatArray) -> bool:
    """Return True if ``policy``, [P], ends every episode with probability 1, given time enough."""
    return PolicyChain(exact_model(mdp), policy).always_ends()


def _chain_solver(moves: _Moves, gamma: float, unknown: BoolArray) -> Solver:
    """Return the solver of I − γ P under ``moves``, restricted to the ``unknown`` states, [S+1]."""
    index = np.cumsum(unknown) - 1
    size = int(index[-1]) + 1
    source, target, weight = moves.source, moves.target, moves.weight.astype(np.float64)
    leaving = unknown[source] & (target != source) & (weight > 0.0)
    staying_inside = leaving & unknown[target]
    rows, columns = index[source[staying_inside]], index[target[staying_inside]]
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
        # A chain leads to few states, so that columns have next to nothing in common: taken one by one they
        # are done in two thirds of the time, of 8,000 states
        factors = splu(csc_matrix((entries, (rows, columns)), shape=(size, size)), relax=1, panel_size=1)
    except RuntimeError as fault:
        raise SingularMatrixError from fault
    solve: Solver = factors.solve
    return solve
