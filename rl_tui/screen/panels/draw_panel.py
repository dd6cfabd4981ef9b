"""The world editor's tools and sliders."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style
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
from rl_tui.worlds.drawing import CellKind


class Sign(NamedTuple):
    """A brush's kind of cell and character."""

    kind: CellKind
    character: Callable[[Glyphs], str]


@dataclass(frozen=True, slots=True)
class ToolCell:
    """One tool, with a ``word`` for its effect and the ``sign`` of a brush. ``refused``: why it is
    unavailable.
    """

    id: str
    shown: str
    word: str
    is_on: bool = False
    refused: str = ""
    sign: Sign | None = None


@dataclass(frozen=True, slots=True)
class SheetLine:
    """An outcome to choose."""

    text: str
    number: int
    is_on: bool = False


@dataclass(frozen=True, slots=True)
class WorldNumber:
    """A number with a slider, in half a row if ``is_short``."""

    parameter: Parameter
    value: float
    is_short: bool = False


@dataclass(frozen=True, slots=True)
class ToolSheet:
    """The contents of the panel. ``about``: forms of sentences. ``of_number``: tools that change the first
    number.
    """

    in_hand: ToolCell | None = None
    about: tuple[tuple[str, ...], ...] = ()
    lines: tuple[SheetLine, ...] = ()
    cells: tuple[ToolCell, ...] = ()
    of_number: tuple[ToolCell, ...] = ()
    numbers: tuple[WorldNumber, ...] = ()
    rest: tuple[ToolCell, ...] = ()


@dataclass
class ToolPressed(Touched):
    """The user clicked a tool."""

    tool: str


@dataclass
class LinePressed(Touched):
    """The user clicked a line."""

    line: int


# The list of tools


_SIGN: Final = 3  # columns
_HELD: Final = "brush:"
_MOST_SPARE: Final = 4  # most spare columns between two columns of tools
_TWO_SLIDERS: Final = 44  # columns for two sliders in a row


