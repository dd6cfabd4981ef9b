"""Lines of characters: which character joins the arms that meet in one cell."""

from __future__ import annotations

from typing import Final, NamedTuple

from rl_tui.tui.theme.glyphs import Glyphs

THIN: Final = 1
BOLD: Final = 2

# index: up + 3·right + 9·down + 27·left, each 0 (nothing), 1 (thin) or 2 (bold)
_JOINTS: Final = " ╵╹╶└┖╺┕┗╷│╿┌├┞┍┝┡╻╽┃┎┟┠┏┢┣╴┘┚─┴┸╼┶┺┐┤┦┬┼╀┮┾╄┒┧┨┰╁╂┲╆╊╸┙┛╾┵┹━┷┻┑┥┩┭┽╃┯┿╇┓┪┫┱╅╉┳╈╋"
_ROUND: Final = {"╭": "┌", "╮": "┐", "╰": "└", "╯": "┘"}
_ROUNDED: Final = {square: rounded for rounded, square in _ROUND.items()}


class StrokeArms(NamedTuple):
    """The weights of the lines that leave a cell towards its neighbours: 0 (none), THIN or BOLD."""

    up: int = 0
    right: int = 0
    down: int = 0
    left: int = 0

    def joined(self, other: StrokeArms) -> StrokeArms:
        """Return what two lines that meet or cross in one cell make together."""
        return StrokeArms(*(max(mine, its) for mine, its in zip(self, other, strict=True)))


def joint(arms: StrokeArms, glyphs: Glyphs) -> str:
    """Return the character for ``arms``; thin corners are rounded."""
    if glyphs.name == "ascii":
        return _ascii(arms, glyphs)
    character = _JOINTS[arms.up + 3 * arms.right + 9 * arms.down + 27 * arms.left]
    return _ROUNDED.get(character, character)


def _ascii(arms: StrokeArms, glyphs: Glyphs) -> str:
    if not any(arms):
        return " "
    vertical, horizontal = max(arms.up, arms.down), max(arms.left, arms.right)
    if not horizontal:
        return glyphs.bold_vertical if vertical == BOLD else glyphs.thin_vertical
    if not vertical:
        return glyphs.bold if horizontal == BOLD else glyphs.thin
    return "+"
