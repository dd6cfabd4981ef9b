"""Numbers and positions of the cells on the axes of settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

from rl_tui.studies.sweeps.cells.variation import Value, Variation

Places = tuple[int, ...]
"""Position of a cell on each axis, from 0."""


@dataclass(frozen=True)
class CellGrid:
    """The cells of all combinations of `variations`. The last setting varies fastest."""

    variations: tuple[Variation, ...]

    @property
    def counts(self) -> Places:
        """Number of values of each setting."""
        return tuple(each.count for each in self.variations)

    @property
    def count(self) -> int:
        """Number of cells."""
        return prod(self.counts)

    def index(self, places: Sequence[int]) -> int:
        """Return the number of the cell at `places`."""
        index = 0
        for place, count in zip(places, self.counts, strict=True):
            index = index * count + place
        return index

    def places(self, index: int) -> Places:
        """Return the position of cell `index` on each axis."""
        found = []
        for count in reversed(self.counts):
            index, place = divmod(index, count)
            found.append(place)
        return tuple(reversed(found))

    def settings(self, index: int) -> dict[str, Value]:
        """Return the settings of cell `index` by name."""
        return {
            each.name: each.value(place)
            for each, place in zip(self.variations, self.places(index), strict=True)
        }

    def moved(self, index: int, steps: Mapping[int, int]) -> int:
        """Return the cell `steps` further on each axis, or at its end."""
        places = list(self.places(index))
        for axis, step in steps.items():
            places[axis] = max(0, min(self.counts[axis] - 1, places[axis] + step))
        return self.index(places)
