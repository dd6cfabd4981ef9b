"""Runs that go on interpreted until their machine code is there, and what had better wait for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rl_tui.agents.compiling.background import BACKGROUND

if TYPE_CHECKING:
    from rl_tui.lab.timeline.run_group import RunGroup

MOST_INTERPRETED: Final = 20_000
"""Before more steps than these it waits for machine code: interpreted they take longer than to compile."""
LOOK_AGAIN: Final = 0.05
"""Seconds after which what waits looks again."""


class Compilation:
    """Gets machine code for a group of runs.

    With ``automatic`` off, where nothing may depend on the time, it does so only for many steps.
    """

    def __init__(self, *, automatic: bool) -> None:
        self.interpreted = False
        """Whether a run is interpreted, as far as was looked."""
        self._automatic = automatic

    def begin(self, group: RunGroup) -> None:
        """Have machine code come for what ``group`` interprets."""
        loops = group.interpreted_loops
        self.interpreted = bool(loops)
        if self._automatic:
            BACKGROUND.want(loops)

    def has_just_ended(self, group: RunGroup) -> bool:
        """Return True once, when no run of ``group`` is interpreted any more."""
        if not self.interpreted or group.interpreted_loops:
            return False
        self.interpreted = False
        return True

    def waits(self, group: RunGroup, steps: int) -> bool:
        """Return True if so many steps had better wait for machine code; it comes then in any case."""
        loops = group.interpreted_loops if self.interpreted and steps > MOST_INTERPRETED else []
        if loops and not self._automatic:
            BACKGROUND.want(loops)
        return bool(loops)
