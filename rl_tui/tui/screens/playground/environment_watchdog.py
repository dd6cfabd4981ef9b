"""Showing that an environment does not answer: the run waits for it, the screen does not."""

from __future__ import annotations

from typing import Final

from rl_tui.lab.live.player import Player
from rl_tui.tui.panels.status_line import StatusLine

CHECK_EVERY: Final = 0.5  # seconds
WORTH_SHOWING: Final = 3.0  # seconds without an answer


class EnvironmentWatchdog:
    """Looks whether the ``player`` has to wait for an environment, and says so on the ``status`` line."""

    def __init__(self, player: Player, status: StatusLine) -> None:
        self._player = player
        self._status = status

    def check(self) -> None:
        """Show for how long the environment has not answered, if that is long."""
        seconds = self._player.unanswered
        self._status.show_unanswered(int(seconds) if seconds >= WORTH_SHOWING else 0)
