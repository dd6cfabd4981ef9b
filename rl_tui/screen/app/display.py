"""What the person who starts the program may choose about how it looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Colours = Literal["auto", "none", "16", "256", "truecolor"]


@dataclass(frozen=True, slots=True)
class Display:
    """Display options of play and screenshot.

    ``theme`` is the name of a theme, ``ascii`` keeps to ASCII characters, ``fps`` (> 0) is the most frames
    drawn a second.
    """

    theme: str = "dark"
    colors: Colours = "auto"
    ascii: bool = False
    fps: float = 15.0
    mouse: bool = True
