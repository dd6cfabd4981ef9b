"""Return curves drawn without an app."""

from __future__ import annotations

import numpy as np
from samples import answered, look

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve, Marks
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.panels.curve.curve import ReturnCurve

NARROW, WIDE = (40, 7), (60, 13)
NO_MARKS = Marks(np.array([], dtype=np.int64), np.array([], dtype=np.int64), np.array([]))


def drawn(
    snapshot: Snapshot | None,
    size: tuple[int, int] = WIDE,
    *,
    ascii: bool = False,  # noqa: A002
    revealed: bool = False,
) -> tuple[str, ReturnCurve]:
    widget = ReturnCurve(look(ascii))
    widget.snapshot = snapshot = answered(snapshot, revealed)
    rows = widget.picture(snapshot, *size)
    assert [row.cell_length for row in rows] == [size[0]] * size[1]
    return "\n".join(row.text for row in rows), widget


def flat(value: float, episodes: int = 1_234) -> Curve:
    values = np.full(episodes // 2, value)
    ends = np.linspace(2, episodes, episodes // 2).astype(np.int64)
    return Curve(ends, values, values, values, values)


def steps(start: list[float], end: list[float], values: list[float]) -> Steps:
    value = np.array(values)
    return Steps(np.array(start), np.array(end), value, value)
