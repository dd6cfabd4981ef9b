"""A map of characters, read or drawn at random, as an array."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Final

from rl_tui.common.limits import LONGEST_SIDE
from rl_tui.worlds.grid.legend import LegendEntry
from rl_tui.worlds.grid.moves import MOVES, STEPS, Terrain
from rl_tui.worlds.sections.schema import FileSection, number, whole_number
from rl_tui.worlds.sections.world_section import WorldRefusedError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    from numpy.random import Generator

    from rl_tui.worlds.mdp.space import BoolArray

    CodeArray = npt.NDArray[np.uint8]

MOST_HOLES: Final = 0.9
# A map that was drawn has a way to the goal, or others are drawn: so many, or fewer if they are large
_MOST_DRAWN: Final = 1_000
_FEWEST_DRAWN: Final = 5
_MOST_CELLS_DRAWN: Final = 20_000_000

START, FLOOR, HOLE, GOAL = RANDOM_CHARACTERS = "S.HG"
WAY_CHARACTERS: Final = (START, FLOOR, GOAL)


class RandomMap(FileSection):
    """A map to be drawn: the start at the top left, the goal at the bottom right, holes in between."""

    rows: Annotated[int, whole_number(1, LONGEST_SIDE)]
    columns: Annotated[int, whole_number(1, LONGEST_SIDE)]
    holes: Annotated[float, number(0, MOST_HOLES)] = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class CellMap:
    """Rows × columns cells: ``codes``, [rows, columns], are indices into ``characters`` and ``entries``."""

    codes: CodeArray
    characters: tuple[str, ...]
    entries: tuple[LegendEntry, ...]


def lines_of(text: str) -> list[str]:
    """Return the rows of a map, without line breaks around it."""
    return text.strip("\n").split("\n")


def read_map(text: str, legend: Mapping[str, LegendEntry]) -> CellMap:
    """Return a map that has no faults."""
    import numpy as np

    lines = lines_of(text)
    cells = "".join(lines)
    characters = sorted(set(cells))
    points = np.frombuffer(cells.encode("utf-32-le"), dtype=np.uint32)
    code_of = np.zeros(int(points.max()) + 1, dtype=np.uint8)
    code_of[[ord(character) for character in characters]] = np.arange(len(characters))
    codes = code_of[points].reshape(len(lines), len(lines[0]))
    return CellMap(codes, tuple(characters), tuple(legend[each] for each in characters))


def draw_map(
    wanted: RandomMap, legend: Mapping[str, LegendEntry], moves: str, generator: Generator
) -> CellMap:
    """Return the first map drawn from ``generator`` on which moves alone lead to the goal past the holes.

    Raises WorldRefusedError where none of many does.
    """
    import numpy as np

    shape, cells = (wanted.rows, wanted.columns), wanted.rows * wanted.columns
    attempts = min(max(_MOST_CELLS_DRAWN // cells, _FEWEST_DRAWN), _MOST_DRAWN)
    for _ in range(attempts):
        is_hole = generator.random(shape) < wanted.holes
        is_hole.flat[[0, -1]] = False
        if _is_goal_reachable(is_hole, moves):
            codes = np.where(is_hole, RANDOM_CHARACTERS.index(HOLE), RANDOM_CHARACTERS.index(FLOOR))
            codes.flat[0] = RANDOM_CHARACTERS.index(START)
            codes.flat[-1] = RANDOM_CHARACTERS.index(GOAL)
            entries = tuple(legend[each] for each in RANDOM_CHARACTERS)
            return CellMap(codes.astype(np.uint8), tuple(RANDOM_CHARACTERS), entries)
    found = f"holes in {wanted.holes:g} of the cells, and no way to the goal on {attempts:,} maps drawn"
    raise WorldRefusedError(("random", "holes"), found, "fewer holes")


def with_border(cells: BoolArray) -> BoolArray:
    """Return [rows, columns] truth values within a border of False, row by row in one dimension."""
    import numpy as np

    return np.pad(cells, 1).ravel()


def _is_goal_reachable(is_hole: BoolArray, moves: str) -> bool:
    import numpy as np

    from rl_tui.worlds.mdp.reachable import reachable

    width = is_hole.shape[1] + 2
    free = with_border(~is_hole)
    cells = np.flatnonzero(free).astype(np.int32)
    terrain = Terrain(free, width)
    landed = np.stack([terrain.landings(cells, STEPS[move]).cells for move in MOVES[moves]], axis=1)
    number_of = np.zeros(len(free), dtype=np.int64)
    number_of[cells] = np.arange(len(cells))
    first_edge = np.arange(0, landed.size + 1, landed.shape[1])
    return bool(reachable(first_edge, number_of[landed.ravel()], np.array([0]))[-1])


def first_place(lines: Sequence[str], character: str) -> str:
    """Return where on a map a character first stands, in words."""
    line = next(index for index, line in enumerate(lines) if character in line)
    return f"line {line + 1}, column {lines[line].index(character) + 1}"
