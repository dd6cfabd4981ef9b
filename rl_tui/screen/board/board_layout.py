"""The arrangement as a Textual layout, and a lesson's place in it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from textual.geometry import NULL_OFFSET, NULL_SPACING, Region, Size
from textual.layout import ArrangeResult, Layout, WidgetPlacement
from textual.widget import Widget

from rl_tui.lessons.file.view import LessonView
from rl_tui.screen.frame.arrange import arrange
from rl_tui.screen.frame.shape import WORLDS, Arrangement, Shape, docks_lesson
from rl_tui.screen.kit.row import DISCOUNT, LESSON
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.lesson.lesson import LessonPanel, Spotlight
from rl_tui.screen.panels.lesson.words import open_page
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView

if TYPE_CHECKING:
    from rl_tui.screen.board.board import Board

_SENTENCE_ROWS: Final = 4  # of a panel with one sentence, between heading and keys


class BoardLayout(Layout):
    """Gives each panel its region."""

    name = "board"

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.zoomed: str | None = None
        self.opened: str | None = None
        self.placed: frozenset[str] = frozenset()
        self._wide_rows = {row.id: row.wide_rows for row in PANELS}

    @property
    def is_big(self) -> bool:
        """True if a world is in full screen."""
        return self.zoomed in WORLDS

    def in_view(self, size: Size) -> frozenset[str] | None:
        """Return the panels in view, or None for all.

        All are in view with two runs, during editing, and beside an opened panel without space for a page.
        """
        is_opened = self.opened is not None and not docks_lesson(size, None)
        return None if is_opened or self.shape.lanes or self.shape.is_drawn else self.shape.shown

    def has_lesson_in_a_row(self, size: Size) -> bool:
        """Return whether a lesson has one row."""
        shape = self.shape
        is_page = shape.reads or docks_lesson(size, self.in_view(size)) or self.zoomed == LESSON
        return shape.has_lesson and (self.is_big or not is_page)

    def has_place(self, panel: str, size: Size) -> bool:
        """Return whether ``panel`` fits beside the lesson."""
        return panel in self._place(size, replace(self.shape, reads=False), self.zoomed).regions

    def regions(self, size: Size, zoomed: str | None) -> dict[str, Region]:
        """Return the regions in view, or of ``zoomed``."""
        place = self._place(size, self.shape, zoomed)
        above = int(place.has_header)
        return {panel: region.translate((0, -above)) for panel, region in place.regions.items()}

    def has_header(self, size: Size) -> bool:
        """Return whether the first row is free for the header."""
        return self._place(size, self.shape, self.zoomed).has_header

    def _place(self, size: Size, shape: Shape, zoomed: str | None) -> Arrangement:
        wide_rows = 0 if self.opened is None else self._wide_rows[self.opened]
        if self.opened == DISCOUNT and shape.hides_exact:
            wide_rows = _SENTENCE_ROWS
        shape = replace(shape, shown=self.in_view(size))
        return arrange(size, shape, self.opened, zoomed=zoomed, wide_rows=wide_rows)

    def arrange(
        self, parent: Widget, children: list[Widget], size: Size, greedy: bool = True
    ) -> ArrangeResult:
        """Return the places, and set the cells of worlds and tables."""
        screen = parent.screen.size
        regions, cell = self.regions(screen, self.zoomed), self._place(screen, self.shape, self.zoomed).cell
        self.placed = frozenset(regions)
        for child in children:
            if isinstance(child, WorldView | QTable) and child.cell != cell:
                child.cell = cell
                child.call_later(child.redraw)
        return [
            WidgetPlacement(regions[child.id], NULL_OFFSET, NULL_SPACING, child)
            for child in children
            if child.id in regions
        ]


class LessonPlace:
    """The lesson, next to the world or in turn."""

    def __init__(self, board: Board, panel: LessonPanel, arrangement: BoardLayout) -> None:
        self.panel = panel
        self._board = board
        self._arrangement = arrangement
        self._focused_before: Widget | None = None
        self._spotlit: str | None = None

    @property
    def is_docked(self) -> bool:
        """True if the page is beside the world."""
        size, layout = self._board.screen.size, self._arrangement
        return not layout.is_big and docks_lesson(size, layout.in_view(size))

    @property
    def is_in_view(self) -> bool:
        """True if the whole page is in view."""
        size, layout = self._board.screen.size, self._arrangement
        return not layout.has_lesson_in_a_row(size) and LESSON in layout.regions(size, layout.zoomed)

    @property
    def reads(self) -> bool:
        """True if the page replaces the world for lack of space."""
        return self._arrangement.shape.reads and not self._arrangement.is_big

    @reads.setter
    def reads(self, reads: bool) -> None:
        if reads == self.reads:
            return
        if self._arrangement.is_big:
            self._board.zoom(None)
        self._board.reshape(reads=reads)
        self._board.post_message(self._board.Toggled())
        if not self.is_docked:
            (self.focus if reads else self.leave)()

    def focus(self) -> None:
        """Focus the page."""
        if self._board.screen.focused is not self.panel:
            self._focused_before = self._board.screen.focused
            self.panel.focus()

    def leave(self) -> None:
        """Return the focus."""
        if self._board.screen.focused is self.panel:
            before, self._focused_before = self._focused_before, None
            self._board.screen.set_focus(before if before is not None and before.is_attached else None)

    def place(self, lesson: LessonView, size: Size) -> None:
        """Tell the panels how page and world share the board, before the page is drawn."""
        self.panel.set_class(self._arrangement.has_lesson_in_a_row(size), "-row")
        self.panel.takes_turns = self.reads and not self.is_docked
        if self.panel.takes_turns:
            self.focus()
        self._point_at(open_page(lesson.record).spotlight, size)

    def _point_at(self, wanted: str | None, size: Size) -> None:
        row = None if wanted is None else self._board.rows.get(wanted)
        spotlit = None if row is None else row.id
        for panel, is_spotlit in ((self._spotlit, False), (spotlit, True)):
            if panel is not None and spotlit != self._spotlit:
                widget = self._board.panel(panel)
                widget.is_spotlit = is_spotlit
                widget.set_class(is_spotlit, "-spotlit")
                widget.redraw()
        self._spotlit = spotlit
        self.panel.spotlight = None
        if row is not None:
            key = "" if row.opened_by is None else row.opened_by.key
            if self.reads and self._arrangement.has_place(row.id, size):
                key = "esc"
            is_seen = row.id in self._arrangement.regions(size, self._arrangement.zoomed)
            self.panel.spotlight = Spotlight(row.title, is_seen, key)
