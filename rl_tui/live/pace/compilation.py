"""Runs that go on interpreted until their machine code is there, and what had better wait for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rl_tui.agents.compiling.background import BACKGROUND

if TYPE_CHECKING:
    from rl_tui.agents.kernels.machine_code import Loop
    from rl_tui.runs.timeline.run_group import RunGroup

MOST_INTERPRETED: Final = 100_000
"""Before more steps than these it waits for machine code: interpreted they take seconds, or minutes."""
LOOK_AGAIN: Final = 0.05
"""Seconds after which what waits looks again."""


class Compilation:
    """Gets machine code for a group of runs.

    With ``automatic`` off, where only commands take steps, it does so when asked, and for many steps.
    """

    def __init__(self, *, automatic: bool) -> None:
        self._automatic = automatic
        self._loops: list[Loop] = []
        self.why_not = ""
        """Why no machine code will come for what is interpreted, as a sentence; empty where it may."""
        self._is_closed = False

    @property
    def interpreted(self) -> bool:
        """Whether a run is interpreted, as far as was looked."""
        return bool(self._loops)

    @property
    def is_being_read(self) -> bool:
        """Whether machine code is about to be there; it comes the sooner, the less else is done."""
        return self.interpreted and BACKGROUND.is_loading

    def has_changed(self, group: RunGroup) -> bool:
        """Look what ``group`` interprets and have machine code come for it; True if it is not as before."""
        loops = group.interpreted_loops
        why_not = BACKGROUND.why_not(loops)
        if (loops, why_not) == (self._loops, self.why_not):
            return False
        are_new, self._loops, self.why_not = loops != self._loops, loops, why_not
        if self._automatic and are_new:
            self.ask()
        return True

    def ask(self) -> None:
        """Have machine code come for what is interpreted."""
        if not self._is_closed:
            BACKGROUND.want(self._loops)

    def close(self) -> None:
        """Ask for nothing any more: what others want by now is to stay wanted."""
        self._is_closed = True

    def waits(self, steps: int) -> bool:
        """Return True if so many steps had better wait for machine code; it comes then, unless that fails."""
        is_worth_it = steps > MOST_INTERPRETED and bool(self._loops) and not BACKGROUND.why_not(self._loops)
        if is_worth_it:
            self.ask()
        return is_worth_it
