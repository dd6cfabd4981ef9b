"""The columns of the plot, which the curve and the timeline share."""

from __future__ import annotations

from typing import Final, NamedTuple

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.panels.curve.lane_text import lane_columns
from rl_tui.screen.theme.look import Look

LEFT: Final = 5
"""Columns of the numbers left of the plot."""
_LABELS: Final = ((60, 15), (36, 13))  # columns of the labels at the right, by the least width


class PlotColumns(NamedTuple):
    """The plot has ``columns`` from column ``left`` on; behind them are ``labels`` columns of labels."""

    left: int
    columns: int
    labels: int


def plot_columns(snapshot: Snapshot, look: Look, width: int) -> PlotColumns:
    """Return the columns of the plot in ``width`` cells, which do not change while a run goes on."""
    left = LEFT if width >= 2 * LEFT else 0
    lanes = snapshot.run_group.lanes
    labels = next((columns for least, columns in _LABELS if width >= least), 0)
    if lanes:
        labels = max(labels, lane_columns([lane.name for lane in lanes], look, width - left))
    return PlotColumns(left, max(1, width - left - labels), labels)
