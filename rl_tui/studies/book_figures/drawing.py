"""Charts of measured curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve
from rl_tui.studies.pictures.picture import ChartCurve, number_text

BAND: Final = "Bands: the 95 % interval of the mean, 1.96 standard errors to either side."
_HALF_WIDTH: Final = 1.96


def summary_of_comparisons(what: str, table: Sequence[BookComparison]) -> str:
    """Return the text alternative: `what` the picture shows, and the numbers."""
    figures = (f"{each.what}: {'none' if each.ours is None else number_text(each.ours)}" for each in table)
    return f"{what} {'; '.join(figures)}."


def drawn(curve: MeasuredCurve, colour: int, *, dashed: bool = False) -> ChartCurve:
    """Return `curve` with its 95 % interval."""
    return ChartCurve(
        curve.name,
        tuple(curve.x),
        tuple(curve.mean),
        low=_edge(curve, -_HALF_WIDTH),
        high=_edge(curve, _HALF_WIDTH),
        colour=colour,
        dashed=dashed,
    )


def _edge(curve: MeasuredCurve, errors: float) -> tuple[float | None, ...]:
    return tuple(
        None if error is None else mean + errors * error
        for mean, error in zip(curve.mean, curve.stderr, strict=True)
    )


def panel_of(curves: Sequence[MeasuredCurve], name: str) -> tuple[ChartCurve, ...]:
    """Return the curves in the panel `name`, in different colours."""
    inside = [curve for curve in curves if curve.panel == name]
    return tuple(drawn(curve, place) for place, curve in enumerate(inside))
