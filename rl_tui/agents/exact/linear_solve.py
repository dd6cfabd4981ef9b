"""Linear equations of a few or many states: dense by numpy, sparse by scipy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from rl_tui.worlds.mdp.tabular_mdp import FloatArray, IntArray

MOST_DENSE: Final = 400

Solver = Callable[[FloatArray], FloatArray]


class SingularMatrixError(Exception):
    """The matrix has no inverse in floating-point numbers."""


def solver_of(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    """Return the function b → A⁻¹ b for A, [size, size], with these entries, summed where they meet.

    Raises :class:`SingularMatrixError`.
    """
    if size <= MOST_DENSE:
        return _dense(rows, columns, entries, size)
    return _sparse(rows, columns, entries, size)


def _dense(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    matrix = np.bincount(rows * size + columns, weights=entries, minlength=size * size).reshape(size, size)
    try:
        inverse: FloatArray = np.linalg.inv(matrix)
    except np.linalg.LinAlgError as fault:
        raise SingularMatrixError from fault
    return lambda right: inverse @ right


def _sparse(rows: IntArray, columns: IntArray, entries: FloatArray, size: int) -> Solver:
    # scipy takes a quarter of a second to import and most worlds never need it
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        factors = splu(csc_matrix((entries, (rows, columns)), shape=(size, size)))
    except RuntimeError as fault:
        raise SingularMatrixError from fault
    solve: Solver = factors.solve
    return solve
