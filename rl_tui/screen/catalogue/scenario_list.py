"""Lists of one-line rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import ClassVar, Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text
from textual.binding import BindingType
from textual.containers import Horizontal
from textual.widgets import Static
from textual.widgets.option_list import Option
from textual.worker import WorkerCancelled

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.live.sessions.session import StoredSession
from rl_tui.screen.catalogue.facts import FullWidth
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.frame.action_screen import ActionScreen
from rl_tui.screen.frame.message_line import complain
from rl_tui.screen.kit.bindings import ListInput, RowList, binding
from rl_tui.screen.terminal.linked_app import LinkedApp, is_open
from rl_tui.screen.theme.glyphs import ASCII
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms, Graph, Grid
from rl_tui.worlds.files.catalogue import YOURS, Catalogue, group_of
from rl_tui.worlds.files.scenario import Scenario

# Rows


_LONGEST_NAME: Final = 255
_MARK: Final = 3  # columns before a title: a blank, the mark, a blank


class ListRow(FullWidth):
    """``mark``, ``title`` (shortened if needed), and ``size`` if it fits beside the whole title."""

    def __init__(self, mark: str, title: str, size: str, look: Look) -> None:
        self._mark, self._title, self._size = mark, look.glyphs.spelled(title), look.glyphs.spelled(size)
        self._look = look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        width, size = options.max_width, self._size
        room = max(1, width - _MARK - cell_len(size) - 1)
        if cell_len(self._title) > room:  # a whole name says more
            room, size = max(1, width - _MARK), ""
        title = shortened(self._title, room, self._look.glyphs.ellipsis)
        gap = " " * (width - _MARK - cell_len(title) - cell_len(size))
        # no colours here: the list has its own for the row under its cursor
        yield Text(f" {self._mark or ' '} {title}{gap}{size}", no_wrap=True)


def faulty_row(error: ScenarioError, look: Look) -> ListRow:
    """Return the row of a file with errors."""
    name = one_line(error.faults[0].file.rsplit("/", 1)[-1], _LONGEST_NAME)
    return ListRow("!", name, counted(len(error.faults), "error"), look)


class Heading(FullWidth):
    """A title, then a rule, which may end with a column's ``head``."""

    def __init__(self, title: str, look: Look, head: str = "") -> None:
        self._title, self._look = look.glyphs.spelled(title), look
        self._end = f" {head}" if head else ""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        taken = cell_len(self._title) + 1 + cell_len(self._end)
        rule = self._look.glyphs.axis_horizontal * (options.max_width - taken)
        yield Text.assemble((self._title, "bold"), f" {rule}{self._end}", no_wrap=True)


# Progress in a world


class Mark(IntEnum):
    """A person's progress, by the saved sessions."""

    NEW = 0
    OPENED = 1
    RUN_ON = 2
    OPTIMAL = 3


MEANINGS: Final = ("opened", "run", "optimal policy found")
"""The meanings of the marks after ``NEW``."""


def marks_of(sessions: Iterable[StoredSession]) -> dict[str, Mark]:
    """Return marks by scenario, without lesson sessions."""
    marks = dict[str, Mark]()
    for session in sessions:
        document = session.document
        if document.lesson is None:
            has_run = document.table is None or document.table.episodes > 0
            mark = Mark.RUN_ON if has_run else Mark.OPENED
            marks[document.scenario.id] = max(mark, marks.get(document.scenario.id, Mark.NEW))
    return marks


def size_of(scenario: Scenario) -> str:
    """Return a world's size, if in its file."""
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
    """A lesson or word that the filter found."""

    group: str
    id: str
    title: str


Entry = Scenario | ScenarioError | Hit


