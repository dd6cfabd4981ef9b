"""Writing a run for other programs."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class ExportStage(AgentStage):
    """Exporting."""

    def action_export(self) -> None:
        """Choose what to write."""
