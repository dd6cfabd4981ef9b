"""Arithmetic modulo primes below 2³¹, by whole arrays, and the way back to whole numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from operator import mul
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.space import IntArray

# Of Python's whole numbers, of any size
WholeArray = npt.NDArray[np.object_]

# Products of two residues fit into 63 bits
LARGEST: Final = 2**31 - 1
WITNESSES: Final = (2, 3, 5, 7)
BITS: Final = 30


def primes() -> Iterator[int]:
    """Yield the primes below 2³¹ from the largest on; far more than are needed have 31 bits."""
    return (number for number in range(LARGEST, 2**BITS, -2) if _is_prime(number))


def shortest_recurrence(terms: Sequence[int], prime: int) -> tuple[list[int], int]:
    """Return the coefficients c, at most L + 1, and the length L of the shortest recurrence of ``terms``.

    c[0] is 1, and c[0]·t[k] + c[1]·t[k−1] + … + c[L]·t[k−L] is 0 modulo ``prime`` for each k from L on
    (the algorithm of Berlekamp and Massey). Of a sequence that has one of length N, 2N terms tell it.
    """
    current, before = [1], [1]
    length, since, last = 0, 1, 1
    for place in range(len(terms)):
        discrepancy = sum(map(mul, current, reversed(terms[: place + 1]))) % prime
        if not discrepancy:
            since += 1
            continue
        factor = discrepancy * pow(last, -1, prime) % prime
        taken = [0] * since + [factor * each for each in before]
        corrected = [(each - less) % prime for each, less in zip_longest(current, taken, fillvalue=0)]
        if 2 * length <= place:
            before, last, since, length = current, discrepancy, 1, place + 1 - length
        else:
            since += 1
        current = corrected
    return current, length


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
    """Return True if ``number``, odd and below 3·10⁹, is a prime (the test of Miller and Rabin)."""
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
