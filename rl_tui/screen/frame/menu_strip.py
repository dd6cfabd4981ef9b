"""A menu over the last rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from textwrap import wrap
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment
from textual import events
from textual.app import ComposeResult
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.keys.action import Action
from rl_tui.screen.theme.look import Look

_WIDE: Final = 110  # columns from which a line holds three entries, else two
_BEFORE_LABEL: Final = 5  # columns of the cursor, the letter and the blanks around them
_MOVES: Final = {"down": 1, "j": 1, "tab": 1, "up": -1, "k": -1, "shift+tab": -1}
LEADING_ON: Final = {"question_mark": "help", "slash": "find"}
"""Keys that close a menu, with the action to run."""


class MenuRows(Widget):
    """Title, entries with values, and the sentence of entry ``at``."""

    at: reactive[int] = reactive(0)
    unknown: reactive[str] = reactive("")

    def __init__(self, look: Look, title: str, rows: Sequence[Action]) -> None:
        super().__init__()
        self.look = look
        self.title = title
        self.rows = rows

    @property
    def lines(self) -> int:
        """The lines of entries, which fill columns."""
        return -(-len(self.rows) // self._columns)

    @property
    def _columns(self) -> int:
        return 3 if self.app.size.width >= _WIDE else 2

    def on_resize(self) -> None:
        """Refit the height."""
        self._fit()

    def show(self, rows: Sequence[Action]) -> None:
        """Replace the rows."""
        self.rows = rows
        self.at = min(self.at, len(rows) - 1)
        self._fit()
        self.refresh()

    def _fit(self) -> None:
        width = max(1, self.size.width - 2)
        most = max(len(wrap(row.sentence, width)) for row in self.rows)
        self.styles.height = 1 + self.lines + most

    def render_line(self, y: int) -> Strip:
        """Draw title, entries, or sentence."""
        width, text = self.size.width, self.look.palette.text
        if y == 0:
            segments = self._title(width)
        elif y <= self.lines:
            places = range(y - 1, len(self.rows), self.lines)
            segments = [segment for place in places for segment in self._row(place)]
        else:
            said = wrap(self._said, max(1, width - 2))[y - self.lines - 1 :]
            segments = [Segment(f" {self.look.glyphs.spelled(said[0])}" if said else "", text)]
        return Strip(segments).adjust_cell_length(width, text).apply_style(self.rich_style)

    @property
    def _said(self) -> str:
        return f"{self.unknown}: no row here." if self.unknown else self.rows[self.at].sentence

    def _title(self, width: int) -> list[Segment]:
        palette, line = self.look.palette, self.look.glyphs.axis_horizontal
        title, close = f" {self.title} ", " esc "
        rest = width - 4 - cell_len(title) - cell_len(close)
        return [
            Segment(line * 2, palette.rule),
            Segment(title, palette.strong),
            Segment(line * rest, palette.rule),
            Segment(close, palette.dim),
            Segment(line * 2, palette.rule),
        ]

    def _row(self, place: int) -> list[Segment]:
        row, palette, glyphs = self.rows[place], self.look.palette, self.look.glyphs
        is_here = place == self.at
        width = self.size.width // self._columns - _BEFORE_LABEL
        labels = max(cell_len(glyphs.spelled(each.label)) for each in self.rows) + 2
        text = f"{glyphs.spelled(row.label):<{labels}}{glyphs.spelled(row.value)}"
        style = palette.dim if row.refused else palette.strong if is_here else palette.text
        return [
            Segment(f" {glyphs.cursor if is_here else ' '} ", palette.press),
            Segment(f"{row.letter} ", palette.dim if row.refused else palette.press),
            Segment(shortened(text, width - 1, glyphs.ellipsis).ljust(width), style),
        ]

    def place_at(self, x: int, y: int) -> int | None:
        """Return the entry's index here."""
        place = y - 1 + self.lines * (x // (self.size.width // self._columns))
        return place if 1 <= y <= self.lines and place < len(self.rows) else None


class MenuStrip(Dialog[str]):
    """A menu that answers an action's id, and stays open for unavailable ones."""

    def __init__(self, look: Look, title: str, rows: Callable[[], Sequence[Action]]) -> None:
        super().__init__()
        self._rows_now = rows
        self.menu = MenuRows(look, title, rows())

    def compose(self) -> ComposeResult:
        """Yield the entries."""
        yield self.menu

    def show(self, snapshot: Snapshot) -> None:
        """Update values and available actions."""
        rows = self._rows_now()
        if rows != self.menu.rows:
            self.menu.show(rows)

    def on_key(self, event: events.Key) -> None:
        """Choose an entry, or move the cursor."""
        menu, key = self.menu, event.key
        event.stop()
        menu.unknown = ""
        letters = [row.letter for row in menu.rows]
        letter = event.character or key
        if letter in letters:
            self._choose(letters.index(letter))
        elif key in ("escape", "q"):
            self.action_cancel()
        elif key == "enter":
            self._choose(menu.at)
        elif key in _MOVES:
            menu.at = (menu.at + _MOVES[key]) % len(menu.rows)
        elif key in ("left", "right"):
            beside = menu.at + (menu.lines if key == "right" else -menu.lines)
            menu.at = beside if 0 <= beside < len(menu.rows) else menu.at
        elif key in ("home", "end"):
            menu.at = 0 if key == "home" else len(menu.rows) - 1
        elif key in LEADING_ON:
            self.dismiss(LEADING_ON[key])
        else:
            menu.unknown = letter if letter.isprintable() else key

    def on_click(self, event: events.Click) -> None:
        """Choose an entry, or close the menu."""
        region = self.menu.region
        place = None
        if region.contains(event.screen_x, event.screen_y):
            place = self.menu.place_at(event.screen_x - region.x, event.screen_y - region.y)
        if place is None:
            self.action_cancel()
        else:
            self._choose(place)

    def _choose(self, place: int) -> None:
        self.menu.at = place
        row = self.menu.rows[place]
        if not row.refused:
            self.dismiss(row.id)
