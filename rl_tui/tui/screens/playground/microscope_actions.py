"""The last step under the microscope."""

from __future__ import annotations

from textual import on
from textual.widget import Widget

from rl_tui.lab.live.commands import FollowCell
from rl_tui.lab.live.snapshot import Phase
from rl_tui.tui.panels.q_table.q_table import QTable
from rl_tui.tui.screens.playground.agent_actions import AgentActions


class MicroscopeActions(AgentActions):
    """Opening and closing the microscope, and which cell has its history shown there."""

    _focused_before: Widget | None = None

    def action_microscope(self) -> None:
        """Open the microscope, or close it."""
        if self.board.dissects:
            self.close_microscope()
            return
        self._focused_before = self.focused
        self.board.dissect(opened=True)
        self._follow_cell()
        self._draw_again()
        self.board.microscope.focus()

    def close_microscope(self) -> None:
        """Close the microscope; if it had the focus, that goes back to where it was."""
        had_focus = self.board.microscope.has_focus
        self.board.dissect(opened=False)
        self.board.microscope.pair = None
        self.send(FollowCell(None))
        self._draw_again()
        if had_focus:
            self.set_focus(self._focused_before)
        self._focused_before = None

    def bring_into_view(self, panel: str) -> None:
        """Show ``panel``: end the zoom, and close the microscope where there is no room for both."""
        if self.board.zoomed not in (None, panel):
            self.board.zoom(None)
        if self.board.dissects and not self.board.has_room_for(panel):
            self.close_microscope()

    def follow_last_update(self) -> None:
        """Show the history of the pair updated last, as long as there is none yet, or while nothing runs."""
        runs = self.snapshot is not None and self.snapshot.playback.phase is Phase.RUNNING
        if self.board.dissects and (self.board.microscope.pair is None or not runs):
            self._follow_cell()

    @on(QTable.CursorMoved)
    def follow_cursor(self) -> None:
        """Show the history of the cell that the cursor went to."""
        if self.board.dissects:
            self._follow_cell()
            self.board.microscope.redraw()

    def _draw_again(self) -> None:
        if self.snapshot is not None:
            self.board.show(self.snapshot, revealed=self.board.table.revealed)

    def _follow_cell(self) -> None:
        """Ask for the history of the cursor's pair, or of the one updated last."""
        if self.snapshot is None:
            return
        pair, last = self.board.table.cursor_pair, self.snapshot.counters.last_step
        if pair is None and last is not None:
            pair = last.updated_pair if last.learned else self.board.microscope.pair
        if pair is not None and pair >= self.snapshot.world.space.pairs:
            pair = None  # of the world before this one
        if pair != self.board.microscope.pair:
            self.board.microscope.pair = pair
            self.send(FollowCell(pair))
