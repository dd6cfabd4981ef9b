"""What a playback asks of a run that can show every earlier step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from rl_tui.runs.recipe import UNLIMITED, Recipe
from rl_tui.runs.timeline.branches import RunRecord, Timeline
from rl_tui.runs.timeline.checkpoints import Seek
from rl_tui.runs.timeline.table_samples import CellHistory
from rl_tui.runs.timeline.trail import Trail

if TYPE_CHECKING:
    from rl_tui.agents.kernels.watch import Watching
    from rl_tui.runs.played_run import PlayedRun


class Playing(Protocol):
    """A run that advances, and that can show every earlier step."""

    begun_at: int | None

    @property
    def recipe(self) -> Recipe:
        """Start of the run."""

    @property
    def run(self) -> PlayedRun:
        """The run at the current position."""

    @property
    def seek(self) -> Seek | None:
        """The current seek, or None."""

    @property
    def timeline(self) -> Timeline:
        """Position among all branches."""

    @property
    def record(self) -> RunRecord:
        """Record of the current position."""

    @property
    def trail(self) -> Trail:
        """Known steps of the current episode."""

    @property
    def trail_to_find(self) -> int:
        """Length of the trail after `find_trail`, or 0."""

    def find_trail(self, seconds: float) -> None:
        """Search for missing steps of the trail for about `seconds`."""

    def cell_history(self, pair: int) -> CellHistory | None:
        """Return the history of the estimate of `pair`, or None if unknown."""

    def watch(self, watching: Watching | None) -> None:
        """Stop `advance` right after the event `watching`."""

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Advance by at most `steps` and `episodes`."""

    def seek_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Start to seek a step or the beginning of an episode."""

    def continue_seek(self, steps: int) -> int:
        """Seek by at most `steps` and return the steps taken."""

    def stop_seek(self) -> None:
        """Stop seeking, at the current position."""
