"""Q-tables drawn without an app."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.style import Style
from samples import answered, lake, look
from seams import sized
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.panels.q_table.q_table import QTable

PALETTE = look().palette


class Drawn:
    def __init__(
        self,
        state: Snapshot,
        width: int = 36,
        height: int = 17,
        layer: Layer = Layer.Q,
        *,
        revealed: bool = False,
        lights: bool = True,
        ascii_only: bool = False,
    ) -> None:
        state = answered(state, revealed)
        self.table = sized(QTable(look(ascii_only)), width, height)
        self.table.lights = lights
        self.table.wanted_layer = layer
        self.table.show(state)
        self.strips = self.table.picture(state, width, height)
        assert [strip.cell_length for strip in self.strips] == [width] * height

    @property
    def rows(self) -> list[str]:
        return [strip.text for strip in self.strips]

    @property
    def text(self) -> str:
        return "\n".join(self.rows)

    def row(self, start: str) -> str:
        return next(row for row in self.rows if row.replace("◉", " ").strip().startswith(start))

    def style_of(self, row: int, text: str) -> Style:
        style = next(segment.style for segment in self.strips[row] if text in segment.text)
        assert style is not None
        return style


def fresh(state: Snapshot, q: list[float], visits: list[int]) -> Snapshot:
    return changed(state, q=np.array(q), visits=np.array(visits, dtype=np.int64), last_step=None)


def lake_of(values: dict[int, float], **changes: Any) -> Snapshot:
    start = lake(0)
    q, visits = np.zeros(44), np.zeros(44, dtype=np.int64)
    for pair, value in values.items():
        q[pair], visits[pair] = value, 1
    return changed(start, q=q, visits=visits, **changes)
