"""Pictures of learning curves: one chart, a line with a band for each file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.studies.pictures.picture import Chart, ChartCurve, Picture, axis_with_cut, close_axis, number_text
from rl_tui.studies.pictures.reading import EPISODE
from rl_tui.studies.pictures.tables import CurveTable

TITLES: Final = {
    "return_mean": "Return per episode",
    "length_mean": "Steps per episode",
    "optimal_action_rate": "Optimal action, share of pulls",
}
"""What can be drawn, by the names of the columns."""
_ERRORS: Final = {
    "return_mean": "return_stderr",
    "length_mean": "length_stderr",
    "optimal_action_rate": "optimal_action_stderr",
}
_NORMAL: Final = 1.96
_BAND: Final = "Bands: the 95 % interval of the mean"


def curve_picture(tables: Sequence[CurveTable], measure: str | None = None) -> Picture:
    """Return the chart of ``measure``, a name of ``TITLES`` or the return, of each of ``tables``.

    Bands are the 95 % interval of the mean: by Student's t where the number of runs is known, else 1.96
    standard errors to either side. Raises UserError where a table has no such column.
    """
    column = measure or "return_mean"
    if column not in TITLES:
        raise UserError(f"a curve has no {column}: choose --measure {' or '.join(TITLES)}")
    for table in tables:
        if column not in table.columns:
            raise UserError(f"{table.name} has no {column}: choose another --measure")
    names = _names(tables)
    curves = tuple(
        _curve(name if len(tables) > 1 else "", table, column, place)
        for place, (name, table) in enumerate(zip(names, tables, strict=True))
    )
    y, cut = axis_with_cut("", curves)
    episodes = [x for curve in curves for x in curve.x]
    runs = [
        f"{name}: {counted(table.runs, 'run')}"
        for name, table in zip(names, tables, strict=True)
        if table.runs
    ]
    heading = TITLES[column] if len(tables) == 1 else ""  # else it is the title
    has_bands = any(value is not None for curve in curves for value in curve.low)
    return Picture(
        title=names[0] if len(tables) == 1 else TITLES[column],
        summary=_summary(TITLES[column], curves),
        panels=(Chart(heading, close_axis("episodes", episodes), y, curves),),
        notes=tuple(filter(None, (f"Means over runs. {'; '.join(runs)}." if runs else "", cut))),
        band=f"{_BAND}{_method(tables)}." if has_bands else "",
    )


def _names(tables: Sequence[CurveTable]) -> list[str]:
    """Return a name for each of ``tables``, no two alike."""
    names = [table.name for table in tables]
    return [
        name if names.count(name) == 1 else f"{name} ({place})" for place, name in enumerate(names, start=1)
    ]


def _curve(name: str, table: CurveTable, column: str, place: int) -> ChartCurve:
    means = table.columns[column]
    errors = table.columns.get(_ERRORS[column], [None] * len(means))
    width = _half_width(table.runs)

    def edge(sign: float) -> tuple[float | None, ...]:
        return tuple(
            None if mean is None or error is None else mean + sign * width * error
            for mean, error in zip(means, errors, strict=True)
        )

    x = tuple(float(value) for value in table.columns[EPISODE] if value is not None)
    return ChartCurve(name, x, tuple(means), low=edge(-1.0), high=edge(1.0), colour=place)


def _half_width(runs: int | None) -> float:
    """Return how many standard errors the 95 % interval of a mean over ``runs`` reaches to either side."""
    if runs is None or runs < 2:
        return _NORMAL
    from scipy.special import stdtrit

    return float(stdtrit(runs - 1, 0.975))


def _method(tables: Sequence[CurveTable]) -> str:
    return (
        ", by Student's t" if all(table.runs for table in tables) else ", 1.96 standard errors to either side"
    )


def _summary(title: str, curves: Sequence[ChartCurve]) -> str:
    last = (next(value for value in reversed(curve.y) if value is not None) for curve in curves)
    ends = "; ".join(
        f"{curve.name or 'it'} ends at {number_text(value)}"
        for curve, value in zip(curves, last, strict=True)
    )
    return f"{title} over episodes, a line for each of {counted(len(curves), 'result')}. {ends}."
