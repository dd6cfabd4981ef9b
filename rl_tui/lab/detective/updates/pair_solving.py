"""Numbers of an update, solved from a few steps at a time and counted: the true ones come up again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

_PAIRS: Final = 3_000
_VOTES: Final = 4_000
_SINGULAR: Final = 1e-6
_NOTHING: Final = 1e-9
_SEED: Final = 17
_PRIMES: Final = (2, 3, 5)
"""Whose roots make one number of a row: whole rows are ten times as slow to sort."""


def rounded(numbers: FloatArray, digits: int) -> FloatArray:
    """Return ``numbers`` with so many significant digits."""
    scale = 10.0 ** (digits - 1 - np.floor(np.log10(np.abs(numbers))))
    result: FloatArray = np.where(numbers == 0.0, 0.0, np.rint(numbers * scale) / scale)
    return result


def most_frequent(rows: FloatArray, digits: int, most: int) -> list[tuple[float, ...]]:
    """Return the rows of ``rows`` [n, k], k ≤ 3, that come most often, at most ``most``, the first first.

    Equal are those with the same ``digits`` significant digits; what is returned is their median. Of very
    many rows some are looked at, evenly spread.
    """
    rows = rows[np.isfinite(rows).all(1)]
    if not len(rows):
        return []
    rows = rows[:: -(-len(rows) // _VOTES)]
    same = rounded(rows, digits)
    key = sum(column * np.sqrt(prime) for column, prime in zip(same.T, _PRIMES, strict=False))
    _, group, counts = np.unique(key, return_inverse=True, return_counts=True)
    first = np.argsort(-counts, kind="stable")[:most]
    return [tuple(map(float, np.median(rows[group == each], axis=0))) for each in first if counts[each] > 1]


def solved_pairs(
    unit: FloatArray, value: FloatArray, change: FloatArray, digits: int, most: int = 4
) -> list[tuple[float, float]]:
    """Return likely (a, b) with a·``unit`` + b·``value`` = ``change``, all [n], the most likely first.

    Where no step has a value, b is NaN and a is solved from single steps.
    """
    moved = np.flatnonzero(change != 0.0)
    if not len(moved):
        return []
    weighty = moved[value[moved] != 0.0]
    if not len(weighty):
        moved = moved[unit[moved] != 0.0]
        alone = (change[moved] / unit[moved])[:, None]
        return [(a, float("nan")) for (a,) in most_frequent(alone, digits, most)]
    one, other = drawn(weighty, 0), drawn(moved, 1)
    up, uq, vp, vq = unit[one], unit[other], value[one], value[other]
    cp, cq = change[one], change[other]
    determinant = up * vq - uq * vp
    good = np.abs(determinant) > _SINGULAR * (np.abs(up * vq) + np.abs(uq * vp))
    a, b = (cp * vq - cq * vp) / determinant, (up * cq - uq * cp) / determinant
    ratio = b / a
    pairs = np.column_stack((a, np.where(np.abs(ratio) < _NOTHING, 0.0, ratio)))[good]
    return [(a, a * ratio) for a, ratio in most_frequent(pairs, digits, most)]


def drawn(places: IntArray, stream: int, count: int = _PAIRS) -> IntArray:
    """Return ``count`` of ``places``, with replacement, always the same ones for the same ``stream``."""
    return places[np.random.default_rng((_SEED, stream)).integers(0, len(places), count)]


def refined(
    columns: Iterable[FloatArray], change: FloatArray, slack: FloatArray, within: BoolArray
) -> list[float] | None:
    """Return the factors of ``columns`` whose sum is nearest to ``change`` where ``within``.

    None where several are equally near.
    """
    weight = 1.0 / slack[within]
    matrix = np.column_stack([column[within] * weight for column in columns])
    wanted = change[within] * weight
    finite = np.isfinite(matrix).all(1) & np.isfinite(wanted)  # LAPACK writes of others to the screen
    matrix, wanted = matrix[finite], wanted[finite]
    size = np.abs(matrix).max(0, initial=0.0)
    if len(matrix) < matrix.shape[1] or np.any(size == 0.0):
        return None
    answer, _, rank, _ = np.linalg.lstsq(matrix / size, wanted, rcond=1e-9)
    return [float(each) for each in answer / size] if rank == matrix.shape[1] else None


def plainest(number: float, numbers: Mapping[str, float], precision: float) -> float:
    """Return the plainest number that is as good as ``number``: one of the code's, or one of few digits."""
    near = 1e-8 if precision < 1e-8 else 20 * precision
    near *= max(abs(number), 1e-300)
    for digits in (1, 2, 3, 4, 5, 6):
        short = float(f"{number:.{digits}g}")
        if abs(short - number) <= near:
            return short
    for each in numbers.values():
        if abs(each - number) <= near:
            return float(each)
    return number
