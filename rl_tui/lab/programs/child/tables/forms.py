"""The forms in which programs keep their table: how each is recognised, read, and compared with before.

Reading calls nothing of the user's: no property, no method of a class of theirs, no ``__getitem__`` that
would add an entry. (``isinstance`` may ask an object for its ``__class__``; so types are asked.)
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from rl_tui.lab.programs.child.environments.numbering import Numbering
from rl_tui.lab.programs.child.tables.array_table import ArrayTable
from rl_tui.lab.programs.child.tables.entries import (
    cell_of,
    is_number,
    is_row,
    plain_rows,
    state_of,
)
from rl_tui.lab.programs.child.tables.held_table import HeldTable
from rl_tui.lab.programs.child.tables.pair_table import PairTable
from rl_tui.lab.programs.child.tables.row_table import RowTable

MOST_CELLS: Final = 1_000_000


def form_of(value: Any, numbering: Numbering) -> HeldTable | None:
    """Return the form of a table for the states and actions of ``numbering`` that ``value`` has, if any."""
    if not 0 < numbering.states * numbering.actions <= MOST_CELLS:
        return None
    if type(value) is np.ndarray:
        shapes = {(*numbering.parts, numbering.actions), (numbering.states, numbering.actions)}
        if value.shape not in shapes or value.dtype.kind not in "fiuO":
            return None
        if value.dtype.kind == "O":
            return RowTable(numbering, "array") if is_row(plain_rows(value)[0], numbering.actions) else None
        return ArrayTable(numbering) if value.shape == (*numbering.parts, numbering.actions) else None
    if issubclass(type(value), dict):
        return _form_of_dict(value, numbering)
    is_list = type(value) is list and len(value) == numbering.states
    if is_list and all(is_row(row, numbering.actions) for row in value):
        return RowTable(numbering, "lists")
    return None


def _form_of_dict(value: dict[Any, Any], numbering: Numbering) -> HeldTable | None:
    key, entry = next(iter(dict.items(value)), (None, None))
    if state_of(numbering, key) is not None and is_row(entry, numbering.actions):
        return RowTable(numbering, "dict-of-arrays")
    is_pair = type(key) is tuple and cell_of(numbering, key) >= 0
    return PairTable(numbering) if is_pair and is_number(entry) else None
