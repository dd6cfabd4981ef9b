"""Going through time: steps and episodes back, any moment, other branches."""

from __future__ import annotations

from rl_tui.tui.screens.agent_stage import AgentStage


class TimeStage(AgentStage):
    """What a person may ask of time."""

    def action_step_back(self) -> None:
        """Go one step back."""

    def action_episode_back(self) -> None:
        """Go back to where the episode began."""

    def action_go_to(self) -> None:
        """Ask for a step or an episode, and go there."""

    def action_branches(self) -> None:
        """Show the branches of the run."""
