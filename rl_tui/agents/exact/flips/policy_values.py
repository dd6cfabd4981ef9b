"""The values of a policy as functions of γ: polynomials over one denominator, with whole coefficients.

In short: V = Σ γᵏ PᵏR, so each value is a power series in γ. Its coefficients obey a linear recurrence, as
PᵏR does (theorem of Cayley and Hamilton), and a series of that kind is a quotient N(γ) / D(γ), with the
recurrence for D. The recurrence is found modulo many primes, where numbers stay small, and put together to
whole numbers. Last, (I − γP) N = D R is checked in whole numbers: a prime without luck costs another try,
never a wrong answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Final

import numpy as np

from rl_tui.agents.exact.flips.polynomials import Polynomial, polynomial, scaled_value
from rl_tui.agents.exact.flips.rational_model import RationalModel, RationalPair
from rl_tui.agents.exact.flips.residues import (
    BITS,
    PRODUCTS,
    WholeArray,
    column,
    primes,
    shortest_recurrence,
    whole_numbers,
)
from rl_tui.worlds.mdp.space import IntArray

PROJECTION_SEED: Final = 1


@dataclass(frozen=True, slots=True, eq=False)
class PolicyValues:
    """The values of a policy: that of live state n is ``numerators[n]`` / ``denominator``, functions of γ.

    The coefficients are whole, that of the constant first: ``denominator`` is [M], ``numerators`` [N, M], and
    the last of each numerator is 0. The denominator is positive for γ in [0, 1).
    """

    denominator: WholeArray
    numerators: WholeArray

    def advantage(self, pair: RationalPair) -> Polynomial:
        """Return q(s, a) − v(s) of ``pair``, times its scale and the denominator (equation 4.6)."""
        total = pair.reward * self.denominator - pair.scale * self.numerators[pair.state]
        for state, weight in pair.moves:
            total[1:] += weight * self.numerators[state, :-1]
        return polynomial(total.tolist())

    def at(self, gamma: Fraction) -> ValuesAt:
        """Return the values at ``gamma``."""
        return ValuesAt(
            gamma,
            scaled_value(self.denominator.tolist(), gamma),
            [scaled_value(numerator, gamma) for numerator in self.numerators.tolist()],
        )


@dataclass(frozen=True, slots=True)
class ValuesAt:
    """The values of a policy at one γ: that of live state n is ``numerators[n]`` / ``denominator``."""

    gamma: Fraction
    denominator: int
    numerators: Sequence[int]

    def advantage(self, pair: RationalPair) -> Fraction:
        """Return q(s, a) − v(s) of ``pair``, times the denominator."""
        later = sum(weight * self.numerators[state] for state, weight in pair.moves)
        gained = pair.reward * self.denominator - pair.scale * self.numerators[pair.state]
        return (gained + self.gamma * later) / pair.scale


def policy_values(model: RationalModel, policy: Sequence[int]) -> PolicyValues:
    """Return the values of ``policy``, [N] pairs.

    With P the transitions of the policy and R its rewards, V = R + γ P R + γ² P² R + … (equation 3.14). The
    vectors Pᵏ R follow a linear recurrence; its coefficients are those of the denominator D, and N = D · V
    ends before the power that is the recurrence's length. D divides det(I − γ P), whose roots are 1/λ for the
    eigenvalues λ of P, none of them inside (−1, 1).

    The recurrence is found modulo some primes from the numbers u · Pᵏ R, for a random u, and pieced together;
    (I − γ P) N = D · R is then checked in whole numbers. What is found is no longer than the true recurrence,
    so that D has no factor too many: none that could be 0 or negative.
    """
    pairs = [model.pairs[number] for number in policy]
    for attempt in count():
        found = _pieced_together(pairs, attempt)
        if found and not any(found.advantage(pair) for pair in pairs):
            return found
    raise AssertionError


def _pieced_together(pairs: Sequence[RationalPair], attempt: int) -> PolicyValues | None:
    """Return what is most likely the values of the policy that takes ``pairs``; None on a rare failure."""
    scale = math.prod(pair.scale for pair in pairs)
    # D, scaled so that D(0) is the product of all scales, is whole, and so is N; |λ| ≤ 1 and |Pᵏ R| ≤ |R|
    bound = 2 * scale * 2 ** len(pairs) * max(1, *(abs(pair.reward) for pair in pairs))
    moduli = _primes_for(pairs, bound, skipped=attempt)
    krylov = _krylov(pairs, moduli)
    u = np.random.default_rng((PROJECTION_SEED, attempt)).integers(1, 2**BITS, size=len(pairs))
    projected = (krylov * u % column(moduli, 3)).sum(axis=2) % column(moduli, 2)
    recurrence = shortest_recurrence(projected, moduli)
    if recurrence is None:
        return None
    recurrence = recurrence * column([scale % prime for prime in moduli], 2) % column(moduli, 2)
    numerators = _truncated_product(recurrence, krylov, moduli)
    whole = whole_numbers(np.concatenate((recurrence[:, :, None], numerators), axis=2), moduli)
    return PolicyValues(whole[:, 0], whole[:, 1:].T)


def _primes_for(pairs: Sequence[RationalPair], bound: int, skipped: int) -> list[int]:
    """Return primes with a product above ``bound`` that divide no scale, not those that were tried before."""
    wanted = bound.bit_length() // (BITS - 1) + 1
    scales = {pair.scale for pair in pairs}
    usable = (prime for prime in primes() if all(scale % prime for scale in scales))
    found: list[int] = []
    for number, prime in enumerate(usable):
        if number >= skipped * wanted:
            found.append(prime)
        if len(found) == wanted:
            break
    return found


def _krylov(pairs: Sequence[RationalPair], moduli: Sequence[int]) -> IntArray:
    """Return Pᵏ R modulo each prime for k below 2N, [K, 2N, N]."""
    count_ = len(pairs)
    moves = [pair.moves or ((count_, 0),) for pair in pairs]  # a state too many, worth 0, for those that end
    first = np.cumsum([0, *map(len, moves)])[:-1]
    landing = np.array([state for each in moves for state, _ in each])
    weights = [
        [
            weight * inverse % prime
            for each, inverse in zip(moves, inverses, strict=True)
            for _, weight in each
        ]
        for prime, inverses in _inverses(pairs, moduli)
    ]
    current = np.zeros((len(moduli), count_ + 1), dtype=np.int64)
    current[:, :-1] = [
        [pair.reward * inverse % prime for pair, inverse in zip(pairs, inverses, strict=True)]
        for prime, inverses in _inverses(pairs, moduli)
    ]
    weight, modulus = np.array(weights), column(moduli, 2)
    result = np.empty((len(moduli), 2 * count_, count_), dtype=np.int64)
    for power in range(2 * count_):
        result[:, power] = current[:, :-1]
        moved = weight * current[:, landing] % modulus
        current[:, :-1] = np.add.reduceat(moved, first, axis=1) % modulus
    return result


def _inverses(pairs: Sequence[RationalPair], moduli: Sequence[int]) -> list[tuple[int, list[int]]]:
    """Return of each prime the inverses of the scales, [N]."""
    return [(prime, [pow(pair.scale, -1, prime) for pair in pairs]) for prime in moduli]


def _truncated_product(recurrence: IntArray, krylov: IntArray, moduli: Sequence[int]) -> IntArray:
    """Return the coefficients of the numerators modulo each prime, [K, L + 1, N]; the last are 0."""
    length = recurrence.shape[1] - 1
    result = np.zeros((len(moduli), length + 1, krylov.shape[2]), dtype=np.int64)
    modulus = column(moduli, 3)
    for power in range(length):
        result[:, power:length] += recurrence[:, power, None, None] * krylov[:, : length - power]
        if power % PRODUCTS == PRODUCTS - 1:
            result %= modulus
    return result % modulus
