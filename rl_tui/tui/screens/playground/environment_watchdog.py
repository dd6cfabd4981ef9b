"""Showing that an environment does not answer: the run waits for it, the screen does not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rl_tui.tui.panels.status_line import StatusLine
from rl_tui.tui.screens.playground.agent_actions import AgentActions

if TYPE_CHECKING:
    from rl_tui.lab.live.player import Player

CHECK_EVERY: Final = 0.5  # seconds
WORTH_SHOWING: Final = 3.0  # seconds without an answer


class EnvironmentWatchdog(AgentActions):
    """A screen whose ``player`` may have to wait for an environment."""

    player: Player

    @property
    def is_here(self) -> bool:
        """Whether it is one of the screens still: of one that is left, or of an end, the panels go first."""
        return self.is_attached and self.app.is_running and self in self.app.screen_stack

    def on_mount(self) -> None:
        """Begin to check whether it answers."""
        self.set_interval(CHECK_EVERY, self.check_environment)

    def check_environment(self) -> None:
        """Show for how long the environment has not answered, if that is long."""
        if not self.is_here:
            return
        seconds = self.player.unanswered
        self.query_one(StatusLine).show_unanswered(int(seconds) if seconds >= WORTH_SHOWING else 0)
