"""Where the run is to stop by itself."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class UntilStage(AgentStage):
    """What a person may wait for."""

    def action_until(self) -> None:
        """Choose what to run until."""

    def action_breakpoint(self) -> None:
        """Set a breakpoint where the cursor is, or take it away."""

    def action_clear_breakpoints(self) -> None:
        """Take all breakpoints away."""
