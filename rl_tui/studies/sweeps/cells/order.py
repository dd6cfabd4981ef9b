"""The order in which the cells of a grid are gone through: corners first, then always halfway between."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod


@dataclass(frozen=True)
class Axis:
    """One side of a grid: ``count`` values, of which in a ``spread`` those between others can wait."""

    count: int
    spread: bool

    @property
    def levels(self) -> int:
        """The finest level there is: at level 0 stand the two ends, at each further one what lies between."""
        return (self.count - 2).bit_length() if self.spread and self.count > 2 else 0

    def up_to(self, level: int) -> tuple[range, bool]:
        """Return the places that have come by ``level``: a range, and whether the last one comes besides."""
        if level >= self.levels:
            return range(self.count), False
        coarse = range(0, self.count - 1, 2 ** (self.levels - level))
        return coarse, True

    def level_of(self, place: int) -> int:
        """Return the level at which ``place`` comes."""
        if not self.spread or place in (0, self.count - 1):
            return 0
        return self.levels - min(self.levels, (place & -place).bit_length() - 1)


def coarse_first(axes: Sequence[Axis]) -> Iterator[int]:
    """Yield each cell's number once, the last axis running fastest in it: the coarse lattice first.

    It takes no memory to speak of, whatever the size of the grid.
    """
    for level in range(max((axis.levels for axis in axes), default=0) + 1):
        places = [axis.up_to(level) for axis in axes]
        sizes = [len(coarse) + has_last for coarse, has_last in places]
        for number in range(prod(sizes)):
            index, newest, rest = 0, 0, number
            weight = 1
            for axis, (coarse, _), size in zip(
                reversed(axes), reversed(places), reversed(sizes), strict=True
            ):
                rest, at = divmod(rest, size)
                place = coarse[at] if at < len(coarse) else axis.count - 1
                newest = max(newest, axis.level_of(place))
                index += weight * place
                weight *= axis.count
            if newest == level:
                yield index
