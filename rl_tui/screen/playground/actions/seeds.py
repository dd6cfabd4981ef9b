"""The same runs under many seeds."""

from __future__ import annotations

from rl_tui.live.commands import EndStudy, StudySeeds
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.row import MANY_SEEDS
from rl_tui.screen.panels.seed_figures import may_count_again


class SeedActions(Subject):
    """When many seeds are counted: while their panel is open."""

    _counts: bool = False

    def follow_panel(self) -> None:
        """Begin to count when the panel has been opened, and end when it has been closed."""
        is_open = self.board.opened == MANY_SEEDS
        if is_open != self._counts:
            self._counts = is_open
            self.link.send(StudySeeds() if is_open else EndStudy())

    def count_again(self) -> None:
        """Count the runs as they are now, unless that is under way."""
        if self.snapshot is not None and may_count_again(self.snapshot.study):
            self.link.send(StudySeeds())
