"""Pictures of the Python results: learning curves, and values by state."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.studies.pictures.files import PNG, picture_file, svg_of
from rl_tui.studies.pictures.picture import Chart, ChartCurve, Picture, axis_with_cut, close_axis, word_axis
from rl_tui.studies.pictures.results import TITLES, curve_picture
from rl_tui.studies.pictures.tables import CurveTable

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

SVG: Final = ".svg"
_MOST_NUMBERED: Final = 20
"""Most states with a number below each."""


class ResultPlot:
    """A picture of a result. A notebook shows it, and `save` writes it."""

    def __init__(self, picture: Picture) -> None:
        self._picture = picture

    @property
    def svg(self) -> str:
        """The text of the SVG, equal for equal results."""
        return svg_of(self._picture)

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"{self._picture.title}\n{self._picture.summary}"

    def save(self, path: str | Path) -> None:
        """Write the picture to `path`, as SVG or PNG by the end of the name.

        Raises:
            rl_tui.Error: The name ends otherwise, the file cannot be written, or a PNG cannot be drawn here.
        """
        if Path(path).suffix.lower() not in (SVG, PNG):
            raise UserError(f"{path} does not end in {SVG} or {PNG}")
        with picture_file(Path(path)) as write:
            write(self._picture)


def plot_of_curve(
    name: str, curve: Mapping[str, npt.NDArray[np.float64]], runs: int | None, measure: str | None
) -> ResultPlot:
    """Return the chart of a mean learning curve, with a band for several runs.

    Args:
        name: Title of the chart.
        curve: Name → array over bins, with ``"episode"``; NaN marks a missing number.
        runs: Number of runs in the mean, or None for one run.
        measure: ``"return_mean"`` (None), ``"length_mean"`` or ``"optimal_action_rate"``.

    Raises:
        UserError: The measure is unknown, or no episode was finished.
    """
    if not len(curve["episode"]):
        raise UserError(f"{name}: no episode was finished, so there is no curve")
    measures = [each for each in TITLES if each in curve]
    if measure is not None and measure not in measures:
        raise UserError(
            f"measure is {shown(measure)}; expected {' or '.join(measures)}{near(measure, measures)}"
        )
    columns = {column: _known(values.tolist()) for column, values in curve.items()}
    return ResultPlot(curve_picture([CurveTable(name, columns, runs)], measure))


def curve_of_episodes(returns: npt.NDArray[np.float64], lengths: npt.NDArray[np.int64]) -> dict[str, Any]:
    """Return a curve in at most 200 bins, from the return and length of each episode, [E]."""
    import numpy as np

    from rl_tui.runs.training.seeded_runs import RunCurve

    if not len(returns):
        return {"episode": np.empty(0)}
    curve = RunCurve(len(returns))
    curve(returns, lengths, np.zeros(len(returns), np.bool_))
    points = curve.points
    return {"episode": points.last_episode, "return_mean": points.returns, "length_mean": points.lengths}


def plot_of_values(title: str, values: Sequence[float]) -> ResultPlot:
    """Return a chart of the value of each state, [S]. NaN leaves a gap."""
    known = tuple(_known(values))
    if all(value is None for value in known):
        raise UserError(f"{title}: no state has a value, so there is nothing to draw")
    curve = ChartCurve("", tuple(map(float, range(len(known)))), known)
    axis, cut = axis_with_cut("", [curve])
    is_small = len(known) <= _MOST_NUMBERED
    states = (
        word_axis("state", list(map(str, range(len(known))))) if is_small else close_axis("state", curve.x)
    )
    # a line shows where the marks of many states would hide each other
    chart = Chart("Value of each state", states, axis, (curve,), connected=not is_small)
    summary = f"The value of {len(known):,} states, by the number of the state."
    return ResultPlot(Picture(title, summary, (chart,), tuple(filter(None, (cut,)))))


def _known(values: Sequence[float]) -> list[float | None]:
    return [None if math.isnan(value) else value for value in values]


def pandas_module() -> Any:
    """Return pandas. Raises UserError if it is not installed."""
    try:
        import pandas
    except ImportError as error:
        raise UserError("to_pandas() needs pandas, which is not installed: pip install pandas") from error
    return pandas


def state_frame(
    states: Sequence[str],
    values: npt.NDArray[np.float64],
    actions: Sequence[str],
    of_actions: npt.NDArray[np.float64],
) -> Any:
    """Return a DataFrame with a row for each state: `values`, [S], then `of_actions`, [S, A]."""
    pandas = pandas_module()
    frame = pandas.DataFrame(of_actions, columns=list(actions), index=pandas.Index(states, name="state"))
    frame.insert(0, "value", values, allow_duplicates=True)
    return frame
