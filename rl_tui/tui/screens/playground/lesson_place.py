"""Where the page of a lesson stands on the board, and which panel it points at."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from textual.geometry import Size
from textual.widget import Widget

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.lesson.lesson import LessonPanel
from rl_tui.tui.panels.lesson.page_lines import Spotlight
from rl_tui.tui.panels.lesson.stage import open_page
from rl_tui.tui.screens.playground.arrangement import docks_lesson
from rl_tui.tui.screens.playground.board_layout import BoardLayout

if TYPE_CHECKING:
    from rl_tui.tui.screens.playground.board import Board

IN_A_ROW: Final = "-row"
SPOTLIT: Final = "-spotlit"


class LessonPlace:
    """The ``panel`` of the lesson on the ``board``: beside the world, or in turn with it.

    ``arrangement`` is that of the board.
    """

    def __init__(self, board: Board, panel: LessonPanel, arrangement: BoardLayout) -> None:
        self.panel = panel
        self._board = board
        self._arrangement = arrangement
        self._focused_before: Widget | None = None
        self._spotlit: str | None = None

    @property
    def is_docked(self) -> bool:
        """Whether there is room for the page beside the world."""
        return docks_lesson(self._board.size)

    @property
    def reads(self) -> bool:
        """Whether the page has the place of the world, or would have it where there is no room for both."""
        return self._arrangement.shape.reads

    @reads.setter
    def reads(self, reads: bool) -> None:
        if reads == self.reads:
            return
        self._board.reshape(reads=reads)
        self._board.post_message(self._board.Toggled())
        if reads and not self.is_docked:
            self.focus()
        elif not reads and not self.is_docked:
            self.leave()

    def focus(self) -> None:
        """Give the page the focus."""
        focused = self._board.screen.focused
        if focused is not self.panel:
            self._focused_before = focused
            self.panel.focus()

    def leave(self) -> None:
        """Give the focus back to where it was before the page had it."""
        if self._board.screen.focused is self.panel:
            before, self._focused_before = self._focused_before, None
            self._board.screen.set_focus(before if before is not None and before.is_attached else None)

    def place(self, snapshot: Snapshot, size: Size) -> None:
        """Let the panels know, before they draw ``snapshot``, how page and world share the board."""
        if snapshot.lesson is None:
            return
        self.panel.set_class(self._arrangement.has_lesson_in_a_row(size), IN_A_ROW)
        self.panel.takes_turns = self.reads and not self.is_docked
        if self.panel.takes_turns:
            self.focus()
        self._point_at(open_page(snapshot.lesson.record).spotlight, size)

    def _point_at(self, wanted: str | None, size: Size) -> None:
        row = None if wanted is None else self._board.rows.get(wanted)
        spotlit = None if row is None else row.id
        for panel, is_spotlit in ((self._spotlit, False), (spotlit, True)):
            if panel is not None:
                widget = self._board.panel(panel)
                widget.is_spotlit = is_spotlit
                widget.set_class(is_spotlit, SPOTLIT)
        self._spotlit = spotlit
        self.panel.spotlight = (
            None
            if row is None
            else Spotlight(
                row.title,
                self._arrangement.has_place(row.id, size),
                "" if row.opened_by is None else row.opened_by.key,
            )
        )
