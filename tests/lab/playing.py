"""Play commands as a player does, without its thread."""

from __future__ import annotations

from rl_tui.lab.commands import Step
from rl_tui.lab.playback import Playback


def busy(playback: Playback) -> bool:
    """Whether most commands have to wait."""
    return not playback.takes(Step())
