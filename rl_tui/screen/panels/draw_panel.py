"""The tools panel of the world editor: every tool with its key, and a slider for each number."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from textual import events
from textual.app import ComposeResult
from textual.containers import Container
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.agents.hyperparameters import Parameter
from rl_tui.screen.draw.canvas import Canvas, shortened
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.kit.panel import BORDER_ENDS, BoardPanel
from rl_tui.screen.kit.pointing import Touched
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look


@dataclass(frozen=True, slots=True)
class ToolCell:
    """One tool: its ``id``, its key as people see it, what it does in a word.

    ``is_on`` says that it is in force, such as a brush; ``refused`` why it can do nothing now.
    """

    id: str
    shown: str
    word: str
    is_on: bool = False
    refused: str = ""


@dataclass(frozen=True, slots=True)
class SheetLine:
    """A line that can be chosen, what tools are about: an outcome of a state."""

    text: str
    is_on: bool = False


@dataclass(frozen=True, slots=True)
class WorldNumber:
    """A number of the world that has a slider, and its value; one ``is_short`` makes do with half a row."""

    parameter: Parameter
    value: float
    is_short: bool = False


@dataclass(frozen=True, slots=True)
class ToolSheet:
    """All of it. ``about`` are sentences, each in its forms, the longest first, for where there is room."""

    about: tuple[tuple[str, ...], ...] = ()
    lines: tuple[SheetLine, ...] = ()
    cells: tuple[ToolCell, ...] = ()
    numbers: tuple[WorldNumber, ...] = ()


@dataclass
class ToolPressed(Touched):
    """The tool with this id was clicked in the panel."""

    tool: str


@dataclass
class LinePressed(Touched):
    """The line of that number was clicked in the panel."""

    line: int


# The list of tools


class ToolList(Widget):
    """Draws a sheet: the sentences about it, lines to choose from, tools in columns of one width."""

    def __init__(self, look: Look, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self.look = look
        self._sheet = ToolSheet()
        self._has_about = True

    def draw_sheet(self, sheet: ToolSheet, *, has_about: bool) -> None:
        """Draw ``sheet``, with what it is about or without."""
        if (sheet, has_about) != (self._sheet, self._has_about):
            self._sheet, self._has_about = sheet, has_about
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Draw one row."""
        width, look = self.size.width, self.look
        palette, glyphs = look.palette, look.glyphs
        canvas = Canvas(width, 1, palette.text)
        kind, number = self._row(y)
        if kind == "about":
            forms = [separated(each, glyphs) for each in self._sheet.about[number]]
            text = next((each for each in forms if cell_len(each) < width), forms[-1])
            canvas.put(1, 0, shortened(text, width - 1, glyphs.ellipsis), palette.dim)
        elif kind == "line":
            line = self._sheet.lines[number]
            mark = glyphs.cursor if line.is_on else " "
            text = shortened(to_ascii(f"{mark}{line.text}", glyphs), width, glyphs.ellipsis)
            canvas.put(0, 0, text, palette.focus if line.is_on else palette.text)
        elif kind == "tools":
            for place, cell in enumerate(self._cells_in(number)):
                self._put(canvas, place * self._column, cell)
        return canvas.strips()[0].apply_style(self.rich_style)

    def on_click(self, event: events.Click) -> None:
        """Tell which tool or line was clicked."""
        kind, number = self._row(event.y)
        if kind == "line":
            self.post_message(LinePressed(number))
        elif kind == "tools":
            cells, place = self._cells_in(number), event.x // self._column
            if place < len(cells):
                self.post_message(ToolPressed(cells[place].id))

    def _put(self, canvas: Canvas, x: int, cell: ToolCell) -> None:
        palette, glyphs = self.look.palette, self.look.glyphs
        key, word = to_ascii(cell.shown, glyphs), to_ascii(cell.word, glyphs)
        if cell.refused:
            canvas.put(x + 1, 0, _text(cell, glyphs), palette.dim)
        elif cell.is_on:
            canvas.put(x, 0, f" {_text(cell, glyphs)} ", palette.focus)
        else:
            canvas.put(x + 1, 0, key, palette.press)
            canvas.put(x + 2 + cell_len(key) if key else x + 1, 0, word, palette.text)

    @property
    def _column(self) -> int:
        return column_width(self._sheet.cells, self.look.glyphs)

    def _cells_in(self, row: int) -> Sequence[ToolCell]:
        columns = columns_in(self._sheet.cells, self.size.width, self.look.glyphs)
        return self._sheet.cells[row * columns : (row + 1) * columns]

    def _row(self, y: int) -> tuple[str, int]:
        about = len(self._sheet.about) if self._has_about else 0
        if y < about:
            return "about", y
        y -= about
        if y < len(self._sheet.lines):
            return "line", y
        return "tools", y - len(self._sheet.lines)


def rows_of(sheet: ToolSheet, width: int, glyphs: Glyphs, *, has_about: bool) -> int:
    """Return how many rows ``sheet`` takes in ``width`` columns."""
    columns = columns_in(sheet.cells, width, glyphs)
    return (len(sheet.about) if has_about else 0) + len(sheet.lines) - (-len(sheet.cells) // columns)


def columns_in(cells: Sequence[ToolCell], width: int, glyphs: Glyphs) -> int:
    """Return how many ``cells`` stand in a row of ``width`` columns."""
    return max(1, (width - 1) // column_width(cells, glyphs))


def column_width(cells: Sequence[ToolCell], glyphs: Glyphs) -> int:
    """Return how wide a column of ``cells`` is, with the blank before it."""
    return max((cell_len(_text(each, glyphs)) for each in cells), default=0) + 1


def _text(cell: ToolCell, glyphs: Glyphs) -> str:
    return to_ascii(f"{cell.shown} {cell.word}".strip(), glyphs)


# The panel


_TWO_SLIDERS: Final = 44  # columns in which two stand side by side


class DrawPanel(Container, BoardPanel):
    """Every tool of the kind of world that is drawn, by its name and key, and a slider for each number.

    What it shows comes from the mode that is on; clicks and sliders go to it as messages.
    """

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self._sheet = ToolSheet()
        self._tools = ToolList(look, id="tools")

    def compose(self) -> ComposeResult:
        """Yield tools and sliders."""
        yield self._tools
        yield Container(id="world-numbers")

    def redraw(self) -> None:
        """Write the border; what there is to draw with comes by :meth:`show_sheet`."""
        self._write_border()

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
        self.set_class(is_wide, "-wide")
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
        count = len(self._sheet.numbers)
        titles = (f"Draw · {self.caption}", "Draw")[not self.is_explained :]
        fitting = (each for each in titles if cell_len(each) <= self.size.width - BORDER_ENDS)
        keys = f"1–{count}: its sliders" if count > 1 else "1: its slider" if count else ""
        self.write_border(next(fitting, titles[-1]), keys, self.look)

    def _made(self) -> Iterable[Slider]:
        glyphs = self.look.glyphs
        labels = [cell_len(to_ascii(each.parameter.symbol, glyphs)) for each in self._sheet.numbers]
        for number in self._sheet.numbers:
            slider = Slider(
                self.look, number.parameter, number.value, reports_at_once=False, label_columns=max(labels)
            )
            slider.set_class(number.is_short, "-short")
            yield slider

    async def _replace_sliders(self) -> None:
        box = self.query_one("#world-numbers")
        with self.app.batch_update():
            await box.remove_children()
            await box.mount(*self._made())


def _parameters(numbers: Iterable[WorldNumber]) -> list[object]:
    return [each.parameter for each in numbers]
