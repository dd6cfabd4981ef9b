"""Pictures for several tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rl_tui.studies.pictures.picture import AtlasChart, Chart, ChartCurve, Picture, close_axis, round_axis


def curve(name: str, y: Sequence[float | None], colour: int = 0, **more: Any) -> ChartCurve:
    return ChartCurve(name, tuple(float(x) for x in range(1, len(y) + 1)), tuple(y), colour=colour, **more)


def chart(*curves: ChartCurve, title: str = "return", **more: Any) -> Chart:
    values = [value for each in curves for value in each.y if value is not None]
    return Chart(
        title,
        close_axis("episodes", [x for each in curves for x in each.x]),
        round_axis("", values),
        curves,
        **more,
    )


def atlas(values: Sequence[Sequence[float | None]], title: str = "", **more: Any) -> AtlasChart:
    known = [value for row in values for value in row if value is not None]
    settings: dict[str, Any] = {
        "columns": tuple(f"{column / 10:g}" for column in range(len(values[0]))),
        "rows": tuple(str(row) for row in range(len(values))),
        "alike": tuple(tuple(False for _ in row) for row in values),
        "best": None,
    }
    return AtlasChart(
        title, "ε", "n", values=tuple(map(tuple, values)), scale=round_axis("", known), **{**settings, **more}
    )


def picture(*panels: Chart | AtlasChart, **more: Any) -> Picture:
    return Picture("Of a test", "What is seen.", panels, **more)
