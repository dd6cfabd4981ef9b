"""Templates of new scenarios."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.common.streams import streams
from rl_tui.worlds.files.shipped import SUFFIX, shipped_folder, shipped_names
from rl_tui.worlds.sections.schema import WorldRefusedError

BLANK: Final = ("grid", "mdp", "bandit")
LAKE, MAZE = "lake", "maze"
LAKE_HOLES: Final = (0.2, 0.1, 0.05, 0.0)
"""Share of holes. The next one is tried if there is no way to the goal."""
LARGEST_SIDE: Final = 200
"""Largest number of rows and columns of a random map."""
_FOLDER: Final = os.path.join(os.path.dirname(os.path.abspath(__file__)), "blank")

Draw = Callable[[int, int, int], list[str]]


def template_text(template: str, seed: int = 0, rows: int | None = None, columns: int | None = None) -> str:
    """Return the text of a new scenario file.

    Args:
        template: One of ``BLANK``, ``lake`` or ``maze`` (random, always solvable), or a shipped scenario.
        seed: Seed of a random map.
        rows: Of a random map; None: the default.
        columns: Of a random map; None: the default.

    Raises:
        UserError: The template does not exist, or the size does not fit.
    """
    if template in SIZES:
        size = SIZES[template]
        return _random_text(template, seed, rows or size[0], columns or size[1])
    if rows is not None or columns is not None:
        raise UserError(
            f"{shown(template)} has a fixed size: --rows and --columns work only with {LAKE} and {MAZE}"
        )
    if template in BLANK:
        return _read(os.path.join(_FOLDER, f"{template}{SUFFIX}"))
    if template in shipped_names():
        return _read(str(shipped_folder() / f"{template}{SUFFIX}"))
    names = (*BLANK, *SIZES, *shipped_names())
    raise UserError(
        f"there is no template {shown(template)}{near(template, names)}; take {', '.join((*BLANK, *SIZES))} "
        "or the id of a scenario (rl-tui list)"
    )


def named(text: str, title: str) -> str:
    """Replace the title of a scenario file, shortened if too long."""
    import tomlkit

    from rl_tui.worlds.files.scenario import LONGEST_TITLE

    document = tomlkit.parse(text)
    document["title"] = title[:LONGEST_TITLE]
    return tomlkit.dumps(document)


def lake(rows: int, columns: int, seed: int) -> list[str]:
    """Return the lines of a random lake with a way to the goal."""
    from rl_tui.worlds.grid.map import BUILT_IN, RandomMap, draw_map

    for holes in LAKE_HOLES:
        wanted = RandomMap(rows=rows, columns=columns, holes=holes)
        with suppress(WorldRefusedError):
            drawn = draw_map(wanted, BUILT_IN, "four", streams(seed).world)
            break
    return ["".join(drawn.characters[code] for code in line) for line in drawn.codes.tolist()]


def maze(rows: int, columns: int, seed: int) -> list[str]:
    """Return the lines of a random maze, with one way between any two cells.

    A random walk never enters a cell twice and goes back at dead ends.

    Raises:
        UserError: `rows` or `columns` is even. Every second line is a wall.
    """
    for name, size in (("rows", rows), ("columns", columns)):
        if size % 2 == 0:
            larger = f" or {size + 1}" if size < LARGEST_SIDE else ""
            raise UserError(f"a maze needs an odd number: --{name} {size - 1}{larger}, not {size}")
    generator = streams(seed).world
    cells = [["#"] * columns for _ in range(rows)]
    cells[0][0] = "."
    way = [(0, 0)]
    while way:
        row, column = way[-1]
        around = [(row + 2, column), (row - 2, column), (row, column + 2), (row, column - 2)]
        free = [(r, c) for r, c in around if 0 <= r < rows and 0 <= c < columns and cells[r][c] == "#"]
        if not free:
            way.pop()
            continue
        to = free[int(generator.integers(len(free)))]
        cells[to[0]][to[1]] = cells[(row + to[0]) // 2][(column + to[1]) // 2] = "."
        way.append(to)
    cells[0][0], cells[-1][-1] = "S", "G"
    return ["".join(line) for line in cells]


SIZES: Final[Mapping[str, tuple[int, int]]] = {LAKE: (8, 8), MAZE: (9, 15)}
"""Default rows and columns of random maps."""
_DRAW: Final[Mapping[str, Draw]] = {LAKE: lake, MAZE: maze}


def _random_text(template: str, seed: int, rows: int, columns: int) -> str:
    import tomlkit

    from rl_tui.worlds.editing.saving import map_text

    if rows * columns < 2 or max(rows, columns) > LARGEST_SIDE:
        raise UserError(
            f"{rows} × {columns} cells: expected 2 cells or more, and at most {LARGEST_SIDE} rows and columns"
        )
    document = tomlkit.parse(_read(os.path.join(_FOLDER, f"grid{SUFFIX}")))
    document["summary"] = f"A {template} of {rows}×{columns} cells, drawn with seed {seed}."
    grid = document["grid"]
    grid["map"] = tomlkit.value(map_text(_DRAW[template](rows, columns, seed)))
    grid["time_limit"] = max(200, 4 * rows * columns)
    return tomlkit.dumps(document)


def _read(path: str) -> str:
    with open(path, encoding="utf-8") as stream:
        return stream.read()
