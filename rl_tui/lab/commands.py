"""What a screen may ask of a player."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.lab.recipe import Change, Recipe
from rl_tui.lab.windows import Sight


@dataclass(frozen=True, slots=True)
class Play:
    """Run on at the wanted speed."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Stand still; also breaks off an episode under way."""


@dataclass(frozen=True, slots=True)
class Step:
    """Pause if running, and take one step."""


@dataclass(frozen=True, slots=True)
class RunEpisode:
    """Run to the end of the episode under way, as fast as it goes, and pause there."""


@dataclass(frozen=True, slots=True)
class Train:
    """Take exactly ``steps`` steps (fewer only where the run ends) before any other command counts."""

    steps: int


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Steps a second to aim at from now on; None for as fast as it goes."""

    speed: float | None


@dataclass(frozen=True, slots=True)
class Apply:
    """Change a hyper-parameter or the algorithm before the next step."""

    change: Change


@dataclass(frozen=True, slots=True)
class Restart:
    """Start again from ``recipe``, paused."""

    recipe: Recipe


@dataclass(frozen=True, slots=True)
class LookAt:
    """Copy no more than ``sight`` shows of a world that is too large to be copied whole."""

    sight: Sight


Command = Play | Pause | Step | RunEpisode | Train | SetSpeed | Apply | Restart | LookAt
