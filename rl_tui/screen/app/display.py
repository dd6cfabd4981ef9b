"""Options of the display at the start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

_LEAST_FPS: Final = 10.0  # for motion
_TICKS: Final = 15.0
Colours = Literal["auto", "none", "16", "256", "truecolor"]


@dataclass(frozen=True, slots=True)
class Display:
    """Options of the display.

    ``panels``: ids of the first panels. With "few" others follow one by one, None leaves it to the scenario.
    """

    theme: str = "dark"
    colors: Colours = "auto"
    ascii: bool = False
    fps: float = 15.0
    mouse: bool = True
    reduced_motion: bool = False
    is_big: bool = False
    panels: Literal["few", "all"] | frozenset[str] | None = None

    @property
    def ticks(self) -> float:
        """Frames per second, 0 for none."""
        return 0.0 if self.reduced_motion or self.fps < _LEAST_FPS else min(self.fps, _TICKS)
