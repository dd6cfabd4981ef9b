"""How one moves on a map: steps, slips and wind."""

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
"""Rows down and columns right of each move; the order is that of the actions, unless they go clockwise."""

MOVES: Final[Mapping[str, tuple[str, ...]]] = {
    "four": tuple(STEPS)[:4],
    "clockwise": ("up", "right", "down", "left"),
    "king": tuple(STEPS)[:8],
    "king+stay": tuple(STEPS),
}

COMPASS: Final = tuple(MOVES[name] for name in ("four", "clockwise"))
"""The moves that go round in a circle, so that one beside the meant one is at a right angle to it."""


class Slip(NamedTuple):
    """A move ``turn`` actions after the meant one (modulo 4) happens in its place with ``probability``."""

    turn: int
    probability: float


def slips_of(noise: float, slippery: bool) -> tuple[Slip, ...]:
    """Return what may happen when a move is meant, in the order of Gymnasium's tables; none impossible.

    ``noise`` is shared by the two moves at right angles to the meant one (the Berkeley CS188 gridworld). On
    slippery ice (Gymnasium's FrozenLake) each of the three is as likely as the others.
    """
    if slippery:
        # Gymnasium's own sum: 1/3 for the meant move, half of the rest, which is not quite 1/3, to each side
        meant = 1.0 / 3.0
        side = (1.0 - meant) / 2.0
    else:
        meant, side = 1.0 - noise, noise / 2.0
    slips = (Slip(-1, side), Slip(0, meant), Slip(1, side))
    return tuple(slip for slip in slips if slip.probability > 0.0)


class Gust(NamedTuple):
    """So much is added to the wind, down and to the right, where there is any."""

    down: int
    right: int


STILL: Final = Gust(0, 0)


class Landings(NamedTuple):
    """Where a move leads from each of n cells, and whether something was in the way, [n] each."""

    cells: CellArray
    bumped: BoolArray

    def of(self, chosen: IntArray) -> Landings:
        """Return those from the ``chosen`` of the n cells."""
        return Landings(self.cells[chosen], self.bumped[chosen])


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """Where one can be, and the wind there.

    A border of closed cells surrounds the map: ``open_cells`` is [(rows + 2) · (columns + 2)], row by row,
    and ``width`` is columns + 2. ``wind_down`` and ``wind_right``, of the same length, tell how many cells
    the wind pushes; None where it blows nowhere.
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
        """Return where ``step`` (rows down, columns right) leads from each of ``cells``, [n].

        Where it is not ``allowed``, [n], there is no step, only wind. Step and wind that point against each
        other cancel out. What is left of the step is taken at once, an oblique one between two walls too, or
        not at all where a wall or the edge is in its way. Then the wind pushes cell by cell, down or up
        before right or left, as far as the way is free.
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
        """Return where ``cells`` are after as many pushes by ``offset`` (against it where below 0)."""
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
    """Return what is left of both along one axis, where a step is of one cell at most."""
    import numpy as np

    if wind is None:
        return step, None
    against = step * wind < 0
    return np.where(against, np.int32(0), step), np.where(against, wind + step, wind)
