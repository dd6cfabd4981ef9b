"""Dialogs with a line to type into, rows, and three lines about one."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

from rich.cells import cell_len, set_cell_size
from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.common.errors import UserError
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.kit.bindings import RowList, as_sentence
from rl_tui.screen.theme.glyphs import UNICODE, Glyphs

ABOUT_ROWS: Final = 3
CURRENT: Final = " (current)"
NOT_HERE: Final = "not here: "
_UNAVAILABLE: Final = "not available"
_MOVE: Final = "↑ ↓: choose"
_CLOSE: Final = "esc: close"
_WIDE: Final = "   "
_MOST_COLUMNS: Final = 90
_FRAME: Final = 5  # cells: border, padding and scroll bar
MARKS: Final = 4
"""Cells before a name: number and cursor."""
_GAP: Final = 2
_BORDER: Final = 2
_LEAST_ROWS: Final = 3
_LEAST_BESIDE: Final = (32, 60)  # cells beside a page: for names alone, for names with more
_BLANK_FROM: Final = 24  # rows of the screen: there is a blank row above the three lines
_LONGEST: Final = 1_000  # characters: a pasted book is cut off

Reader = Callable[[str], float | str]
"""Turns typed text into a value, or raises a ValueError or UserError with what was expected."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A row, with ``lines`` or why ``refused``."""

    id: str
    name: str
    lines: tuple[str, ...] = ()
    refused: str = ""
    value: str = ""
    words: str = ""


@dataclass(frozen=True, slots=True)
class TypedLine:
    """A line with a first text and a hint."""

    text: str
    hint: str
    read: Reader

    def fault(self, text: str) -> str:
        """Return the error as a sentence, or ""."""
        try:
            self.read(text)
        except (ValueError, UserError) as fault:
            return as_sentence(str(fault))
        return ""


