"""Saving what was drawn as a scenario file."""

from __future__ import annotations

from rl_tui.tui.screens.playground.actions.subject import Subject


class ScenarioSaving(Subject):
    """Asks under which name, and never writes over what somebody else has changed."""

    def save(self) -> None:
        """Save the world as it is drawn."""
        self.screen.tell("saving comes")
