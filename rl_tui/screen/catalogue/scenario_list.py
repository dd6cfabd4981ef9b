"""Lists of one-line rows, and the list of scenarios."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar, Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text
from textual.binding import BindingType
from textual.containers import Horizontal
from textual.widgets import Static
from textual.widgets.option_list import Option

from rl_tui.common.errors import ScenarioError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import StoredSession
from rl_tui.screen.catalogue.facts import FullWidth
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.kit.bindings import ListInput, RowList, binding
from rl_tui.screen.theme.glyphs import ASCII
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.files.catalogue import YOURS, Catalogue, group_of
from rl_tui.worlds.files.scenario import Scenario

# Rows


FAULTY: Final = "!"
_LONGEST_NAME: Final = 255
_MARK: Final = 3  # columns before a title: a blank, the mark, a blank


class ListRow(FullWidth):
    """One line: ``mark``, ``title`` and ``size``, of which only the title is shortened."""

    def __init__(self, mark: str, title: str, size: str, look: Look) -> None:
        self._mark, self._title, self._size = mark, to_ascii(title, look.glyphs), to_ascii(size, look.glyphs)
        self._look = look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width, size = options.max_width, self._size
        room = max(1, width - _MARK - cell_len(size) - 1)
        title = shortened(self._title, room, self._look.glyphs.ellipsis)
        gap = " " * max(1, width - _MARK - cell_len(title) - cell_len(size))
        # no colours here: the list has its own for the row under its cursor
        yield Text(f" {self._mark or ' '} {title}{gap}{size}", no_wrap=True)


class Heading(FullWidth):
    """One line: a title, then a rule."""

    def __init__(self, title: str, look: Look) -> None:
        self._title, self._look = to_ascii(title, look.glyphs), look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        rule = self._look.glyphs.axis_horizontal * (options.max_width - cell_len(self._title) - 1)
        yield Text.assemble((self._title, "bold"), f" {rule}", no_wrap=True)


# Progress in a world


class Mark(IntEnum):
    """A person's progress in a scenario, according to the saved sessions."""

    NEW = 0
    OPENED = 1
    RUN_ON = 2
    OPTIMAL = 3


def marks_of(sessions: Iterable[StoredSession]) -> dict[str, Mark]:
    """Return marks by scenario id, without the sessions of lessons."""
    marks = dict[str, Mark]()
    for session in sessions:
        document = session.document
        if document.lesson is None:
            has_run = document.table is None or document.table.episodes > 0
            mark = Mark.RUN_ON if has_run else Mark.OPENED
            marks[document.scenario.id] = max(mark, marks.get(document.scenario.id, Mark.NEW))
    return marks


def size_of(scenario: Scenario) -> str:
    """Return the size of a world as far as its file gives it."""
    match scenario.section.sketch():
        case Grid(rows=rows, columns=columns, axes=axes, body=body) if axes is None or body is not None:
            return f"{rows}×{columns}"
        case Graph(places=places):
            return str(len(places))
        case Arms(count=count):
            return str(count)
    return "—"


# The list of scenarios


@dataclass(frozen=True, slots=True)
class Hit:
    """A lesson or a word that the filter has found."""

    group: str
    id: str
    title: str


Entry = Scenario | ScenarioError | Hit


