"""Arithmetic modulo primes below 2³⁰, by whole arrays, and the way back to whole numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.space import IntArray

# Of Python's whole numbers, of any size
WholeArray = npt.NDArray[np.object_]

# Primes lie below 2³⁰: so many products of two residues, and a residue, add up to less than 2⁶³
BITS: Final = 30
PRODUCTS: Final = 7
WITNESSES: Final = (2, 3, 5, 7)


def primes() -> Iterator[int]:
    """Yield the primes between 2²⁹ and 2³⁰, the largest first: far more than are needed."""
    return (number for number in range(2**BITS - 1, 2 ** (BITS - 1), -2) if _is_prime(number))


def column(moduli: Sequence[int], dimensions: int) -> IntArray:
    """Return the K ``moduli`` as an array to calculate with others, [K, …], of so many dimensions."""
    shaped: IntArray = np.array(moduli, dtype=np.int64).reshape(-1, *[1] * (dimensions - 1))
    return shaped


def shortest_recurrence(terms: IntArray, moduli: Sequence[int]) -> IntArray | None:
    """Return the coefficients, [K, L + 1], of the shortest linear recurrences of ``terms``, [K, T].

    Modulo each of K primes c[0] is 1, and c[0]·t[k] + c[1]·t[k−1] + … + c[L]·t[k−L] is 0 for each k from L
    on (the algorithm of Berlekamp and Massey). 2N terms of a sequence that has a recurrence of length N tell
    it. None where the primes do not all take the same steps towards it, which is rare.
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
    """Return the whole numbers with these ``residues``, [K, …], modulo K primes.

    Of those that differ by the product of the primes each is the nearest to 0. Mixed radix, after Garner.
    """
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
    """Return True if ``number``, odd and below 2³⁰, is a prime (the test of Miller and Rabin)."""
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
