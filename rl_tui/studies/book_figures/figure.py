"""A figure of the book, recomputed: curves, and numbers of ours beside the printed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from rl_tui.studies.pictures.picture import Picture

_STANDARD_ERRORS: Final = 3.0


@dataclass(frozen=True, slots=True)
class BookComparison:
    """One number of the book and ours.

    The book's lies from ``low`` to ``high``: what it prints is rounded, or was read off a figure.
    """

    what: str
    book: str
    """What the book says, as people read it."""
    place: str
    """Where it says so."""
    low: float
    high: float
    ours: float | None
    """None where there is none, such as an episode that never came."""
    stderr: float | None = None
    """Its standard error; None where it is exact, or read off our own curve."""

    @property
    def agrees(self) -> bool:
        """Whether ours lies within the book's range, or outside it by three standard errors at most."""
        if self.ours is None:
            return False
        margin = _STANDARD_ERRORS * (self.stderr or 0.0)
        return self.low - margin <= self.ours <= self.high + margin


@dataclass(frozen=True, slots=True)
class MeasuredCurve:
    """The mean over runs at each ``x``, with its standard error, in the panel of that name.

    All are of one length. A standard error is None where there is one run.
    """

    panel: str
    name: str
    x: Sequence[float]
    mean: Sequence[float]
    stderr: Sequence[float | None]


@dataclass(frozen=True, slots=True)
class MeasuredFigure:
    """What came of recomputing a figure."""

    table: tuple[BookComparison, ...]
    curves: tuple[MeasuredCurve, ...]
    picture: Picture
    notes: tuple[str, ...] = ()


def read_off(what: str, value: float, margin: float, ours: float, stderr: float | None) -> BookComparison:
    """Return a comparison with a number that was read off the printed figure, to within ``margin``."""
    book = f"{value:g} ± {margin:g}".replace("-", "−")
    return BookComparison(what, book, "read off", value - margin, value + margin, ours, stderr)