class ScenarioList(RowList):
    """The list of ``catalogue``, with faulty files last."""

    def __init__(self, look: Look, catalogue: Catalogue) -> None:
        super().__init__(id="scenarios", classes="panel")
        self._look = look
        self._catalogue = catalogue
        self._marks: Mapping[str, Mark] = {}
        self._entries: list[Entry | None] = []
        self.show()

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, None without a cursor."""
        return None if self.highlighted is None else self._entries[self.highlighted]

    def start_at(self, scenario: str) -> None:
        """Put the cursor on the id ``scenario``, else on the first row."""
        ids = [option.id for option in self.options]
        first = next((number for number, option in enumerate(self.options) if not option.disabled), None)
        self.highlighted = ids.index(scenario) if scenario in ids else first

    def show(self, words: str = "", hits: Sequence[Hit] = ()) -> int:
        """List the scenarios with all of ``words``, then ``hits``. Return their number."""
        here = self.highlighted_option
        rows = list(self._rows(words, hits))
        self._entries = [entry for _, entry in rows]
        self.clear_options()
        self.add_options(option for option, _ in rows)
        worlds = [each for each in self._entries if words and isinstance(each, Scenario)]
        titled = (each.id for each in worlds if has_words(each.title, words))
        self.start_at(next(titled, "" if here is None or here.id is None else here.id))
        return sum(isinstance(entry, Scenario) for entry in self._entries)

    def show_marks(self, marks: Mapping[str, Mark]) -> None:
        """Show the progress in the rows of listed scenarios."""
        self._marks = marks
        for entry in self._entries:
            if isinstance(entry, Scenario):
                self.replace_option_prompt(entry.id, self._row(entry))

    def action_cursor_up(self) -> None:
        """Move to the row before, or from the first one to the doors."""
        if self.highlighted is not None and any(
            not each.disabled for each in self.options[: self.highlighted]
        ):
            super().action_cursor_up()
        elif self.has_focus:
            self.screen.focus_previous()

    def _rows(self, words: str, hits: Sequence[Hit]) -> Iterator[tuple[Option, Entry | None]]:
        group = ""
        for scenario in self._catalogue.scenarios:
            own = group_of(scenario)
            if not has_words(f"{scenario.title} {scenario.id} {own} {scenario.summary}", words):
                continue
            if own != group:
                group = own
                yield self._heading(group), None
            yield Option(self._row(scenario), id=scenario.id), scenario
        broken = [] if words else self._catalogue.broken
        if broken and group != YOURS:
            yield self._heading(YOURS), None
        for number, error in enumerate(broken):
            name = one_line(error.faults[0].file.rsplit("/", 1)[-1], _LONGEST_NAME)
            errors = counted(len(error.faults), "error")
            yield Option(ListRow(FAULTY, name, errors, self._look), id=f"/faulty/{number}"), error
        for hit in hits:
            if hit.group != group:
                group = hit.group
                yield self._heading(group), None
            yield Option(ListRow("", hit.title, "", self._look), id=f"/{hit.group}/{hit.id}"), hit

    def _row(self, scenario: Scenario) -> ListRow:
        mark = self._marks.get(scenario.id, Mark.NEW)
        sign = "" if mark is Mark.NEW else self._look.glyphs.progress[mark - 1]
        return ListRow(sign, scenario.title, size_of(scenario), self._look)

    def _heading(self, group: str) -> Option:
        return Option(Heading(group, self._look), disabled=True)


def has_words(text: str, words: str) -> bool:
    """Return True if all of ``words`` occur in ``text``, in any spelling (8x8 for 8×8)."""
    spelled = to_ascii(text, ASCII).casefold()
    return all(word in spelled for word in to_ascii(words, ASCII).casefold().split())


# The filter


_LONGEST_FILTER: Final = 40


class FilterInput(ListInput):
    """A line for the words that filter a list."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("escape", "screen.show_all", "filter.all", "Show all rows again."),
    ]


class Filter(Horizontal):
    """The line of a filter: its words and the number of matches."""

    def __init__(self, look: Look) -> None:
        line = FilterInput(id="filter-words", max_length=_LONGEST_FILTER, compact=True)
        super().__init__(Static("/", id="filter-sign"), line, Static(id="filter-found"), id="filter")
        self._look = look
        self.display = False

    @property
    def line(self) -> FilterInput:
        """The line for the words."""
        return self.query_one(FilterInput)

    def open(self) -> None:
        """Show the filter and focus its line."""
        self.display = True
        self.line.focus()

    def close(self) -> None:
        """Clear and hide the filter."""
        self.line.value = ""
        self.display = False

    def tell(self, found: str) -> None:
        """Show what was found."""
        self.query_one("#filter-found", Static).update(separated(found, self._look.glyphs))
