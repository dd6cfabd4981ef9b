"""Movement on a map: steps, slips and wind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from rl_tui.worlds.mdp.space import BoolArray, IntArray

    CellArray = npt.NDArray[np.int32]

STEPS: Final[Mapping[str, tuple[int, int]]] = {
    "left": (0, -1),
    "down": (1, 0),
    "right": (0, 1),
    "up": (-1, 0),
    "down-left": (1, -1),
    "down-right": (1, 1),
    "up-right": (-1, 1),
    "up-left": (-1, -1),
    "stay": (0, 0),
}
"""Rows down and columns right of each move, in the order of the actions (unless clockwise)."""

MOVES: Final[Mapping[str, tuple[str, ...]]] = {
    "four": tuple(STEPS)[:4],
    "clockwise": ("up", "right", "down", "left"),
    "king": tuple(STEPS)[:8],
    "king+stay": tuple(STEPS),
}

COMPASS: Final = tuple(MOVES[name] for name in ("four", "clockwise"))
"""Sets of moves in circular order, so that neighbours are at right angles."""


class Slip(NamedTuple):
    """The move `turn` actions after the meant one (modulo 4)."""

    turn: int
    probability: float


def slips_of(noise: float, slippery: bool) -> tuple[Slip, ...]:
    """Return the possible slips in the order of Gymnasium's tables.

    The two moves at right angles share `noise` (Berkeley CS188 gridworld). On `slippery` ice, all three moves
    are equally likely (Gymnasium's FrozenLake).
    """
    if slippery:
        # as Gymnasium computes it: 1/3, and half of the rest, not exactly 1/3, for each side
        meant = 1.0 / 3.0
        side = (1.0 - meant) / 2.0
    else:
        meant, side = 1.0 - noise, noise / 2.0
    slips = (Slip(-1, side), Slip(0, meant), Slip(1, side))
    return tuple(slip for slip in slips if slip.probability > 0.0)


class Gust(NamedTuple):
    """An addition to the wind, down and right, where it blows."""

    down: int
    right: int


STILL: Final = Gust(0, 0)


class Landings(NamedTuple):
    """Landing cells, [n], and whether something was in the way, [n]."""

    cells: CellArray
    bumped: BoolArray

    def of(self, chosen: IntArray) -> Landings:
        """Return the results for the `chosen` cells."""
        return Landings(self.cells[chosen], self.bumped[chosen])


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """Open cells and wind of a map, inside a border of closed cells.

    All arrays are [(rows + 2) · (columns + 2)]; `width` is columns + 2. Wind is in cells, or None.
    """

    open_cells: BoolArray
    width: int
    wind_down: CellArray | None = None
    wind_right: CellArray | None = None

    def landings(
        self,
        cells: CellArray,
        step: tuple[int, int],
        allowed: BoolArray | None = None,
        gust: Gust = STILL,
    ) -> Landings:
        """Return where a step (rows down, columns right) leads from `cells`, [n].

        Step and wind in opposite directions cancel. The rest of the step happens at once, even diagonally
        between two walls, unless a wall or the edge is in the way. Then the wind pushes cell by cell,
        vertically first, until something is in the way. Cells not `allowed`, [n], feel only the wind.
        """
        import numpy as np

        down, right = (np.full(len(cells), each, dtype=np.int32) for each in step)
        if allowed is not None:
            down *= allowed
            right *= allowed
        down, push_down = _cancelled(down, _wind(self.wind_down, cells, gust.down))
        right, push_right = _cancelled(right, _wind(self.wind_right, cells, gust.right))
        target = cells + down * np.int32(self.width) + right
        bumped = ~self.open_cells[target]
        landed = np.where(bumped, cells, target)
        landed = self._pushed(landed, push_down, self.width)
        landed = self._pushed(landed, push_right, 1)
        return Landings(landed, bumped)

    def _pushed(self, cells: CellArray, push: CellArray | None, offset: int) -> CellArray:
        # Negative counts push backwards
        import numpy as np

        if push is None:
            return cells
        cells, one = cells.copy(), np.sign(push) * np.int32(offset)
        for pushed in range(int(np.abs(push).max(initial=0))):
            target = cells + one
            moves = (np.abs(push) > pushed) & self.open_cells[target]
            if not moves.any():
                break
            cells[moves] = target[moves]
        return cells


def _wind(wind: CellArray | None, cells: CellArray, gust: int) -> CellArray | None:
    import numpy as np

    if wind is None:
        return None
    here = wind[cells]
    return here + np.int32(gust) * (here != 0) if gust else here


def _cancelled(step: CellArray, wind: CellArray | None) -> tuple[CellArray, CellArray | None]:
    import numpy as np

    if wind is None:
        return step, None
    against = step * wind < 0
    return np.where(against, np.int32(0), step), np.where(against, wind + step, wind)
