"""From results to the picture of them."""

from __future__ import annotations

from collections.abc import Sequence

from rl_tui.common.errors import UserError
from rl_tui.lab.pictures.picture import Picture
from rl_tui.lab.pictures.results.curves import curve_picture
from rl_tui.lab.pictures.results.sweeps import MOST_LINES, sweep_picture
from rl_tui.lab.pictures.results.tables import CurveTable, SweepTable


def picture_of(
    tables: Sequence[CurveTable | SweepTable],
    measure: str | None = None,
    x: str | None = None,
    y: str | None = None,
) -> Picture:
    """Return a picture of curves side by side, or of one sweep.

    Raises UserError where ``tables`` are neither, or have not what is asked for.
    """
    curves = [table for table in tables if isinstance(table, CurveTable)]
    if len(curves) == len(tables):
        if x is not None or y is not None:
            raise UserError("--x and --y are for sweeps: a curve is drawn over its episodes")
        if len(curves) > MOST_LINES:
            raise UserError(f"{len(curves)} curves are too many for one chart: give {MOST_LINES} or fewer")
        return curve_picture(curves, measure)
    sweeps = [table for table in tables if isinstance(table, SweepTable)]
    if len(tables) > 1:
        raise UserError("a sweep is drawn alone: give one file, or several of curves")
    return sweep_picture(sweeps[0], measure, x, y)
