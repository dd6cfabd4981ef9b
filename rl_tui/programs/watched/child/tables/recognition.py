"""Recognising a program's table by its form."""

from __future__ import annotations

from typing import Any

import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.forms import (
    MOST_CELLS,
    ArrayTable,
    PairTable,
    RowTable,
    cell_of,
    is_number,
    is_row,
    plain_rows,
    state_of,
)
from rl_tui.programs.watched.child.tables.held_table import HeldTable
from rl_tui.programs.watched.child.tables.keyed_table import keyed_form
from rl_tui.programs.watched.child.worlds.met import MetNumbering


def form_of(value: Any, numbering: Numbering) -> HeldTable | None:
    """Return `value` as a table, if it is one."""
    if isinstance(numbering, MetNumbering):
        return keyed_form(value, numbering)
    if not 0 < numbering.states * numbering.actions <= MOST_CELLS:
        return None
    return _plain_form(value, numbering) or keyed_form(value, numbering)


def _plain_form(value: Any, numbering: Numbering) -> HeldTable | None:
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
