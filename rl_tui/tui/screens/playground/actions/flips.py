"""Where γ decides which actions are best."""

from __future__ import annotations

from typing import Final

from rl_tui.lab.answers.flip_answer import FlipState
from rl_tui.lab.live.commands import AskFlips
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.tui.panels.catalogue import DISCOUNT
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.screens.playground.actions.subject import Subject
from rl_tui.worlds.world import World

_GAMMA: Final = "gamma"
_NOT_YET: Final = (Phase.PREPARING, Phase.SEEKING)


class FlipActions(Subject):
    """When flips are asked for: once for each world, and not before anybody may look at them."""

    _asked: World | None = None

    def follow(self) -> None:
        """Ask for the flips of the world shown, where they are wanted and were not asked for yet."""
        snapshot = self.snapshot
        if snapshot is None or snapshot.world is self._asked or snapshot.answers.is_hidden:
            return
        is_unknown = snapshot.answers.flips.state is FlipState.NOT_ASKED
        if is_unknown and snapshot.playback.phase not in _NOT_YET and self._are_wanted(snapshot):
            self._asked = snapshot.world
            self.link.send(AskFlips())

    def _are_wanted(self, snapshot: Snapshot) -> bool:
        """Return whether the panel is open or a person is at the slider of γ.

        Where the run goes on by itself, they are wanted for the slider as soon as it rests.
        """
        focused = self.screen.focused
        if self.board.opened == DISCOUNT or (isinstance(focused, Slider) and focused.id == _GAMMA):
            return True
        rests = snapshot.playback.phase is not Phase.RUNNING
        return self.link.player.is_automatic and rests and self.board.controls.has_slider(_GAMMA)
