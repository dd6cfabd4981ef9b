"""The lessons in their order, each with how far one has come; files that are faulty stand at the end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.text import Text
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from rl_tui.common.errors import ScenarioError
from rl_tui.common.findings import one_line
from rl_tui.lab.course.entries import LessonEntry
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.screens.lessons.lesson_text import state_of
from rl_tui.tui.theme.look import Look

_LONGEST_NAME: Final = 255

Entry = LessonEntry | ScenarioError


class LessonList(OptionList):
    """A list of lessons, of which ``current`` is under the cursor."""

    def __init__(self, look: Look) -> None:
        super().__init__(id="lessons", classes="panel")
        self._look = look
        self.border_title = "Lessons"
        self._entries: Sequence[Entry] = ()

    def show(self, entries: Sequence[Entry], start_at: str) -> None:
        """List ``entries``, with the cursor on the lesson of the id ``start_at``, else on the first."""
        self._entries = entries
        self.clear_options()
        self.add_options(self._rows())
        ids = [each.lesson.id if isinstance(each, LessonEntry) else "" for each in entries]
        if entries:
            self.highlighted = ids.index(start_at) if start_at in ids else 0

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, None where there is no cursor."""
        return None if self.highlighted is None else self._entries[self.highlighted]

    def _rows(self) -> Iterator[Option]:
        digits = len(str(len(self._entries)))
        for number, entry in enumerate(self._entries, start=1):
            if isinstance(entry, LessonEntry):
                title = to_ascii(entry.lesson.title, self._look.glyphs)
                minutes = "" if entry.is_at_end else f" · {entry.lesson.minutes} min"
                state = separated(f"{state_of(entry)}{minutes}", self._look.glyphs)
                yield Option(_Row(f"{number:>{digits}}", title, state, self._look))
            else:
                name = one_line(entry.faults[0].file.rsplit("/", 1)[-1], _LONGEST_NAME)
                yield Option(_Row(" " * digits, to_ascii(name, self._look.glyphs), "faulty", self._look))


class _Row:
    """Two lines: ``number`` and ``title``, and below the ``state``. Neither is broken."""

    def __init__(self, number: str, title: str, state: str, look: Look) -> None:
        self._number = number
        self._title = title
        self._state = state
        self._look = look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width, ellipsis = options.max_width, self._look.glyphs.ellipsis
        yield Text(shortened(f"{self._number} {self._title}", width, ellipsis), no_wrap=True)
        indent = " " * (cell_len(self._number) + 1)
        yield Text(shortened(f"{indent}{self._state}", width, ellipsis), no_wrap=True)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(1, options.max_width)
