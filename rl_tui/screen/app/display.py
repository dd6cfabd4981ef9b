"""What the person who starts the program may choose about how it looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

_LEAST_FPS: Final = 10.0  # for motion
_TICKS: Final = 15.0
Colours = Literal["auto", "none", "16", "256", "truecolor"]


@dataclass(frozen=True, slots=True)
class Display:
    """Display options of play and screenshot.

    ``theme`` is the name of a theme, ``ascii`` keeps to ASCII characters, ``fps`` (> 0) is the most frames
    drawn a second. With ``reduced_motion`` nothing moves after a step. If it ``is_big``, a playground begins
    with the world on the whole screen. ``panels`` are the ids of those it begins with: FEW come one by one,
    None: as the scenario says.
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
        """How often a second a moving picture is drawn; 0: no picture moves."""
        return 0.0 if self.reduced_motion or self.fps < _LEAST_FPS else min(self.fps, _TICKS)
