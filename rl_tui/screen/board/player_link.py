"""The one way from the objects of the screen to the player, and back."""

from __future__ import annotations

from collections.abc import Callable

from rl_tui.live.commands import Command
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.wanted import Wanted


class PlayerLink:
    """Sends commands and holds the newest snapshot, None before the first; ``on_sent`` hears each command."""

    def __init__(self, player: Player, wanted: Wanted, on_sent: Callable[[Command], None]) -> None:
        self.player = player
        self.wanted = wanted
        self.snapshot: Snapshot | None = None
        self.sent = 0
        """How many commands were sent, also such as were sent because of what was drawn."""
        self._on_sent = on_sent

    def send(self, command: Command) -> None:
        """Ask the player for something."""
        self.sent += 1
        self.wanted.note(command)
        self._on_sent(command)
        self.player.send(command)

    def receive(self, snapshot: Snapshot) -> None:
        """Take ``snapshot`` for the newest."""
        self.snapshot = snapshot
        self.wanted.reconcile(snapshot)
