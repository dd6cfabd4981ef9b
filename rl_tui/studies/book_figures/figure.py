"""A recomputed figure: curves and numbers next to the printed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from rl_tui.studies.pictures.picture import Picture

_STANDARD_ERRORS: Final = 3.0


@dataclass(frozen=True, slots=True)
class BookComparison:
    """A number of the book, in [`low`, `high`] because it is rounded or read off, and ours."""

    what: str
    book: str
    """The book's number as text."""
    place: str
    low: float
    high: float
    ours: float | None
    """Our number, or None if there is none, such as an episode that never came."""
    stderr: float | None = None
    """Its standard error, or None if it is exact or read off our curve."""

    @property
    def agrees(self) -> bool:
        """True if our number is at most three standard errors outside the range."""
        if self.ours is None:
            return False
        margin = _STANDARD_ERRORS * (self.stderr or 0.0)
        return self.low - margin <= self.ours <= self.high + margin


@dataclass(frozen=True, slots=True)
class MeasuredCurve:
    """The mean over runs at each `x`, with its standard error."""

    panel: str
    name: str
    x: Sequence[float]
    mean: Sequence[float]
    stderr: Sequence[float | None]


@dataclass(frozen=True, slots=True)
class MeasuredFigure:
    """The result of recomputing a figure."""

    table: tuple[BookComparison, ...]
    curves: tuple[MeasuredCurve, ...]
    picture: Picture
    notes: tuple[str, ...] = ()


def read_off(what: str, value: float, margin: float, ours: float, stderr: float | None) -> BookComparison:
    """Return a comparison with `value` ± `margin`, read off the figure."""
    book = f"{value:g} ± {margin:g}".replace("-", "−")
    return BookComparison(what, book, "read off", value - margin, value + margin, ours, stderr)
