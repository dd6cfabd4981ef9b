"""The look of map cells, drawn once each."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from functools import lru_cache, partial
from typing import Final

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Drawn, strips_of_row
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.layers import veiled
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.cell import NO_VALUE, Face, drawn_cell
from rl_tui.screen.panels.grid.form import CellForm
from rl_tui.screen.panels.grid.map import PLAIN, CellContent
from rl_tui.screen.panels.grid.marks import MOST_LEAD, CellReward, reward_text, value_text
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import CellKind

_DIGIT: Final = "\ue000"  # placeholder for each character of a number: not used elsewhere
MOST_KEPT: Final = 2_048  # as on a large screen. More would make garbage collections longer
MOST_ROWS: Final = 256  # above any screen: with fewer, each row of a larger map would be drawn again


class CellArtist:
    """Draws equal cells only once."""

    def __init__(self, look: Look, form: CellForm) -> None:
        self.look = look
        self.form = form
        self.veils = False
        """Whether missing numbers are shown as hidden."""
        palette = look.palette
        self._end_styles = {
            CellKind.HOLE: palette.hole,
            CellKind.GOAL: palette.goal,
            CellKind.WALL: palette.wall,
            CellKind.CLIFF: palette.cliff,
        }
        # equal rows are drawn once
        self.strips = lru_cache(MOST_ROWS)(self._strips)
        self._drawn = lru_cache(MOST_KEPT)(partial(drawn_cell, form=form, look=look))
        self._text = lru_cache(MOST_KEPT)(partial(value_text, look=look))

    def _strips(self, faces: tuple[Face, ...], width: int) -> tuple[Strip, ...]:
        return strips_of_row([self.drawn(face) for face in faces], width, self.look.palette.text)

    def drawn(self, face: Face) -> Drawn:
        """Return a cell's rows. Other digits share a cached drawing."""
        if not face.text or face.text == NO_VALUE or self.form.has_block_values:
            return self._drawn(face)
        digits, place = _DIGIT * len(face.text), self.form.value_row
        rows = self._drawn(face._replace(text=digits))
        told = list(rows[place])
        for number, (text, style, _) in enumerate(told):
            if digits in text:
                told[number] = Segment(text.replace(digits, face.text), style)
        return [*rows[:place], told, *rows[place + 1 :]]

    def shown_reward(self, reward: CellReward) -> str:
        """Write a cell's reward."""
        # one character in cells of one or two rows
        return reward_text(reward, self.form.width if self.form.height > 2 else 1, self.look)

    def face(
        self, cell: CellContent, scale: ValueScale, number_form: NumberForm, leads: Sequence[float]
    ) -> Face:
        """Return a cell's look. ``leads``: steps of a greedy action's colour."""
        palette, extra = self.look.palette, cell.extra or PLAIN
        marks = cell.reward, cell.stops, cell.cursor, cell.differs, extra
        if cell.value is None:
            style = self._end_styles.get(cell.kind, palette.unvisited)
            return Face(cell.kind, cell.agent, None, (), style, MOST_LEAD, *marks)
        is_veiled = self.veils and cell.value != cell.value
        style = scale.style(cell.value, palette) if cell.known and not is_veiled else palette.unvisited
        if is_veiled:
            text = veiled(self.look.glyphs)
        elif abs(cell.value) < numbers.NEGLIGIBLE:
            text = NO_VALUE if cell.known else ""
        else:
            text = self._text(cell.value, number_form._replace(leading_zero=False))
            text = self.look.glyphs.no_room if "#" in text else text
        lead = bisect_right(leads, cell.lead)  # NaN, the lead over a policy that may never end, has the most
        return Face(cell.kind, cell.agent, text, cell.greedy, style, lead, *marks)
