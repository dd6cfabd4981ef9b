"""The values of a policy as functions of γ: quotients of two polynomials.

The result is checked in integers, so an unlucky prime costs another attempt, never a wrong answer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.polynomials import Polynomial, polynomial, scaled_value
from rl_tui.worlds.mdp.space import IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# The MDP in whole numbers


LARGEST_DENOMINATOR: Final = 10**6


@dataclass(frozen=True, slots=True)
class RationalPair:
    """The outcomes of one pair in integers.

    Args:
        state: Index of its live state.
        scale: Common denominator. The rest of it ends the episode.
        reward: Expected reward · `scale`, in the model's unit.
        moves: (live state, probability · `scale`).
    """

    state: int
    scale: int
    reward: int
    moves: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class RationalModel:
    """An MDP of N live states in integers.

    Args:
        live: [N].
        pairs: In the order of the MDP, [P]. The unit of rewards makes them integers.
        pairs_of: Pairs of each live state, [N].
    """

    live: tuple[int, ...]
    pairs: tuple[RationalPair, ...]
    pairs_of: tuple[range, ...]


def rational_model(mdp: TabularMDP) -> RationalModel:
    """Convert `mdp` to integers.

    Probabilities and rewards become the nearest fractions with denominators up to 10⁶, and probabilities are
    scaled to sum to 1.

    Raises:
        NoExactAnswer: A non-zero number would become 0.
    """
    live = np.flatnonzero(np.diff(mdp.first_pair)).tolist()
    number = {state: place for place, state in enumerate(live)}
    chances = [_read(chance) for chance in mdp.probability.tolist()]
    rewards = [_read(reward) for reward in mdp.reward.tolist()]
    unit = math.lcm(*(reward.denominator for reward in rewards))
    whole = [int(reward * unit) for reward in rewards]
    common = math.gcd(*whole) or 1
    landing = [
        None if ends else number[state]
        for state, ends in zip(mdp.next_state.tolist(), mdp.terminated.tolist(), strict=True)
    ]
    return RationalModel(
        live=tuple(live),
        pairs=tuple(
            _pair(
                number[state], [(chances[o], whole[o] // common, landing[o]) for o in mdp.outcomes_of(pair)]
            )
            for pair, state in enumerate(mdp.pair_state.tolist())
        ),
        pairs_of=tuple(mdp.pairs_of(state) for state in live),
    )


def _read(value: float) -> Fraction:
    read = Fraction(value).limit_denominator(LARGEST_DENOMINATOR)
    if value and not read:
        raise NoExactAnswer(
            f"flip points: {value:g} is too small for a fraction with a denominator up to "
            f"{LARGEST_DENOMINATOR:,}"
        )
    return read


def _pair(state: int, outcomes: list[tuple[Fraction, int, int | None]]) -> RationalPair:
    # Outcomes are chance, reward and next live state
    denominator = math.lcm(*(chance.denominator for chance, _, _ in outcomes))
    weights = [int(chance * denominator) for chance, _, _ in outcomes]
    common = math.gcd(*weights)
    reward, moves = 0, dict[int, int]()
    for weight, (_, paid, landing) in zip(weights, outcomes, strict=True):
        reward += weight // common * paid
        if landing is not None and weight:
            moves[landing] = moves.get(landing, 0) + weight // common
    return RationalPair(state, sum(weights) // common, reward, tuple(moves.items()))


# Arithmetic modulo primes


# Python integers of any size
WholeArray = npt.NDArray[np.object_]

# Primes are below 2³⁰, so this number of products of two residues, plus a residue, stays below 2⁶³
BITS: Final = 30
PRODUCTS: Final = 7
WITNESSES: Final = (2, 3, 5, 7)


def primes() -> Iterator[int]:
    """Yield the primes between 2²⁹ and 2³⁰, largest first."""
    return (number for number in range(2**BITS - 1, 2 ** (BITS - 1), -2) if _is_prime(number))


def column(moduli: Sequence[int], dimensions: int) -> IntArray:
    """Return K moduli as an array [K, 1, …]."""
    shaped: IntArray = np.array(moduli, dtype=np.int64).reshape(-1, *[1] * (dimensions - 1))
    return shaped


def shortest_recurrence(terms: IntArray, moduli: Sequence[int]) -> IntArray | None:
    """Return the shortest linear recurrence modulo K primes (Berlekamp–Massey algorithm).

    Modulo each prime c[0] is 1, and c[0]·t[k] + c[1]·t[k−1] + … + c[L]·t[k−L] is 0 for all k ≥ L. Length N
    needs 2N `terms`, [K, 2N]. Returns c, [K, L + 1], or None in the rare case that the primes differ in their
    steps.
    """
    modulus = column(moduli, 2)
    current, earlier = np.zeros((2, len(moduli), terms.shape[1] + 2), dtype=np.int64)
    current[:, 0] = earlier[:, 1] = 1
    inverse, length = np.ones_like(modulus), 0
    for place in range(terms.shape[1]):
        window = terms[:, place - length : place + 1][:, ::-1]
        off = (current[:, : length + 1] * window % modulus).sum(axis=1, keepdims=True) % modulus
        if off.all():
            used = slice(place + 2)
            before = current.copy()
            current[:, used] -= off * inverse % modulus * earlier[:, used] % modulus
            current[:, used] %= modulus
            if 2 * length <= place:
                earlier, length = before, place + 1 - length
                inverse = column([pow(int(*each), -1, p) for each, p in zip(off, moduli, strict=True)], 2)
        elif off.any():
            return None
        earlier[:, 1:] = earlier[:, :-1].copy()
        earlier[:, 0] = 0
    found: IntArray = current[:, : length + 1]
    return found


def whole_numbers(residues: IntArray, moduli: Sequence[int]) -> WholeArray:
    """Return the integers nearest to 0 with these `residues`, [K, …] (mixed radix, after Garner)."""
    digits: list[IntArray] = []
    for number, prime in enumerate(moduli):
        rest = residues[number].copy()
        for digit, smaller in zip(digits, moduli, strict=False):
            rest = (rest - digit) % prime * pow(smaller, -1, prime) % prime
        digits.append(rest)
    total: Any = np.zeros(residues.shape[1:], dtype=object)
    for digit, prime in zip(reversed(digits), reversed(moduli), strict=True):
        total = total * prime + digit.astype(object)
    product = 1
    for prime in moduli:
        product *= prime
    nearest: WholeArray = np.where(2 * total > product, total - product, total)
    return nearest


def _is_prime(number: int) -> bool:
    # Miller–Rabin test, for odd numbers below 2³⁰
    odd, halvings = number - 1, 0
    while odd % 2 == 0:
        odd, halvings = odd // 2, halvings + 1
    for witness in WITNESSES:
        power = pow(witness, odd, number)
        if power not in (1, number - 1) and not any(
            (power := power * power % number) == number - 1 for _ in range(halvings - 1)
        ):
            return False
    return True


# Values as functions of γ


PROJECTION_SEED: Final = 1


@dataclass(frozen=True, slots=True, eq=False)
class PolicyValues:
    """Values of a policy as functions of γ: ``numerators[n]`` / `denominator` for live state n.

    Coefficients are integers, constant first: `denominator` is [M], `numerators` [N, M] with a last
    coefficient of 0. The denominator is positive for γ in [0, 1).
    """

    denominator: WholeArray
    numerators: WholeArray

    def advantage(self, pair: RationalPair) -> Polynomial:
        """Return q(s, a) − v(s) of `pair`, times its scale and the denominator (equation 4.6)."""
        total = pair.reward * self.denominator - pair.scale * self.numerators[pair.state]
        for state, weight in pair.moves:
            total[1:] += weight * self.numerators[state, :-1]
        return polynomial(total.tolist())

    def at(self, gamma: Fraction) -> ValuesAt:
        """Return the values at `gamma`."""
        return ValuesAt(
            gamma,
            scaled_value(self.denominator.tolist(), gamma),
            [scaled_value(numerator, gamma) for numerator in self.numerators.tolist()],
        )


@dataclass(frozen=True, slots=True)
class ValuesAt:
    """Values at one γ: ``numerators[n]`` / `denominator` for live state n."""

    gamma: Fraction
    denominator: int
    numerators: Sequence[int]

    def advantage(self, pair: RationalPair) -> Fraction:
        """Return q(s, a) − v(s) of `pair`, times the denominator."""
        later = sum(weight * self.numerators[state] for state, weight in pair.moves)
        gained = pair.reward * self.denominator - pair.scale * self.numerators[pair.state]
        return (gained + self.gamma * later) / pair.scale


def policy_values(model: RationalModel, policy: Sequence[int]) -> PolicyValues:
    """Compute the values of `policy`, [N] pairs, as functions of γ.

    V = R + γ P R + γ² P² R + … (equation 3.14). The vectors Pᵏ R follow a linear recurrence (Cayley–Hamilton
    theorem), which gives the denominator D, and N = D · V. D divides det(I − γ P), which has no root inside
    (−1, 1).

    The recurrence is found modulo primes from u · Pᵏ R, for a random u. It is not longer than the true one,
    so D has no extra factor. Finally (I − γ P) N = D · R is checked in integers.
    """
    pairs = [model.pairs[number] for number in policy]
    for attempt in count():
        found = _pieced_together(pairs, attempt)
        if found and not any(found.advantage(pair) for pair in pairs):
            return found
    raise AssertionError


def _pieced_together(pairs: Sequence[RationalPair], attempt: int) -> PolicyValues | None:
    # None on a rare failure
    scale = math.prod(pair.scale for pair in pairs)
    # D is an integer polynomial if D(0) is the product of all scales, and so is N; |λ| ≤ 1 and |Pᵏ R| ≤ |R|
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
    # With a product above `bound`, dividing no scale
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
    # Pᵏ R modulo each prime for k below 2N, [K, 2N, N]
    count_ = len(pairs)
    moves = [pair.moves or ((count_, 0),) for pair in pairs]  # an extra state of value 0
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
    # Each prime, with the inverses of the scales, [N]
    return [(prime, [pow(pair.scale, -1, prime) for pair in pairs]) for prime in moduli]


def _truncated_product(recurrence: IntArray, krylov: IntArray, moduli: Sequence[int]) -> IntArray:
    # Modulo each prime, [K, L + 1, N]
    length = recurrence.shape[1] - 1
    result = np.zeros((len(moduli), length + 1, krylov.shape[2]), dtype=np.int64)
    modulus = column(moduli, 3)
    for power in range(length):
        result[:, power:length] += recurrence[:, power, None, None] * krylov[:, : length - power]
        if power % PRODUCTS == PRODUCTS - 1:
            result %= modulus
    return result % modulus
