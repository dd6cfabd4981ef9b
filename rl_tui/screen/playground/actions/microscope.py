"""The last step under the microscope."""

from __future__ import annotations

from rl_tui.live.commands import FollowCell
from rl_tui.live.snapshot import Phase
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.row import MICROSCOPE


class MicroscopeActions(Subject):
    """Which cell has its history shown under the microscope."""

    def follow_update(self) -> None:
        """Show the history of the pair updated last, as long as there is none yet, or while nothing runs."""
        runs = self.snapshot is not None and self.snapshot.playback.phase is Phase.RUNNING
        if self.board.opened != MICROSCOPE:
            self._show_history(None)
        elif self.board.microscope.pair is None or not runs:
            self._follow_cell()

    def follow_cursor(self) -> None:
        """Show the history of the cell that the cursor went to."""
        if self.board.opened == MICROSCOPE:
            self._follow_cell()
            self.board.microscope.redraw()

    def _follow_cell(self) -> None:
        """Ask for the history of the cursor's pair, or of the one updated last."""
        if self.snapshot is None:
            return
        pair, last = self.board.table.cursor_pair, self.snapshot.counters.last_step
        if pair is None and last is not None:
            pair = last.updated_pair if last.learned else self.board.microscope.pair
        if pair is not None and pair >= self.snapshot.world.space.pairs:
            pair = None  # of the world before this one
        self._show_history(pair)

    def _show_history(self, pair: int | None) -> None:
        if pair != self.board.microscope.pair:
            self.board.microscope.pair = pair
            self.link.send(FollowCell(pair))
