"""The order of cells in a grid: corners first, then repeatedly halfway between."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod


@dataclass(frozen=True)
class Axis:
    """A side of a grid. In a `spread`, values between others can wait."""

    count: int
    spread: bool

    @property
    def levels(self) -> int:
        """Number of the finest level. Level 0 has the two ends."""
        return (self.count - 2).bit_length() if self.spread and self.count > 2 else 0

    def up_to(self, level: int) -> tuple[range, bool]:
        """Return the positions up to `level`: a range, and whether to add the last one."""
        if level >= self.levels:
            return range(self.count), False
        coarse = range(0, self.count - 1, 2 ** (self.levels - level))
        return coarse, True

    def level_of(self, place: int) -> int:
        """Return the level of `place`."""
        if not self.spread or place in (0, self.count - 1):
            return 0
        return self.levels - min(self.levels, (place & -place).bit_length() - 1)


def coarse_first(axes: Sequence[Axis]) -> Iterator[int]:
    """Yield each cell once, a coarse lattice first. The last axis varies fastest in its number."""
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
