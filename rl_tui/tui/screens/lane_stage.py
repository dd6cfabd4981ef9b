"""Runs side by side."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class LaneStage(AgentStage):
    """Opening, showing and ending lanes."""

    def action_compare(self) -> None:
        """Choose what is different in another lane, or which lane to show or to end."""

    def action_lane(self) -> None:
        """Show the next lane."""
