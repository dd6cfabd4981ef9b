"""The last step under the microscope."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class MicroscopeStage(AgentStage):
    """Opening and closing the microscope."""

    def action_microscope(self) -> None:
        """Open the microscope, or close it."""
