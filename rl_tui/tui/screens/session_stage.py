"""Keeping what was done."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class SessionStage(AgentStage):
    """Saving."""

    def action_save(self) -> None:
        """Ask for a name, and save the session."""
