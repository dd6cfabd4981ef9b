"""A screen on which regions are put, and the result: which panel stands where."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import NamedTuple

from textual.geometry import Region, Size

from rl_tui.screen.frame.shape import ROOMY, SMALL, Shape, map_size, size_class
from rl_tui.screen.kit.row import CURVE, TIMELINE, WORLD, beside
from rl_tui.worlds.drawing import Grid


class Place(NamedTuple):
    """The ``regions`` of the panels in view, by id, and the size of a ``cell`` of the map.

    Without a map, or with none in view, that is 0 × 0.
    """

    regions: dict[str, Region]
    cell: Size


@dataclass
class Sheet:
    """A screen on which regions are put: its class, its margins and the rows from ``top`` to ``foot``."""

    size: Size
    shape: Shape
    shown: Collection[str] | None
    regions: dict[str, Region] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.room = size_class(self.size)
        self.margin, self.gap = (2, 3) if self.room is ROOMY else (1, 2)
        self.top = 2 if self.room is ROOMY else 1
        self.foot = self.size.height - (2 if self.room is ROOMY else 1)
        self.usable = self.size.width - 2 * self.margin
        self.lanes = self.shape.lanes and self.room is not SMALL
        self.blank = 1 if self.room is ROOMY else 0

    def shows(self, panel: str) -> bool:
        """Return whether ``panel`` is to be seen, as far as a page of a lesson names panels."""
        return self.shown is None or panel in self.shown

    def put(self, panel: str, region: Region) -> None:
        """Put ``panel`` there, if that is anywhere."""
        if region.width > 0 and region.height > 0:
            self.regions[panel] = region

    def alone(self, panel: str) -> Place:
        """Return the place of ``panel`` on all of the screen; curve and timeline come together."""
        body = Region(self.margin, 1, self.usable, self.size.height - 2)
        if panel in (CURVE, TIMELINE):
            self.put(CURVE, Region(*body[:3], body.height - 1))
            self.put(TIMELINE, Region(body.x, body.bottom - 1, body.width, 1))
            return Place(self.regions, Size(0, 0))
        self.put(panel, body)
        drawing, cell = self.shape.drawing, Size(0, 0)
        if panel in (WORLD, beside(WORLD)) and isinstance(drawing, Grid):
            high = body.height - 1 - bool(drawing.wind)
            cell = map_size(drawing, body.width, high).cell
        return Place(self.regions, cell)
