"""The grid on which the states of a Gymnasium environment are drawn, and its names.

Gymnasium has the names only in its documentation. A class is recognized by its name, without importing it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.common.limits import MOST_STATES
from rl_tui.worlds.drawing import Axes, Body, BodyKind, CellKind, Grid, Title
from rl_tui.worlds.gym.blackjack import (
    OBSERVED_AXES,
    OBSERVED_PARTS,
    TABLE_AXES,
    TABLE_LEGEND,
    is_blackjack,
    observed_drawing,
)
from rl_tui.worlds.gym.states import BinStates, States
from rl_tui.worlds.gym.table_layout import TAXI_AXES, TAXI_LEGEND, TAXI_SHAPE

if TYPE_CHECKING:
    from rl_tui.worlds.gym.section import GymnasiumSection


# Names and grid of states


_ACTIONS: Final[Mapping[str, tuple[str, ...]]] = {
    "BlackjackEnv": ("stick", "hit"),
    "CartPoleEnv": ("left", "right"),
    "MountainCarEnv": ("left", "coast", "right"),
    "AcrobotEnv": ("-1", "0", "+1"),
}
# per part of an observation; empty: the part's own numbers
_PARTS: Final[Mapping[str, tuple[tuple[str, ...], ...]]] = {"BlackjackEnv": ((), (), ("no", "yes"))}
_MOST_LABELS: Final = 2_000
_TERMS: Final[Mapping[str, tuple[str, ...]]] = {
    "BlackjackEnv": ("sum", "dealer", "usable ace"),
    "CartPoleEnv": ("position", "velocity", "angle", "angular velocity"),
    "MountainCarEnv": ("position", "velocity"),
}
_BODIES: Final[Mapping[str, BodyKind]] = {
    "CartPoleEnv": BodyKind.CART_POLE,
    "MountainCarEnv": BodyKind.MOUNTAIN_CAR,
}
_ACROSS: Final = (BodyKind.MOUNTAIN_CAR,)
"""Bodies that move along their first part."""


def action_names(environment: Any, first: int, actions: int) -> tuple[str, ...]:
    """Return the names of the actions of an unwrapped environment, or numbers from `first` on."""
    names = _ACTIONS.get(type(environment).__name__, ())
    return names if len(names) == actions else tuple(str(first + action) for action in range(actions))


def known_part_names(environment: Any, sizes: Sequence[int]) -> Sequence[Sequence[str]]:
    """Return known names for the parts of an observation, else empty ones."""
    names = _PARTS.get(type(environment).__name__, ())
    fits = len(names) == len(sizes) and all(
        not part or len(part) == size for part, size in zip(names, sizes, strict=True)
    )
    return names if fits else [()] * len(sizes)


def part_terms(environment: Any) -> Sequence[str]:
    """Return what the parts of an observation mean. Empty if unknown."""
    return _TERMS.get(type(environment).__name__, ())


def body_of(environment: Any, middles: Sequence[Sequence[float]]) -> Body | None:
    """Return the body of an unwrapped environment, if known."""
    kind = _BODIES.get(type(environment).__name__)
    if kind is None or len(middles) != len(part_terms(environment)):
        return None
    return Body(kind, tuple(map(tuple, middles)))


def grid_of(environment: Any, states: States, actions: int, part_names: Sequence[Sequence[str]]) -> Grid:
    """Return the grid of an unwrapped environment; see :func:`product_grid`.

    Observations of Blackjack are drawn like its transition table.
    """
    if is_blackjack(environment) and tuple(states.sizes) == OBSERVED_PARTS:
        return observed_drawing()
    body = body_of(environment, states.middles) if isinstance(states, BinStates) else None
    return product_grid(states.sizes, actions, part_terms(environment), part_names, body)


def product_grid(
    sizes: Sequence[int],
    actions: int,
    terms: Sequence[str] = (),
    names: Sequence[Sequence[str]] = (),
    body: Body | None = None,
) -> Grid:
    """Return the grid of states that are all combinations of several parts.

    A single part fills the squarest grid. The first two parts are rows and columns, or columns and rows for a
    body that moves along the first. Each combination of further parts is a block of its own. Parts with one
    value are ignored.

    Args:
        sizes: Number of values of each part.
        actions: Number of actions, which are not directions.
        terms: Meaning of the parts, for the legend. Parts are numbered if unknown.
        names: Names of the values of each part, as labels.
        body: Body that the parts describe.
    """
    is_upward, parts = _is_upward(sizes, body), _name_parts(sizes, terms)
    if is_upward:
        sizes, terms, names = sizes[::-1], terms[::-1], names[::-1]
    there = _that_count(sizes)
    shape = product_shape(sizes)
    cell = np.arange(there[0]) if len(there) == 1 else _cells(there, shape[1])
    if is_upward:
        cell = cell.reshape(shape)[::-1].T.ravel()
    kinds = np.full(shape[0] * shape[1], CellKind.WALL, dtype=object)
    kinds[cell] = CellKind.FLOOR
    return Grid(
        rows=shape[0],
        columns=shape[1],
        kinds=tuple(map(CellKind, kinds.tolist())),
        cell_of_state=tuple(cell.tolist()),
        directions=(None,) * actions,
        legend=_legend(sizes, terms, is_upward=is_upward),
        axes=_axes(sizes, terms, names, is_upward=is_upward),
        body=body,
        name_parts=parts,
    )


def _name_parts(sizes: Sequence[int], terms: Sequence[str]) -> tuple[str, ...]:
    # Forms such as "angle, angular velocity", "angle, velocity" and "ang, vel"
    if len(terms) != len(sizes):
        return ()
    known = [term for term, size in zip(terms, sizes, strict=True) if size > 1]
    nouns = [term.split()[-1] for term in known]
    return ", ".join(known), ", ".join(nouns), ", ".join(noun[:3] for noun in nouns)


def _is_upward(sizes: Sequence[int], body: Body | None) -> bool:
    return body is not None and body.kind in _ACROSS and len(sizes) == len(_that_count(sizes)) == 2


def product_shape(sizes: Sequence[int]) -> tuple[int, int]:
    """Return the rows and columns of :func:`product_grid`."""
    there = _that_count(sizes)
    if len(there) == 1:
        columns = math.ceil(math.sqrt(there[0]))
        return math.ceil(there[0] / columns), columns
    rows, columns, blocks = there[0], there[1], math.prod(there[2:])
    across = min(max(round(math.sqrt(blocks * rows / columns)), 1), blocks)
    return math.ceil(blocks / across) * (rows + 1) - 1, across * (columns + 1) - 1


def _that_count(sizes: Sequence[int]) -> list[int]:
    return [size for size in sizes if size > 1] or [1]


def _legend(sizes: Sequence[int], terms: Sequence[str], *, is_upward: bool) -> str:
    # Such as "angle down, angular velocity across"
    count = sum(size > 1 for size in sizes)
    known = [term for term, size in zip(terms, sizes, strict=False) if size > 1]
    names = known if len(known) == count else [f"part {place}" for place in range(1, count + 1)]
    if count < 2:
        return ""
    blocks = f", blocks: {' and '.join(names[2:])}" if count > 2 else ""
    return f"{names[0]} {'up' if is_upward else 'down'}, {names[1]} across{blocks}"


def _axes(
    sizes: Sequence[int], terms: Sequence[str], names: Sequence[Sequence[str]], *, is_upward: bool
) -> Axes | None:
    # None: too many labels
    there = [place for place, size in enumerate(sizes) if size > 1]
    rows, columns = product_shape(sizes)
    if not names or len(there) < 2 or rows + columns > _MOST_LABELS:
        return None
    down, across = (tuple(names[place]) for place in there[:2])
    below, beside = (*down, ""), (*across, "")
    row_labels = tuple(below[row % len(below)] for row in range(rows))
    column_labels = tuple(beside[column % len(beside)] for column in range(columns))
    known = terms if len(terms) == len(sizes) else [f"part {place + 1}" for place in range(len(sizes))]
    titles: tuple[Title, ...] = ()
    if len(there) == 3 and rows == len(down):
        titles = tuple(
            Title(-1, block * len(beside), len(across), f"{known[there[2]]}: {name}")
            for block, name in enumerate(names[there[2]])
        )
    if is_upward:
        row_labels = row_labels[::-1]
    return Axes(row_labels, column_labels, titles, (known[there[0]], known[there[1]]), is_upward)


def _cells(sizes: Sequence[int], width: int) -> np.ndarray:
    # [product of `sizes`]
    rows, columns, blocks = sizes[0], sizes[1], math.prod(sizes[2:])
    across = (width + 1) // (columns + 1)
    row, column, block = np.unravel_index(np.arange(rows * columns * blocks), (rows, columns, blocks))
    block_row, block_column = np.divmod(block, across)
    cell: np.ndarray = (block_row * (rows + 1) + row) * width + block_column * (columns + 1) + column
    return cell


# Grids known before Gymnasium is imported


_BY_TABLE: Final[Mapping[str, tuple[int, int]]] = {
    "FrozenLake": (4, 4),
    "FrozenLake8x8": (8, 8),
    "CliffWalking": (4, 12),
    "Taxi": TAXI_SHAPE,
}
"""Rows and columns by id without version."""
_BLACKJACK: Final = "Blackjack"


def known_grid(section: GymnasiumSection) -> Grid | None:
    """Return the known part of a drawing without cells, or None."""
    name = re.sub(r"-v\d+$", "", section.id)
    if section.bins is not None:
        sizes = section.bins.sizes
        is_refused = math.prod(sizes) > MOST_STATES
        return None if is_refused else _known_product(name, sizes, section.bins.known_names())
    if name == _BLACKJACK:
        axes = TABLE_AXES if section.table else OBSERVED_AXES
        return Grid(len(axes.rows), len(axes.columns), (), (), (), TABLE_LEGEND, axes=axes)
    if section.table is False or name not in _BY_TABLE:
        return None
    rows, columns = _map_shape(section.kwargs) or _BY_TABLE[name]
    if (rows, columns) == TAXI_SHAPE:
        return Grid(rows, columns, (), (), (), TAXI_LEGEND, axes=TAXI_AXES)
    return Grid(rows, columns, (), (), ())


def _known_product(name: str, sizes: Sequence[int], names: Sequence[Sequence[str]]) -> Grid:
    terms, kind = _TERMS.get(f"{name}Env", ()), _BODIES.get(f"{name}Env")
    body = None if kind is None or len(sizes) != len(terms) else Body(kind, ())
    is_upward = _is_upward(sizes, body)
    if is_upward:
        sizes, terms, names = sizes[::-1], terms[::-1], names[::-1]
    legend = _legend(sizes, terms, is_upward=is_upward)
    axes = _axes(sizes, terms, names, is_upward=is_upward)
    return Grid(*product_shape(sizes), (), (), (), legend, axes=axes, body=body)


def _map_shape(kwargs: Mapping[str, Any]) -> tuple[int, int] | None:
    lines, name = kwargs.get("desc"), kwargs.get("map_name")
    if isinstance(lines, list) and lines and isinstance(lines[0], str):
        return len(lines), len(lines[0])
    found = re.fullmatch(r"(\d{1,2})x(\d{1,2})", name) if isinstance(name, str) else None
    return None if found is None else (int(found[1]), int(found[2]))
