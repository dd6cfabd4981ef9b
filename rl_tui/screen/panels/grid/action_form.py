"""The arrangement of actions in a cell."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum, auto
from typing import Final, NamedTuple

import numpy as np

from rl_tui.screen.panels.grid.form import LEAST_DIGITS, MOST_HEIGHT
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.space import FiniteSpace

MOST_DIGITS: Final = 5  # 0.94, −12.3
FRAME: Final = 2  # a mark on either side of a number
_ROWS: Final = 3  # above, beside and below the middle
_LEAST_TINTED: Final = 5  # columns: a side, three in the middle, a side
_LEAST_PART: Final = 5  # visible rows and columns of cells, for a map that does not fit


class Places(Enum):
    """The places of actions in a cell."""

    CROSS = auto()  # each number on its side of the middle
    KEYPAD = auto()  # the same with diagonals, in three rows
    SPREAD_KEYPAD = auto()  # the same in five rows, for narrower cells
    LIST = auto()  # one below the other, each after its sign
    TWO_LISTS = auto()
    TINTS = auto()  # no numbers: each side of the cell is coloured

    @property
    def is_list(self) -> bool:
        """True if every action follows its sign."""
        return self in (Places.LIST, Places.TWO_LISTS)


class ActionForm(NamedTuple):
    """A cell's size and its actions' ``places``."""

    places: Places
    width: int
    height: int
    digits: int
    sign_width: int = 1
    most_actions: int = 4

    @property
    def entry_width(self) -> int:
        """The width of a list entry."""
        if self.places is Places.TWO_LISTS:
            return (self.width - 1) // 2
        return self.width - (not self.has_header)

    @property
    def has_header(self) -> bool:
        """True if a list has a row of marks."""
        return self.places is Places.LIST and self.height > self.most_actions

    @property
    def list_rows(self) -> int:
        """The rows of a list."""
        return self.most_actions if self.places is Places.LIST else -(-self.most_actions // 2)

    @property
    def tinted_width(self) -> int:
        """The coloured columns."""
        return self.width - (self.width > _LEAST_TINTED)

    @property
    def is_framed(self) -> bool:
        """True if greedy numbers have marks on both sides."""
        return not self.places.is_list or self.entry_width > self.sign_width + self.digits + FRAME


class ActionKinds(NamedTuple):
    """The actions of a map, as far as they decide their form.

    ``have_sides``: states have distinct directions only, or at most three actions without one.
    """

    have_sides: bool
    are_diagonal: bool
    most: int


def action_kinds(space: FiniteSpace, grid: Grid) -> ActionKinds:
    """Examine the actions of all states."""
    sides = [side_of(step) for step in grid.directions]
    counts = np.diff(space.first_pair)
    has_side = np.array([side is not None for side in sides])[space.pair_action]
    directed = np.bincount(space.pair_state, weights=has_side, minlength=len(counts)).astype(np.int64)
    used = [side for side in sides if side is not None]
    is_mixed = bool(((directed > 0) & (directed < counts)).any())
    most_other = int(counts[directed == 0].max(initial=0))
    return ActionKinds(
        bool(used) and not is_mixed and len(used) == len(set(used)) and most_other <= _ROWS,
        any(rows and columns for rows, columns in used),
        int(counts.max(initial=0)),
    )


def side_of(sign: tuple[int, int] | str | None) -> tuple[int, int] | None:
    """Return a side (row and column, −1 to 1)."""
    if sign is None or isinstance(sign, str) or not any(sign):
        return None
    rows, columns = sign
    return (rows > 0) - (rows < 0), (columns > 0) - (columns < 0)


def _forms_for(
    kinds: ActionKinds, width: int, height: int, digits: int = LEAST_DIGITS, sign_width: int = 1
) -> Iterable[ActionForm]:
    if kinds.have_sides:
        yield from _with_sides(kinds, width, height, digits)
    rows = kinds.most
    for places, is_high in ((Places.LIST, height >= rows), (Places.TWO_LISTS, 2 * height >= rows > 1)):
        form = ActionForm(places, width, height, digits, sign_width, rows)
        room = form.entry_width - sign_width
        if is_high and room > digits:
            yield form._replace(digits=_digits(room - FRAME - 1, digits))
    if kinds.have_sides and width >= _LEAST_TINTED and height >= (3 if kinds.are_diagonal else 2):
        yield ActionForm(Places.TINTS, width, height, digits, sign_width, rows)


def _with_sides(kinds: ActionKinds, width: int, height: int, digits: int) -> Iterable[ActionForm]:
    in_three = (width - 3 * FRAME) // 3
    beside = (width - 2 * FRAME - 1) // 2  # a mark between them
    if not kinds.are_diagonal and height >= _ROWS and beside >= digits:
        yield ActionForm(Places.CROSS, width, height, _digits(beside - 1, digits))
    if kinds.are_diagonal and height >= _ROWS and in_three >= digits:
        yield ActionForm(Places.KEYPAD, width, height, _digits(in_three, digits))
    if kinds.are_diagonal and height >= MOST_HEIGHT and beside >= digits:
        yield ActionForm(Places.SPREAD_KEYPAD, width, height, _digits(beside - 1, digits))


def _digits(room: int, needed: int) -> int:
    return max(needed, min(MOST_DIGITS, room))


def whole_map_form(
    kinds: ActionKinds,
    rows: int,
    columns: int,
    width: int,
    height: int,
    digits: int,
    sign_width: int,
    *,
    tints: bool,
) -> ActionForm | None:
    """Return the form in which the whole map fits. The form without numbers needs ``tints``."""
    cell_height = min(MOST_HEIGHT, height // rows)
    cell_width = min(4 * cell_height + 3, width // columns)  # characters are about twice as high as wide
    forms = _forms_for(kinds, cell_width, cell_height, digits, sign_width)
    return next((form for form in forms if tints or form.places is not Places.TINTS), None)


def part_form(
    kinds: ActionKinds, rows: int, columns: int, width: int, height: int, digits: int, sign_width: int
) -> ActionForm | None:
    """Return the form that shows the most numbers, or None below five rows or columns."""
    entry, down = sign_width + digits + 1, -(-kinds.most // 2)
    sides = [(2 * digits + 6, _ROWS), (3 * digits + 7, _ROWS)] if kinds.have_sides else []
    apart = [*sides, (2 * entry + 2, down + 1), (entry + 2, kinds.most + 1)]
    for sizes in (apart, [(2 * entry + 2, down), (entry + 1, kinds.most)]):
        forms = [
            (min(rows, height // cell_height) * min(columns, width // cell_width), form)
            for cell_width, cell_height in sizes
            if height // cell_height >= min(rows, _LEAST_PART)
            and width // cell_width >= min(columns, _LEAST_PART)
            for form in _forms_for(kinds, cell_width, cell_height, digits, sign_width)
            if form.places is not Places.TINTS
        ]
        if forms:
            return max(forms, key=lambda each: each[0])[1]
    return None
