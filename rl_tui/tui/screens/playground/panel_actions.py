"""Panels that have a key of their own: opened, closed, and made way for others."""

from __future__ import annotations

from textual.widget import Widget

from rl_tui.tui.screens.playground.microscope_actions import MicroscopeActions


class PanelActions(MicroscopeActions):
    """Opening and closing the panels that a key opens; one of them is open at a time."""

    _focused_before: Widget | None = None

    def action_toggle_panel(self, panel: str) -> None:
        """Open ``panel`` in place of the one that is open, or close it."""
        board = self.board
        if board.opened is not None:
            was_open = board.opened
            self.close_panel()
            if was_open == panel:
                return
        row = board.rows[panel]
        if self.snapshot is not None and not row.needs(self.snapshot.world.drawing):
            self.tell(f"{row.title}: there is nothing to show of this world")
            return
        self._focused_before = self.focused
        board.open(panel)
        self._draw_again()
        board.panel(panel).focus()

    def close_panel(self) -> None:
        """Close the panel that is open; if it had the focus, that goes back to where it was."""
        board = self.board
        had_focus = board.opened is not None and board.panel(board.opened).has_focus_within
        board.open(None)
        self._draw_again()
        if had_focus:
            self.set_focus(self._focused_before)
        self._focused_before = None

    def bring_into_view(self, panel: str) -> None:
        """Show ``panel``: end the zoom, and close the panel that stands in its place."""
        if self.board.zoomed not in (None, panel):
            self.board.zoom(None)
        if self.board.opened is not None and not self.board.has_room_for(panel):
            self.close_panel()

    def _draw_again(self) -> None:
        if self.snapshot is not None:
            self.follow_last_update()
            self.board.show(self.snapshot, revealed=self.board.table.revealed)
