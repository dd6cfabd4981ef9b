"""The tools, with their keys, in columns; a click is as good as the key."""

from __future__ import annotations

from collections.abc import Sequence

from rich.cells import cell_len
from textual import events
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.tui.draw.canvas import Canvas, shortened
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.panels.drawing.sheet import LinePressed, ToolCell, ToolPressed, ToolSheet
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.look import Look


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
            canvas.put(x + 1, 0, key, palette.accent)
            canvas.put(x + 2 + cell_len(key) if key else x + 1, 0, word, palette.text)

    @property
    def _column(self) -> int:
        return column_width(self._sheet.cells, self.look.glyphs)

    def _cells_in(self, row: int) -> Sequence[ToolCell]:
        columns = columns_in(self._sheet.cells, self.size.width, self.look.glyphs)
        return self._sheet.cells[row * columns : (row + 1) * columns]

    def _row(self, y: int) -> tuple[str, int]:
        """Return what stands in row ``y``, and which of its kind it is."""
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
