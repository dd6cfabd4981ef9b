"""The panel of tools, which is there while a person draws the world."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from rich.cells import cell_len
from textual.app import ComposeResult
from textual.containers import Container
from textual.content import Content

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.drawing.sheet import ToolSheet, WorldNumber
from rl_tui.tui.panels.drawing.tool_list import ToolList, rows_of
from rl_tui.tui.panels.panel import BORDER_ENDS, BoardPanel
from rl_tui.tui.theme.look import Look

_TWO_SLIDERS: Final = 44  # columns in which two stand side by side
_WIDE: Final = "-wide"
_SHORT: Final = "-short"


class DrawPanel(Container, BoardPanel):
    """Every tool of the kind of world that is drawn, by its name and key, and a slider for each number.

    What it shows comes from the mode that is on; clicks and sliders go to it as messages.
    """

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self._sheet = ToolSheet()
        self._tools = ToolList(look, id="tools")
        self._is_explained = False

    @property
    def is_explained(self) -> bool:
        """Whether the caption is on the border."""
        return self._is_explained

    @is_explained.setter
    def is_explained(self, is_explained: bool) -> None:
        self._is_explained = is_explained
        self._write_border()

    def compose(self) -> ComposeResult:
        """Yield tools and sliders."""
        yield self._tools
        yield Container(id="world-numbers")

    def show(self, snapshot: Snapshot) -> None:
        """Draw nothing of ``snapshot`` itself: what there is to draw with comes by :meth:`show_sheet`."""

    def show_sheet(self, sheet: ToolSheet) -> None:
        """Show ``sheet``; a slider that is being dragged stays where it is."""
        before, self._sheet = self._sheet, sheet
        self._lay_out()
        if _parameters(before.numbers) != _parameters(sheet.numbers):
            self._write_border()
            self.run_worker(self._replace_sliders(), exclusive=True)
            return
        for slider, number in zip(self.sliders, sheet.numbers, strict=False):
            if not slider.is_held:
                slider.set_value(number.value)

    @property
    def sliders(self) -> Sequence[Slider]:
        """The sliders, in their order."""
        return tuple(self.query(Slider))

    def on_resize(self) -> None:
        """Fit all to the new size."""
        self._lay_out()
        self._write_border()

    def _lay_out(self) -> None:
        """Give the tools their rows; what they are about has some only where all of it fits."""
        width, height = self.size
        if width < 1:
            return
        is_wide = width >= _TWO_SLIDERS
        self.set_class(is_wide, _WIDE)
        halves = sum(1 if is_wide or each.is_short else 2 for each in self._sheet.numbers)
        sliders, glyphs = -(-halves // 2), self.look.glyphs
        in_full = rows_of(self._sheet, width, glyphs, has_about=True)
        has_about = in_full + sliders <= height
        rows = in_full if has_about else rows_of(self._sheet, width, glyphs, has_about=False)
        self._tools.styles.height = rows
        self._tools.draw_sheet(self._sheet, has_about=has_about)
        if self._tools.parent is not None:
            self.query_one("#world-numbers").styles.height = sliders

    def _write_border(self) -> None:
        glyphs, count = self.look.glyphs, len(self._sheet.numbers)
        titles = (f"Draw · {self.caption}", "Draw")[not self._is_explained :]
        fitting = (each for each in titles if cell_len(each) <= self.size.width - BORDER_ENDS)
        keys = f"1–{count}: its sliders" if count > 1 else "1: its slider" if count else ""
        self.border_title = Content(separated(next(fitting, titles[-1]), glyphs))
        self.border_subtitle = Content(separated(keys, glyphs))

    def _made(self) -> Iterable[Slider]:
        glyphs = self.look.glyphs
        labels = [cell_len(to_ascii(each.parameter.symbol, glyphs)) for each in self._sheet.numbers]
        for number in self._sheet.numbers:
            slider = Slider(
                self.look,
                number.parameter,
                number.value,
                reports_at_once=False,
                label_columns=max(labels),
            )
            slider.set_class(number.is_short, _SHORT)
            yield slider

    async def _replace_sliders(self) -> None:
        box = self.query_one("#world-numbers")
        with self.app.batch_update():
            await box.remove_children()
            await box.mount(*self._made())


def _parameters(numbers: Iterable[WorldNumber]) -> list[object]:
    return [each.parameter for each in numbers]
