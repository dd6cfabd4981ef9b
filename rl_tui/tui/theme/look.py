"""How a screen looks: its characters and its colours, chosen once from the terminal and the theme."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.theme.palette import Palette


@dataclass(frozen=True, slots=True)
class Look:
    """What every drawing widget is given."""

    glyphs: Glyphs
    palette: Palette
