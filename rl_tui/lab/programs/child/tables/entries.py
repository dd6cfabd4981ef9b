"""Rows, keys and numbers as programs write them, read without calling anything of theirs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from rl_tui.lab.programs.child.environments.numbering import Numbering

NAN: Final = float("nan")


def number_of(value: object) -> float:
    """Return what stands in a table as a number, NaN where it is none."""
    if type(value) is float:
        return value
    if type(value) is np.ndarray and value.size == 1 and value.dtype.kind in "fiu":
        return float(value.reshape(-1)[0])
    try:
        return float(value) if is_number(value) else NAN  # type: ignore[arg-type]
    except (OverflowError, TypeError):
        return NAN


def is_number(value: Any) -> bool:
    """Return whether ``value`` is a number as tables hold them: no bool, no complex number."""
    return type(value) in (float, int) or (issubclass(type(value), np.number) and value.dtype.kind in "fiu")


def is_row(row: Any, actions: int) -> bool:
    """Return whether ``row`` is a row of a table, with a number for each of ``actions``."""
    if type(row) is np.ndarray:
        return row.shape == (actions,) and row.dtype.kind in "fiu"
    return type(row) in (list, tuple) and len(row) == actions and all(map(_is_entry, row))


def _is_entry(value: object) -> bool:
    return type(value) is float or is_number(value) or (type(value) is np.ndarray and value.size == 1)


def raw_rows(rows: list[Any]) -> list[Any]:
    """Return ``rows`` in a form in which they are quickly compared."""
    if rows and type(rows[0]) is np.ndarray:
        return list(map(np.ndarray.tobytes, rows))
    return rows


def raw_row(row: Any) -> object:
    """Return a row in a form in which it is quickly compared."""
    return row.tobytes() if type(row) is np.ndarray else row


def plain_rows(table: Any) -> list[Any]:
    """Return the rows of a list or an array of objects."""
    if type(table) is np.ndarray:
        rows: list[Any] = table.reshape(-1, table.shape[-1]).tolist()
        return rows
    return table  # type: ignore[no-any-return]


def _is_plain(key: object) -> bool:
    return type(key) is int or issubclass(type(key), (bool, np.integer, np.bool_))


def state_of(numbering: Numbering, key: Any) -> int | None:
    """Return the state of a key of a dict, None where it is no observation."""
    is_fit = (type(key) is tuple and all(map(_is_plain, key))) if numbering.is_tuple else _is_plain(key)
    try:
        return numbering.state(tuple(map(int, key)) if numbering.is_tuple else int(key)) if is_fit else None
    except ValueError:
        return None


def cell_of(numbering: Numbering, key: Any) -> int:
    """Return the cell of a key (observation, action), −1 where it is none."""
    if type(key) is tuple and len(key) == 2 and _is_plain(key[1]):
        state, action = state_of(numbering, key[0]), int(key[1]) - numbering.first_action
        if state is not None and 0 <= action < numbering.actions:
            return state * numbering.actions + action
    return -1


def add_difference(cell: int, before: float, after: float, found: list[float]) -> None:
    """Add to ``found`` what differs in one cell."""
    if before != after and (before == before or after == after):  # two NaN do not differ
        found += (cell, before, after)


def add_differences(first_cell: int, pairs: Iterable[tuple[float, float]], found: list[float]) -> None:
    """Add to ``found`` what differs in ``pairs``, (before, after) of the cells from ``first_cell`` on."""
    for cell, (before, after) in enumerate(pairs, first_cell):
        if before != after and (before == before or after == after):  # two NaN do not differ
            found += (cell, before, after)
