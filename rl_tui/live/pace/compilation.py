"""Waiting for machine code, or running interpreted meanwhile."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rl_tui.agents.compiling.background import BACKGROUND

if TYPE_CHECKING:
    from rl_tui.agents.kernels.machine_code import Loop
    from rl_tui.runs.timeline.run_group import RunGroup

MOST_INTERPRETED: Final = 100_000
"""More steps than this wait for machine code: interpreted, they take seconds or minutes."""
LOOK_AGAIN: Final = 0.05
"""Seconds between two checks while waiting."""


class Compilation:
    """Requests machine code for a group of runs, without `automatic` only on request and for many steps."""

    def __init__(self, *, automatic: bool) -> None:
        self._automatic = automatic
        self._loops: list[Loop] = []
        self.interpreted = False
        """True if a run was interpreted at the last check."""
        self.why_not = ""
        """Reason why no machine code will come, as a sentence, else empty."""
        self._is_closed = False

    def has_changed(self, group: RunGroup) -> bool:
        """Request machine code. Return True if other loops are interpreted."""
        loops = group.interpreted_loops
        why_not = BACKGROUND.why_not(loops) if loops else ""
        if (loops, why_not) == (self._loops, self.why_not):
            return False
        are_new, self._loops, self.why_not = loops != self._loops, loops, why_not
        self.interpreted = bool(loops)
        if self._automatic and are_new:
            self.ask()
        return True

    def ask(self) -> None:
        """Request machine code for interpreted loops."""
        if not self._is_closed:
            BACKGROUND.want(self._loops)

    def close(self) -> None:
        """Make no further requests. Those of others remain."""
        self._is_closed = True

    def waits(self, steps: int) -> bool:
        """Return True if `steps` should wait for machine code."""
        is_worth_it = steps > MOST_INTERPRETED and bool(self._loops) and not BACKGROUND.why_not(self._loops)
        if is_worth_it:
            self.ask()
        return is_worth_it
