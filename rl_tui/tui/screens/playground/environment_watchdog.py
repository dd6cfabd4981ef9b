"""Telling that an environment does not answer: the run waits for it, the screen does not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rl_tui.tui.panels.status_line import StatusLine
from rl_tui.tui.screens.playground.agent_actions import AgentStage

if TYPE_CHECKING:
    from rl_tui.lab.live.player import Player

LISTENS_EVERY: Final = 0.5
WORTH_TELLING: Final = 3.0


class SilenceStage(AgentStage):
    """A screen whose ``player`` may have to wait for an environment."""

    player: Player

    @property
    def is_here(self) -> bool:
        """Whether it is one of the screens still: of one that is left, or of an end, the panels go first."""
        return self.is_attached and self.app.is_running and self in self.app.screen_stack

    def on_mount(self) -> None:
        """Listen whether it answers."""
        self.set_interval(LISTENS_EVERY, self.listen)

    def listen(self) -> None:
        """Say for how long nothing was heard, if that is worth it."""
        if not self.is_here:
            return
        seconds = self.player.unanswered
        self.query_one(StatusLine).tell_silence(int(seconds) if seconds >= WORTH_TELLING else 0)
