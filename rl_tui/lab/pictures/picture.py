"""A picture as data: panels one below the other, each a chart or an atlas, without colours and pixels."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.lab.pictures.axis import ChartAxis


@dataclass(frozen=True, slots=True)
class ChartCurve:
    """A line through points, in the order of ``x``, with a band around it where ``low`` and ``high`` are.

    All are of one length but for ``low`` and ``high``, which may be empty. None is a gap.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float | None, ...]
    low: tuple[float | None, ...] = ()
    high: tuple[float | None, ...] = ()
    colour: int = 0
    """Its place among the colours; curves that belong together share it."""
    dashed: bool = False

    @property
    def stretches(self) -> list[range]:
        """The places of the points between gaps: one line each."""
        return _stretches([value is not None for value in self.y])

    @property
    def band_stretches(self) -> list[range]:
        """The places of the points of the band, likewise."""
        pairs = zip(self.low, self.high, strict=True)
        return _stretches([low is not None and high is not None for low, high in pairs])


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over one pair of axes. The title may be empty, and so may the names of all curves."""

    title: str
    x: ChartAxis
    y: ChartAxis
    curves: tuple[ChartCurve, ...]
    connected: bool = True
    """Whether lines join the points; if not, each has its interval beside it."""

    @property
    def has_few_points(self) -> bool:
        """Whether each point is worth a mark of its own."""
        return all(len(curve.x) <= _MOST_MARKED for curve in self.curves)


@dataclass(frozen=True, slots=True)
class AtlasChart:
    """A measure over two settings, a cell for each pair of values. The title may be empty.

    ``values`` and ``alike`` are [rows][columns]; the first row is the lowest. None is a cell without a value.
    """

    title: str
    x_label: str
    y_label: str
    columns: tuple[str, ...]
    """The names of the columns."""
    rows: tuple[str, ...]
    """The names of the rows."""
    values: tuple[tuple[float | None, ...], ...]
    scale: ChartAxis
    """What the colours mean."""
    alike: tuple[tuple[bool, ...], ...]
    """Whether a cell does not differ from the best."""
    best: tuple[int, int] | None
    """Row and column of the best cell, None where nothing says which is."""

    @property
    def marked(self) -> set[tuple[int, int]]:
        """Rows and columns of the cells that do not differ from the best, without it."""
        alike = {
            (row, column)
            for row, cells in enumerate(self.alike)
            for column, is_alike in enumerate(cells)
            if is_alike
        }
        return alike - {self.best}


@dataclass(frozen=True, slots=True)
class Picture:
    """What is drawn: ``panels`` one below the other, under a ``title``, with ``notes`` at the end.

    ``summary`` tells the picture to those who cannot see it.
    """

    title: str
    summary: str
    panels: tuple[Chart | AtlasChart, ...]
    notes: tuple[str, ...] = ()
    band: str = ""
    """What the bands around curves mean; said where they are drawn."""


_MOST_MARKED = 40


def _stretches(there: list[bool]) -> list[range]:
    stretches, start = [], None
    for place, is_there in enumerate([*there, False]):
        if is_there and start is None:
            start = place
        elif not is_there and start is not None:
            stretches.append(range(start, place))
            start = None
    return stretches