class Form(Dialog[Any]):
    """Rows to choose from, and a line to type into. The answer is a row's id or the typed value.

    ``current``: the row that applies now. ``does``: a word for enter.
    """

    least_room: ClassVar[int] = 40
    """The least cells of a row, if the screen has them."""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("q", "cancel", "back", id="close_form", tooltip="Close without a change."),
        Binding("down", "to_list", "list", id="form.list", tooltip="Go from the line to the list."),
        *(Binding(str(digit), f"take({digit})", show=False) for digit in range(1, 10)),
    ]

    def __init__(
        self,
        title: str,
        candidates: Iterable[Candidate],
        current: str,
        glyphs: Glyphs,
        question: str = "",
        *,
        entry: TypedLine | None = None,
        does: str = "do",
        keys: str = "",
        start: str = "",
    ) -> None:
        super().__init__()
        self._title = title
        self._question = question
        self.candidates = tuple(candidates)
        self.current = current
        self.glyphs = glyphs
        self.entry = entry
        self._does = does
        self._keys = keys
        self._start = start or current
        self.typed = "" if entry is None else entry.text
        """The text in the line."""
        self.page: Widget | None = None
        """The page of a lesson: the box is beside it, or at the bottom, so that it stays readable."""
        self.room = MARKS + 1
        """The cells of a row."""
        self._columns: tuple[int, ...] = ()

    # Appearance

    def compose(self) -> ComposeResult:
        """Yield line, list and text."""
        with self.box(self.glyphs.spelled(self._title), ""):
            if self._question:
                yield Static(self.glyphs.spelled(self._question), id="question", markup=False)
            if self.entry is not None:
                yield Input(self.entry.text, select_on_focus=True, compact=True, max_length=_LONGEST)
            if self.candidates:
                yield RowList()
            yield Static(classes="hint", id="about", markup=False)

    def on_mount(self) -> None:
        """Start in the line, else on ``start``, else on the first row."""
        if self.candidates:
            self._show_rows(self._start if self.entry is None else None)
        if self.entry is None:
            self._list.focus()

    def on_resize(self) -> None:
        """Refit list and foot."""
        height = self.app.size.height
        self.set_class(self.page is not None, "-page")
        self._fit()
        about = self.query_one("#about")
        about.display = self.has_about
        blank = int(height >= _BLANK_FROM and bool(self.candidates) and about.display)
        about.styles.margin = (blank, 0, 0, 0)
        foot = next((each for each in self._feet if cell_len(each) < self.room), self._feet[-1])
        self.query_one("#box").border_subtitle = self.glyphs.spelled(foot)
        if self.candidates:
            question = len(textwrap.wrap(self._question, self.room)) if self._question else 0
            taken = _BORDER + ABOUT_ROWS * about.display + blank + question + int(self.entry is not None)
            self._list.styles.max_height = max(_LEAST_ROWS, height * 9 // 10 - taken)
            self._show_rows(self.at)

    def set_rows(self, candidates: Iterable[Candidate], at: str | None = None) -> None:
        """Replace the rows. The cursor goes to ``at``, or stays."""
        self.candidates = tuple(candidates)
        if self.query(OptionList):
            self._show_rows(self.at if at is None else at)

    def _fit(self) -> None:
        """Make the box as wide as its longest line, if the screen is."""
        most = self._most - _FRAME
        self._columns = self._columns_in(most - MARKS)
        typed = () if self.entry is None else (as_sentence(self.entry.hint), f"   {self.entry.text}")
        lines = [f" {self._title} ", self._question, *typed, f" {self._feet[0]}"]
        for each in self.candidates:
            lines += [self._about(each, most), " " * MARKS + self._row(each, most - MARKS)]
        longest = max(cell_len(line) for text in lines for line in self._spelled(text).splitlines())
        self.room = max(MARKS + 1, min(most, max(self.least_room, longest)))
        self.query_one("#box").styles.max_width = min(self._most, self.room + _FRAME)

    @property
    def has_about(self) -> bool:
        """True if there are lines about some row."""
        return True

    @property
    def _most(self) -> int:
        width = self.app.size.width
        left = 0 if self.page is None else self.page.region.x - 1
        has_more = any(each.value or each.words or each.refused for each in self.candidates)
        is_beside = left >= _LEAST_BESIDE[has_more]
        return min(_MOST_COLUMNS, left if is_beside else width if self.page else width * 9 // 10)

    def describe(self, candidate: Candidate) -> Text:
        """Return the row: number, cursor, name, value and words."""
        if not candidate.id:
            return Text(self.glyphs.spelled(shortened(candidate.name, self.room, self.glyphs.ellipsis)))
        name, room = self._named(candidate), self.room - MARKS
        if self._columns:
            body = Text(shortened(self._row(candidate, room), room, self.glyphs.ellipsis))
        else:
            body = Text(f"\n{' ' * MARKS}".join(textwrap.wrap(name, room) or [""]))
        if candidate.refused:
            body.stylize("dim")
        else:
            body.stylize("bold", 0, cell_len(name))
        return Text.assemble(self.mark(candidate), body)

    def _row(self, candidate: Candidate, room: int) -> str:
        """Return name, value and words in their columns, and a reason if it fits ``room``."""
        cells = [self._named(candidate), self._spelled(candidate.value), self._spelled(candidate.words)]
        if candidate.refused:
            reason = self._spelled(f"{NOT_HERE}{candidate.refused}")
            is_whole = sum(self._columns[:1]) + _GAP + cell_len(reason) <= room
            cells[1:] = [reason if is_whole else _UNAVAILABLE]
        elif len(self._columns) <= 1 or not candidate.value:
            cells[1:] = [text for text in cells[1:] if text]
        for place, width in enumerate(self._columns[: len(cells) - 1]):
            cells[place] = set_cell_size(shortened(cells[place], width, self.glyphs.ellipsis), width)
        return (" " * _GAP).join(cells).rstrip()

    def mark(self, candidate: Candidate) -> tuple[str, str]:
        """Return the number, and the cursor or not."""
        cursor = self.glyphs.cursor if candidate.id == self.at else ""
        return f"{self._numbers.get(candidate.id, ''):<1} {cursor:<1} ", "not bold"

    def about(self, candidate: Candidate) -> str:
        """Return the lines about ``candidate`` that fit, the reason first."""
        return self._about(candidate, self.room)

    def _about(self, candidate: Candidate, room: int) -> str:
        refused = (f"Not here: {candidate.refused.rstrip('.')}.",) if candidate.refused else ()
        lines, rows = list[str](), 0
        for line in map(self._spelled, (*refused, *candidate.lines)):
            taken = len(textwrap.wrap(line, room + 1))
            if not lines or rows + taken <= ABOUT_ROWS:
                lines.append(line)
                rows += taken
        return "\n".join(lines)

    # Events

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Mark and describe the row."""
        for candidate in self.candidates:
            if candidate.id:
                self._list.replace_option_prompt(candidate.id, self.describe(candidate))
        if self._list.has_focus or self.entry is None:
            self._tell_of_row()

    def on_descendant_focus(self, event: events.DescendantFocus) -> None:
        """Describe the widget in focus."""
        if isinstance(event.widget, OptionList):
            if self._list.highlighted is None:
                self._list.action_first()
            self._tell_of_row()
        else:
            self._tell_of_text()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Show errors while typing."""
        if self.entry is not None and event.value != self.typed:
            self.typed = event.value
            self._tell_of_text()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Answer the value if it is valid."""
        self.typed = event.value
        self._tell_of_text(is_submitted=True)
        if self.entry is not None and not self.entry.fault(event.value):
            self.dismiss(self.entry.read(event.value))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Choose the row, unless it is refused."""
        candidate = next(each for each in self.candidates if each.id == event.option_id)
        if candidate.refused:
            self.app.bell()
        else:
            self.choose(candidate.id)

    def choose(self, id: str) -> None:  # noqa: A002
        """Answer the row."""
        self.dismiss(id if self.entry is None else self.entry.read(id))

    def action_to_list(self) -> None:
        """Go from the line to the list."""
        if self.candidates:
            self._list.focus()

    def action_take(self, number: int) -> None:
        """Choose the row with this ``number``."""
        for id, written in self._numbers.items():  # noqa: A001
            if written == str(number):
                self._list.highlighted = self._list.get_option_index(id)
                self._list.action_select()

    # Parts

    @property
    def _list(self) -> OptionList:
        return self.query_one(OptionList)

    @property
    def at(self) -> str | None:
        """The row under the cursor."""
        option = self._list.highlighted_option
        return None if option is None else option.id

    @property
    def _numbers(self) -> dict[str, str]:
        if self.entry is not None:  # digits belong to its line
            return {}
        ids = [each.id for each in self.candidates if each.id]
        return {id: str(number) for number, id in enumerate(ids[:9], 1)}  # noqa: A001

    def _columns_in(self, room: int) -> tuple[int, ...]:
        """Return the cells of names and of values, if any rows have more than a name."""
        rows = [each for each in self.candidates if each.id and (each.value or each.words or each.refused)]
        if not rows:
            return ()
        names = min(room // 2, max(cell_len(self._named(each)) for each in rows))
        values = max(cell_len(self._spelled(each.value)) for each in rows)
        most = room // 3 if any(each.words for each in rows) else room - names - _GAP
        return (names, min(most, values)) if values else (names,)

    @property
    def _feet(self) -> tuple[str, ...]:
        """The keys below, widest form first."""
        parts = [part for part in (self._keys, f"enter: {self._does}", _CLOSE) if part]
        whole = [_MOVE, *parts] if self.candidates else parts
        if self._numbers:
            whole[-2] = f"a number or {whole[-2]}"
        return _WIDE.join(whole), _WIDE.join(parts), "  ".join(parts)

    def _named(self, candidate: Candidate) -> str:
        return self._spelled(f"{candidate.name}{CURRENT if candidate.id == self.current else ''}")

    def _spelled(self, text: str) -> str:
        return self.glyphs.spelled(text)

    def _show_rows(self, at: str | None) -> None:
        self._fit()
        options: Sequence[Option] = [
            Option(self.describe(each), id=each.id or None, disabled=not each.id) for each in self.candidates
        ]
        self._list.set_options(options)
        ids = [each.id for each in self.candidates]
        if at is not None or self.entry is None:
            first = next(place for place, id in enumerate(ids) if id)  # noqa: A001
            self._list.highlighted = ids.index(at) if at and at in ids else first

    def _tell_of_text(self, *, is_submitted: bool = False) -> None:
        if self.entry is not None:
            fault = self.entry.fault(self.typed) if self.typed or is_submitted else ""
            self.tell_about(fault or as_sentence(self.entry.hint), is_fault=bool(fault))

    def _tell_of_row(self) -> None:
        for candidate in self.candidates:
            if candidate.id == self.at:
                self.tell_about(self.about(candidate))

    def tell_about(self, text: str, *, is_fault: bool = False) -> None:
        """Show ``text`` in the three lines."""
        about = self.query_one("#about", Static)
        about.set_class(is_fault, "error")
        about.set_class(not is_fault, "hint")
        about.update(self.glyphs.spelled(text))


class Choice(Form):
    """A list. The answer is a row's id."""

    @property
    def has_about(self) -> bool:
        """True if there are lines about some row."""
        return any(each.lines or each.refused for each in self.candidates)


class Prompt(Form):
    """A line. The answer is what ``read`` returns."""

    def __init__(self, title: str, hint: str, value: str, read: Reader, does: str = "set") -> None:
        super().__init__(title, (), "", UNICODE, entry=TypedLine(value, hint, read), does=does)
        self.read = read
