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
class SheetPressed(Touched):
    """The user clicked a tool, by its id, or a line, by its number."""

    what: str | int


# The rows of tools


_SIGN: Final = 3  # columns
_HELD: Final = "brush:"
_MOST_SPARE: Final = 4  # most spare columns between two columns of tools
_TWO_SLIDERS: Final = 44  # columns for two sliders in a row


class ToolLine(NamedTuple):
    """Texts in columns, and what is pressed in which columns."""

    texts: tuple[tuple[int, str, Style], ...] = ()
    spots: tuple[tuple[range, str | int], ...] = ()


class ToolRows(Widget):
    """Rows of tools, sentences and lines."""

    def __init__(self, look: Look, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self.look = look
        self._rows: Sequence[ToolLine] = ()

    def show(self, rows: Sequence[ToolLine]) -> None:
        """Show ``rows``."""
        self.styles.height = len(rows)
        if rows != self._rows:
            self._rows = rows
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return one row."""
        canvas = Canvas(self.size.width, 1, self.look.palette.text)
        for row in self._rows[y : y + 1]:
            for x, text, style in row.texts:
                canvas.put(x, 0, text, style)
        return canvas.strips()[0].apply_style(self.rich_style)

    def on_click(self, event: events.Click) -> None:
        """Report the clicked tool or line."""
        for row in self._rows[event.y : event.y + 1]:
            for columns, what in row.spots:
                if event.x in columns:
                    self.post_message(SheetPressed(what))


def sheet_rows(sheet: ToolSheet, width: int, look: Look, *, is_roomy: bool) -> list[ToolLine]:
    """Return current tool, sentences, lines, and tools in columns, spaced if ``is_roomy``."""
    parts = (
        [_about(sheet, number, width, look) for number in range(len(sheet.about))],
        [_line(line, width, look) for line in sheet.lines],
        _in_columns(sheet.cells, width, look),
    )
    return [row for part in parts if part for row in (*part, *[ToolLine()] * is_roomy)]


def row_of(cells: Sequence[ToolCell], width: int, look: Look) -> list[ToolLine]:
    """Return the row of ``cells`` that fit, if any."""
    widths = [cell_len(_text(cell, look.glyphs)) for cell in cells]
    gap = 2 if sum(widths) + 2 * len(widths) <= width + 1 else 1
    texts, spots, x = list[tuple[int, str, Style]](), list[tuple[range, str | int]](), 1
    for cell, columns in zip(cells, widths, strict=True):
        if x + columns > width:
            break
        texts += _key_and_word(x, cell, look)
        spots.append((range(x, x + columns), cell.id))
        x += columns + gap
    return [ToolLine(tuple(texts), tuple(spots))] if cells else []


def _key_and_word(x: int, cell: ToolCell, look: Look) -> tuple[tuple[int, str, Style], ...]:
    palette, (key, word) = look.palette, (look.glyphs.spelled(each) for each in (cell.shown, cell.word))
    inks = (palette.dim, palette.dim) if cell.refused else (palette.press, palette.text)
    return (x, key, inks[0]), (x + cell_len(key) + 1, word, inks[1])


def _about(sheet: ToolSheet, number: int, width: int, look: Look) -> ToolLine:
    palette, glyphs, held, x = look.palette, look.glyphs, sheet.in_hand, 1
    first, second = (palette.strong, palette.dim) if held is None else (palette.dim, palette.text)
    style = first if number == 0 else second if number == 1 else palette.dim
    texts = list[tuple[int, str, Style]]()
    if held is not None and number == 0:
        if _sign_columns(width) > 1:
            texts.append((x, _HELD, palette.dim))
            x += len(_HELD) + 1
        texts += _sign(x, held, _SIGN, look)
        x += _SIGN + 1
        name = _text(held, glyphs)
        texts.append((x, name, palette.you + Style(bold=True)))
        x += cell_len(name) + 2
    forms = [glyphs.separated(each) for each in sheet.about[number]]
    text = next((each for each in forms if cell_len(each) <= width - x), forms[-1])
    return ToolLine((*texts, (x, shortened(text, width - x, glyphs.ellipsis), style)))


def _line(line: SheetLine, width: int, look: Look) -> ToolLine:
    glyphs, palette = look.glyphs, look.palette
    mark = glyphs.cursor if line.is_on else " "
    text = shortened(glyphs.spelled(f"{mark}{line.text}"), width, glyphs.ellipsis)
    style = palette.focus if line.is_on else palette.text
    return ToolLine(((0, text, style),), ((range(width), line.number),))


def _in_columns(cells: Sequence[ToolCell], width: int, look: Look) -> list[ToolLine]:
    columns = _columns(cells, width, look.glyphs)
    rows = [ToolLine()] * -(-len(cells) // len(columns))
    for place, cell in enumerate(cells):
        column, row = divmod(place, len(rows))
        x, own = columns[column]
        texts = _in_list(x, cell, width if _has_signs(cells) else None, look)
        before = rows[row]
        rows[row] = ToolLine((*before.texts, *texts), (*before.spots, (range(x, x + own), cell.id)))
    return rows


def _in_list(x: int, cell: ToolCell, width: int | None, look: Look) -> Iterator[tuple[int, str, Style]]:
    palette, glyphs = look.palette, look.glyphs
    if width is not None:  # of a list with signs
        columns = _sign_columns(width)
        yield from _sign(x + (columns > 1), cell, columns, look)
        x += columns + (columns > 1)
    if cell.refused:
        yield x + 1, _text(cell, glyphs), palette.dim
    elif cell.is_on:
        yield x, f" {_text(cell, glyphs)} ", palette.focus
    else:
        yield from _key_and_word(x + 1, cell, look)


def _sign(x: int, cell: ToolCell, columns: int, look: Look) -> Iterator[tuple[int, str, Style]]:
    palette, glyphs = look.palette, look.glyphs
    if cell.sign is not None:
        block = Style(color=palette.wall.bgcolor) if glyphs.name != "ascii" else Style.null()
        styles = {
            CellKind.HOLE: palette.hole,
            CellKind.GOAL: palette.goal,
            CellKind.WALL: palette.wall + block,
            CellKind.CLIFF: palette.cliff,
        }
        style = styles.get(cell.sign.kind, palette.unvisited)
        yield x, cell.sign.character(glyphs)[:columns].center(columns), style


def rows_of(sheet: ToolSheet, width: int, glyphs: Glyphs, *, is_roomy: bool) -> int:
    """Count the rows of :func:`sheet_rows`."""
    cells = -(-len(sheet.cells) // len(_columns(sheet.cells, width, glyphs)))
    return sum(count + is_roomy for count in (len(sheet.about), len(sheet.lines), cells) if count)


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
    return glyphs.spelled(f"{cell.shown} {cell.word}".strip())


class DrawPanel(Container, BoardPanel):
    """Tools, and a slider for each number. The active mode sets them and receives messages."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self._sheet = ToolSheet()
        self._tools = ToolRows(look, id="tools")
        self._of_number = ToolRows(look)
        self._rest = ToolRows(look)

    def compose(self) -> ComposeResult:
        """Yield tools, sliders, and other tools."""
        yield self._tools
        yield self._of_number
        yield Container(id="world-numbers")
        yield self._rest

    def show_sheet(self, sheet: ToolSheet) -> None:
        """Show ``sheet`` without moving a dragged slider."""
        before, self._sheet = self._sheet, sheet
        self._lay_out()
        if _parameters(before.numbers) != _parameters(sheet.numbers):
            self.redraw()
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
        self.redraw()

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
        room, look = fitting(self._sheet, width, height, -(-sum(halves) // 2), self.look.glyphs), self.look
        self._tools.show(sheet_rows(room.sheet, width, look, is_roomy=room.is_roomy))
        self._of_number.show(row_of(room.sheet.of_number, width, look))
        self._rest.show([*[ToolLine()] * room.is_roomy, *row_of(room.sheet.rest, width, look)])
        if self._tools.parent is not None:
            self.query_one("#world-numbers").styles.height = room.sliders

    def redraw(self) -> None:
        """Write the border. :meth:`show_sheet` sets the contents."""
        count = len(self._sheet.numbers)
        keys = f" · 1–{count}: sliders" if count > 1 else " · 1: slider" if count else ""
        titles = (f"Draw · {self.caption}{keys}", f"Draw{keys}", "Draw")[not self.is_explained :]
        fitting = (each for each in titles if cell_len(each) <= self.size.width - BORDER_ENDS)
        self.write_border(next(fitting, titles[-1]), "", self.look)

    def _made(self) -> Iterable[Slider]:
        glyphs = self.look.glyphs
        labels = [cell_len(glyphs.spelled(each.parameter.symbol)) for each in self._sheet.numbers]
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