class ScenarioList(RowList):
    """The scenarios, with faulty files last."""

    def __init__(self, look: Look, catalogue: Catalogue) -> None:
        super().__init__(id="scenarios", classes="panel")
        self._look = look
        self._catalogue = catalogue
        self._marks: Mapping[str, Mark] = {}
        self._entries: list[Entry | None] = []
        self.show()

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, if any."""
        return None if self.highlighted is None else self._entries[self.highlighted]

    def start_at(self, scenario: str) -> None:
        """Put the cursor on a scenario, else the first."""
        ids = [option.id for option in self.options]
        first = next((number for number, option in enumerate(self.options) if not option.disabled), None)
        self.highlighted = ids.index(scenario) if scenario in ids else first

    def show(self, words: str = "", hits: Sequence[Hit] = ()) -> int:
        """List matches of ``words`` and ``hits``, returning their number."""
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
        """Show the progress in the listed scenarios."""
        self._marks = marks
        for entry in self._entries:
            if isinstance(entry, Scenario):
                self.replace_option_prompt(entry.id, self._row(entry))

    def action_cursor_up(self) -> None:
        """Move up, from the first row to the doors."""
        if self.highlighted is not None and any(
            not each.disabled for each in self.options[: self.highlighted]
        ):
            super().action_cursor_up()
        elif self.has_focus:
            self.screen.focus_previous()

    def _rows(self, words: str, hits: Sequence[Hit]) -> Iterator[tuple[Option, Entry | None]]:
        group = head = ""
        for scenario in self._catalogue.scenarios:
            own = group_of(scenario)
            if not has_words(f"{scenario.title} {scenario.id} {own} {scenario.summary}", words):
                continue
            if own != group:
                counted_by = "arms" if isinstance(scenario.section.sketch(), Arms) else "size"
                yield self._heading(own, counted_by if counted_by != head else ""), None
                group, head = own, counted_by
            yield Option(self._row(scenario), id=scenario.id), scenario
        broken = [] if words else self._catalogue.broken
        if broken and group != YOURS:
            yield self._heading(YOURS), None
        for number, error in enumerate(broken):
            yield Option(faulty_row(error, self._look), id=f"/faulty/{number}"), error
        for hit in hits:
            if hit.group != group:
                group = hit.group
                yield self._heading(group), None
            yield Option(ListRow("", hit.title, "", self._look), id=f"/{hit.group}/{hit.id}"), hit

    def _row(self, scenario: Scenario) -> ListRow:
        mark = self._marks.get(scenario.id, Mark.NEW)
        sign = "" if mark is Mark.NEW else self._look.glyphs.progress[mark - 1]
        return ListRow(sign, scenario.title, size_of(scenario), self._look)

    def _heading(self, group: str, head: str = "") -> Option:
        return Option(Heading(group, self._look, head), disabled=True)


def has_words(text: str, words: str) -> bool:
    """Return whether ``words`` occur, in any spelling (8x8 for 8×8)."""
    spelled = ASCII.spelled(text).casefold()
    return all(word in spelled for word in ASCII.spelled(words).casefold().split())


# The filter


_LONGEST_FILTER: Final = 40


class FilterInput(ListInput):
    """The words that filter a list."""

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("escape", "screen.show_all", "filter.all", "Show all rows again."),
    ]


class Filter(Horizontal):
    """A filter's words and number of matches."""

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
        self.query_one("#filter-found", Static).update(self._look.glyphs.separated(found))


class ListScreen(ActionScreen):
    """A screen whose rows are read after the first paint. ``sessions``: their folder."""

    def __init__(self, look: Look, start_at: str, fault: UserError | None, sessions: Path | None) -> None:
        super().__init__(look)
        self._start_at = start_at
        self._fault = fault
        self._sessions = sessions

    def first_row(self, text: str) -> Static:
        """Return the first row."""
        return Static(f" rl-tui  {text}{'  kiosk' if self.in_kiosk else ''}", id="title")

    def on_mount(self) -> None:
        """Show an error, and start slow work after the first paint."""
        if self._fault is not None:
            complain(self.app, self._fault)
        self.run_worker(self._begin_when_painted, name="begin", group="begin")  # type: ignore[arg-type]

    async def _begin_when_painted(self) -> None:
        if isinstance(self.app, LinkedApp):
            await self.app.painted()
        self.begin()

    def begin(self) -> None:
        """Start slow work."""
        raise NotImplementedError

    def on_option_list_option_highlighted(self) -> None:
        """Show the row's details."""
        self.show_current()

    def show_current(self) -> None:
        """Show the row's details."""
        raise NotImplementedError

    def deliver(self, take: Callable[..., None], *results: object) -> None:
        """Call ``take`` with the results of a thread, unless the screen is closed by then."""

        def take_if_open() -> None:
            if is_open(self):
                take(*results)

        self.call_later(take_if_open)

    async def finished(self, group: str) -> None:
        """Wait for the workers of ``group``."""
        while under_way := [each for each in self.workers if each.group == group and not each.is_finished]:
            with suppress(WorkerCancelled):
                await self.workers.wait_for_complete(under_way)