class ToolList(Widget):
    """Current tool, sentences, lines, and tools in columns."""

    def __init__(self, look: Look, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self.look = look
        self._sheet = ToolSheet()
        self._is_roomy = False

    def draw_sheet(self, sheet: ToolSheet, *, is_roomy: bool) -> None:
        """Draw ``sheet``, spaced if ``is_roomy``."""
        if (sheet, is_roomy) != (self._sheet, self._is_roomy):
            self._sheet, self._is_roomy = sheet, is_roomy
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return one row."""
        canvas = Canvas(self.size.width, 1, self.look.palette.text)
        kind, number = self._row(y)
        if kind == "about":
            self._put_about(canvas, number)
        elif kind == "line":
            self._put_line(canvas, self._sheet.lines[number])
        elif kind == "tools":
            columns = _columns(self._sheet.cells, self.size.width, self.look.glyphs)
            for (x, _), cell in zip(columns, self._cells_in(number), strict=False):
                self._put(canvas, x, cell)
        return canvas.strips()[0].apply_style(self.rich_style)

    def on_click(self, event: events.Click) -> None:
        """Report the clicked tool or line."""
        kind, number = self._row(event.y)
        if kind == "line":
            self.post_message(LinePressed(self._sheet.lines[number].number))
        elif kind == "tools":
            columns = _columns(self._sheet.cells, self.size.width, self.look.glyphs)
            for (x, width), cell in zip(columns, self._cells_in(number), strict=False):
                if x <= event.x < x + width:
                    self.post_message(ToolPressed(cell.id))

    def _put_about(self, canvas: Canvas, number: int) -> None:
        palette, glyphs, held, x = self.look.palette, self.look.glyphs, self._sheet.in_hand, 1
        first, second = (palette.strong, palette.dim) if held is None else (palette.dim, palette.text)
        style = first if number == 0 else second if number == 1 else palette.dim
        if held is not None and number == 0:
            if _sign_columns(canvas.width) > 1:
                canvas.put(x, 0, _HELD, palette.dim)
                x += len(_HELD) + 1
            x += self._put_sign(canvas, x, held, _SIGN)
            name = _text(held, glyphs)
            canvas.put(x, 0, name, palette.you + Style(bold=True))
            x += cell_len(name) + 2
        forms = [separated(each, glyphs) for each in self._sheet.about[number]]
        room = canvas.width - x
        text = next((each for each in forms if cell_len(each) <= room), forms[-1])
        canvas.put(x, 0, shortened(text, room, glyphs.ellipsis), style)

    def _put_line(self, canvas: Canvas, line: SheetLine) -> None:
        glyphs, palette = self.look.glyphs, self.look.palette
        mark = glyphs.cursor if line.is_on else " "
        text = shortened(to_ascii(f"{mark}{line.text}", glyphs), canvas.width, glyphs.ellipsis)
        canvas.put(0, 0, text, palette.focus if line.is_on else palette.text)

    def _put(self, canvas: Canvas, x: int, cell: ToolCell) -> None:
        palette, glyphs = self.look.palette, self.look.glyphs
        if _has_signs(self._sheet.cells):
            columns = _sign_columns(self.size.width)
            x += self._put_sign(canvas, x + (columns > 1), cell, columns) - (columns == 1)
        key, word = to_ascii(cell.shown, glyphs), to_ascii(cell.word, glyphs)
        if cell.refused:
            canvas.put(x + 1, 0, _text(cell, glyphs), palette.dim)
        elif cell.is_on:
            canvas.put(x, 0, f" {_text(cell, glyphs)} ", palette.focus)
        else:
            canvas.put(x + 1, 0, key, palette.press)
            canvas.put(x + 2 + cell_len(key), 0, word, palette.text)

    def _put_sign(self, canvas: Canvas, x: int, cell: ToolCell, columns: int) -> int:
        palette, glyphs = self.look.palette, self.look.glyphs
        if cell.sign is not None:
            block = Style(color=palette.wall.bgcolor) if glyphs.name != "ascii" else Style.null()
            styles = {
                CellKind.HOLE: palette.hole,
                CellKind.GOAL: palette.goal,
                CellKind.WALL: palette.wall + block,
                CellKind.CLIFF: palette.cliff,
            }
            character = cell.sign.character(glyphs)
            style = styles.get(cell.sign.kind, palette.unvisited)
            canvas.put(x, 0, character[:columns].center(columns), style)
        return columns + 1

    def _cells_in(self, row: int) -> Sequence[ToolCell]:
        columns = len(_columns(self._sheet.cells, self.size.width, self.look.glyphs))
        return self._sheet.cells[row :: -(-len(self._sheet.cells) // columns)]

    def _row(self, y: int) -> tuple[str, int]:
        for kind, count in _parts(self._sheet, self.size.width, self.look.glyphs):
            if y < count:
                return kind, y
            y -= count + self._is_roomy
            if y < 0:
                break
        return "blank", 0


def _parts(sheet: ToolSheet, width: int, glyphs: Glyphs) -> list[tuple[str, int]]:
    cells = -(-len(sheet.cells) // len(_columns(sheet.cells, width, glyphs)))
    parts = (("about", len(sheet.about)), ("line", len(sheet.lines)), ("tools", cells))
    return [(kind, count) for kind, count in parts if count]


def rows_of(sheet: ToolSheet, width: int, glyphs: Glyphs, *, is_roomy: bool) -> int:
    """Count the rows without numbers and rest."""
    parts = _parts(sheet, width, glyphs)
    return sum(count for _, count in parts) + (len(parts) if is_roomy else 0)


class _Room(NamedTuple):
    sheet: ToolSheet
    is_roomy: bool
    tools: int
    sliders: int


def fitting(sheet: ToolSheet, width: int, height: int, sliders: int, glyphs: Glyphs) -> _Room:
    """Fit ``sheet`` above ``sliders`` rows of sliders.

    Dropped in order: blank rows, texts about the cell, sliders but one row, lines, tools of the number.
    """
    few = replace(sheet, about=sheet.about[:1])
    for shown, is_roomy in ((sheet, True), (sheet, False), (few, False)):
        tools = rows_of(shown, width, glyphs, is_roomy=is_roomy)
        if tools + sliders + bool(sheet.of_number) + 1 + is_roomy <= height:
            return _Room(shown, is_roomy, tools, sliders)
    others = bool(sheet.of_number) + 1
    over = rows_of(few, width, glyphs, is_roomy=False) + min(1, sliders) + others - height
    few = replace(few, lines=_in_view(few.lines, max(1, len(few.lines) - max(0, over)), glyphs))
    tools = rows_of(few, width, glyphs, is_roomy=False)
    if tools + min(1, sliders) + others > height:
        few, others = replace(few, of_number=()), 1
    return _Room(few, False, tools, max(min(1, sliders), min(sliders, height - others - tools)))


def _in_view(lines: tuple[SheetLine, ...], most: int, glyphs: Glyphs) -> tuple[SheetLine, ...]:
    if len(lines) <= most:
        return lines
    on = next((number for number, each in enumerate(lines) if each.is_on), 0)
    whole = max(1, most - 1)
    first = max(0, min(on - whole + 1, len(lines) - whole))
    hint = SheetLine(f" {glyphs.ellipsis} {len(lines) - whole} more: shift+↑ ↓", lines[on].number)
    return (*lines[first : first + whole], hint)[:most]


def _columns(cells: Sequence[ToolCell], width: int, glyphs: Glyphs) -> list[tuple[int, int]]:
    # One blank before sign, key and word, none before a narrow sign
    sign = 0 if not _has_signs(cells) else 1 if _sign_columns(width) == 1 else _SIGN + 1
    half = -(-len(cells) // 2)
    first, second = (
        max((cell_len(_text(each, glyphs)) for each in group), default=0) + sign + 2
        for group in (cells[:half], cells[half:])
    )
    if first + second > width + 1:  # the last column needs no blank after it
        return [(0, width)]
    first += min(max(0, width - first - second) // 2, _MOST_SPARE)
    return [(0, first), (first, width - first)]


def _has_signs(cells: Sequence[ToolCell]) -> bool:
    return any(each.sign is not None for each in cells)


def _sign_columns(width: int) -> int:
    return _SIGN if width >= _TWO_SLIDERS else 1


def _text(cell: ToolCell, glyphs: Glyphs) -> str:
    return to_ascii(f"{cell.shown} {cell.word}".strip(), glyphs)


class ToolRow(Widget):
    """Tools in one row."""

    def __init__(self, look: Look, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self.look = look
        self._cells: Sequence[ToolCell] = ()

    def show(self, cells: Sequence[ToolCell], *, is_apart: bool = False) -> None:
        """Show ``cells``, after a blank row if ``is_apart``."""
        self.styles.height = 0 if not cells else 2 if is_apart else 1
        if cells != self._cells:
            self._cells = cells
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return the row."""
        palette, canvas = self.look.palette, Canvas(self.size.width, 1, self.look.palette.text)
        for x, cell in self._placed() if y == self.size.height - 1 else ():
            key, _, word = _text(cell, self.look.glyphs).partition(" ")
            canvas.put(x, 0, key, palette.dim if cell.refused else palette.press)
            canvas.put(x + cell_len(key) + 1, 0, word, palette.dim if cell.refused else palette.text)
        return canvas.strips()[0].apply_style(self.rich_style)

    def on_click(self, event: events.Click) -> None:
        """Report the clicked tool."""
        for x, cell in self._placed() if event.y == self.size.height - 1 else ():
            if x <= event.x < x + cell_len(_text(cell, self.look.glyphs)):
                self.post_message(ToolPressed(cell.id))

    def _placed(self) -> Iterator[tuple[int, ToolCell]]:
        widths = [cell_len(_text(cell, self.look.glyphs)) for cell in self._cells]
        gap = 2 if sum(widths) + 2 * len(widths) <= self.size.width + 1 else 1
        x = 1
        for cell, width in zip(self._cells, widths, strict=True):
            if x + width > self.size.width:
                return
            yield x, cell
            x += width + gap


# The panel


class DrawPanel(Container, BoardPanel):
    """Tools, and a slider for each number.

    The active mode sets the contents and receives clicks and changes as messages.
    """

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self._sheet = ToolSheet()
        self._tools = ToolList(look, id="tools")
        self._of_number = ToolRow(look)
        self._rest = ToolRow(look)

    def compose(self) -> ComposeResult:
        """Yield tools, sliders, and other tools."""
        yield self._tools
        yield self._of_number
        yield Container(id="world-numbers")
        yield self._rest

    def redraw(self) -> None:
        """Write the border. :meth:`show_sheet` sets the contents."""
        self._write_border()

    def show_sheet(self, sheet: ToolSheet) -> None:
        """Show ``sheet`` without moving a dragged slider."""
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
        """The sliders in order."""
        return tuple(self.query(Slider))

    def on_resize(self) -> None:
        """Refit everything."""
        self._lay_out()
        self._write_border()

    def _lay_out(self) -> None:
        width, height = self.size
        if width < 1:
            return
        is_wide = width >= _TWO_SLIDERS
        self.set_class(is_wide, "-wide")
        halves = [
            2 if number == 0 or not (is_wide or each.is_short) else 1
            for number, each in enumerate(self._sheet.numbers)
        ]
        room = fitting(self._sheet, width, height, -(-sum(halves) // 2), self.look.glyphs)
        self._tools.styles.height = room.tools
        self._tools.draw_sheet(room.sheet, is_roomy=room.is_roomy)
        self._of_number.show(room.sheet.of_number)
        self._rest.show(room.sheet.rest, is_apart=room.is_roomy)
        if self._tools.parent is not None:
            self.query_one("#world-numbers").styles.height = room.sliders

    def _write_border(self) -> None:
        count = len(self._sheet.numbers)
        keys = f" · 1–{count}: sliders" if count > 1 else " · 1: slider" if count else ""
        titles = (f"Draw · {self.caption}{keys}", f"Draw{keys}", "Draw")[not self.is_explained :]
        fitting = (each for each in titles if cell_len(each) <= self.size.width - BORDER_ENDS)
        self.write_border(next(fitting, titles[-1]), "", self.look)

    def _made(self) -> Iterable[Slider]:
        glyphs = self.look.glyphs
        labels = [cell_len(to_ascii(each.parameter.symbol, glyphs)) for each in self._sheet.numbers]
        for place, number in enumerate(self._sheet.numbers):
            slider = Slider(
                self.look, number.parameter, number.value, reports_at_once=False, label_columns=max(labels)
            )
            slider.set_class(place > 0 and number.is_short, "-short")
            slider.set_class(place == 0, "-first")
            yield slider

    async def _replace_sliders(self) -> None:
        box = self.query_one("#world-numbers")
        with self.app.batch_update():
            await box.remove_children()
            await box.mount(*self._made())


def _parameters(numbers: Iterable[WorldNumber]) -> list[object]:
    return [each.parameter for each in numbers]
