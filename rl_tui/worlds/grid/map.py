"""A map of characters and its legend, from a file or random.

Cells are indices into the legend, [rows, columns].
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

from rl_tui.common.findings import Finding, is_plain, shown
from rl_tui.common.limits import LONGEST_SIDE
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.grid.moves import MOVES, STEPS, Terrain
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Number,
    TruthValue,
    WorldRefusedError,
    number,
    whole_number,
    with_control_character,
)

# The legend


KINDS: Final = tuple(kind.value for kind in CellKind)
_GOAL_REWARD: Final = 1.0


def is_character(value: object) -> bool:
    """Return True if `value` can represent a cell of a map."""
    return isinstance(value, str) and len(value) == 1 and is_plain(value)


def _are_moves(value: object) -> bool:
    return isinstance(value, list) and len(value) > 0 and all(each in tuple(STEPS) for each in value)


Character = Annotated[str, Expect("one character", is_character, with_control_character)]


class LegendEntry(FileSection):
    """The meaning of one character on a map.

    The grid says if `reward` is for entering or leaving the cell; for goals the default is 1. Entering a
    `terminal` cell ends the episode, by default in goals and holes. The only action of an `exit` cell ends
    the episode and pays the reward. From a `jump` cell every action leads to the cell of that character. A
    `back` cell sends the agent to the start. In an `only` cell other moves stay in place.
    """

    kind: Annotated[CellKind, Expect(f"one of {', '.join(KINDS)}", lambda value: value in KINDS)]
    reward: Number | None = None
    terminal: TruthValue | None = None
    exit: TruthValue = False
    jump: Character | None = None
    back: TruthValue = False
    only: Annotated[list[str], Expect(f"a list of moves, from {', '.join(STEPS)}", _are_moves)] | None = None

    @property
    def pays(self) -> float:
        """Reward of the cell."""
        if self.reward is not None:
            return self.reward
        return _GOAL_REWARD if self.kind is CellKind.GOAL else 0.0

    @property
    def ends(self) -> bool:
        """True if entering the cell ends the episode."""
        if self.terminal is not None:
            return self.terminal
        return self.kind in (CellKind.GOAL, CellKind.HOLE) and not self.exit

    @property
    def is_wall(self) -> bool:
        """True if the cell cannot be entered."""
        return self.kind is CellKind.WALL


BUILT_IN: Final[Mapping[str, LegendEntry]] = {
    ".": LegendEntry(kind=CellKind.FLOOR),
    " ": LegendEntry(kind=CellKind.FLOOR),
    "S": LegendEntry(kind=CellKind.START),
    "G": LegendEntry(kind=CellKind.GOAL),
    "H": LegendEntry(kind=CellKind.HOLE),
    "#": LegendEntry(kind=CellKind.WALL),
    "<": LegendEntry(kind=CellKind.FLOOR, only=["left"]),
    ">": LegendEntry(kind=CellKind.FLOOR, only=["right"]),
    "^": LegendEntry(kind=CellKind.FLOOR, only=["up"]),
    "v": LegendEntry(kind=CellKind.FLOOR, only=["down"]),
}


def entry_findings(
    entry: LegendEntry, raw: Mapping[str, Any], moves: Sequence[str] | None
) -> Iterator[Finding]:
    """Yield contradictions inside one legend entry. `moves` may be unknown."""
    if entry.is_wall:
        for key in raw:
            if key != "kind":
                yield Finding((key,), f"a wall cannot be entered; leave out {key}")
        return
    if entry.kind is CellKind.START and entry.ends:
        yield Finding(("terminal",), "a start cannot be terminal; leave out terminal")
    elif entry.ends:
        for key in ("exit", "jump", "only", "back"):
            if raw.get(key):
                yield Finding((key,), f"a terminal cell has no {key}; leave it out, or set terminal = false")
    else:
        given = [key for key in ("exit", "jump", "only", "back") if raw.get(key)]
        if len(given) > 1:
            yield Finding((given[1],), f"{given[0]} and {given[1]} are both set; keep one of them")
    if entry.back and entry.kind is CellKind.START:
        yield Finding(("back",), "a start cannot lead back to itself; leave out back")
    for name in entry.only or ():
        if moves is not None and name not in moves:
            yield Finding(("only",), shown(name), f"moves of this grid: {', '.join(moves)}")


# The map


if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    from numpy.random import Generator

    from rl_tui.worlds.mdp.space import BoolArray

    CodeArray = npt.NDArray[np.uint8]

MOST_HOLES: Final = 0.9
# Maps without a way to the goal are drawn again, up to these limits (fewer times for large maps)
_MOST_DRAWN: Final = 1_000
_FEWEST_DRAWN: Final = 5
_MOST_CELLS_DRAWN: Final = 20_000_000

START, FLOOR, HOLE, GOAL = RANDOM_CHARACTERS = "S.HG"
WAY_CHARACTERS: Final = (START, FLOOR, GOAL)


class RandomMap(FileSection):
    """A random map from the top left to the bottom right, with holes between."""

    rows: Annotated[int, whole_number(1, LONGEST_SIDE)]
    columns: Annotated[int, whole_number(1, LONGEST_SIDE)]
    holes: Annotated[float, number(0, MOST_HOLES)] = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class CellMap:
    """A map whose `codes`, [rows, columns], index `characters` and `entries`."""

    codes: CodeArray
    characters: tuple[str, ...]
    entries: tuple[LegendEntry, ...]


def lines_of(text: str) -> list[str]:
    """Return the rows of a map, without surrounding line breaks."""
    return text.strip("\n").split("\n")


def read_map(text: str, legend: Mapping[str, LegendEntry]) -> CellMap:
    """Return the cells of a valid map."""
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
    """Draw maps until one has a way to the goal.

    Raises:
        WorldRefusedError: No map with a way was found.
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
    found = f"none of {attempts:,} random maps had a path to the goal; use fewer holes than {wanted.holes:g}"
    raise WorldRefusedError(("random", "holes"), found)


def with_border(cells: BoolArray) -> BoolArray:
    """Add a border of False to [rows, columns], and flatten it."""
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
    """Return the line and column where `character` first appears, as text."""
    line = next(index for index, line in enumerate(lines) if character in line)
    return f"line {line + 1}, column {lines[line].index(character) + 1}"
