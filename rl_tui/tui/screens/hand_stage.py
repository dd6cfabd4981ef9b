"""A person in place of the agent."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class HandStage(AgentStage):
    """Taking over, and handing back."""

    def action_take_over(self) -> None:
        """Take over, or hand back."""
