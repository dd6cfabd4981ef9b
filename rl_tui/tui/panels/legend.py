"""The legend of a panel: its signs and what they mean, on rows of its own or on the border."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.tui.draw.pieces import Line, Piece, length, spelled, strips_of
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.theme.look import Look

_GAP: Final = "   "
_BETWEEN: Final = " · "


class LegendSign(NamedTuple):
    """A ``sign`` as the panel draws it, characters and ``style``, and its ``meaning`` in a word or two.

    The sign is in the characters of the look already.
    """

    sign: str
    meaning: str
    style: Style


def legend_lines(signs: Sequence[LegendSign], width: int, look: Look) -> list[Line]:
    """Return ``signs`` in lines of ``width`` cells, in as many as they take."""
    lines: list[list[Piece]] = []
    for sign in signs:
        entry = [Piece(sign.sign, sign.style), Piece(f" {sign.meaning}", look.palette.dim)]
        if lines and length(spelled([*lines[-1], *entry], look)) + len(_GAP) <= width:
            lines[-1] += [Piece(_GAP, look.palette.dim), *entry]
        else:
            lines.append([Piece(" ", look.palette.dim), *entry])
    return [line for line in lines if length(spelled(line, look)) <= width]


def legend_strips(lines: Sequence[Line], width: int, look: Look) -> list[Strip]:
    """Return the rows of ``lines``."""
    return strips_of(lines, width, len(lines), look)


def legend_text(signs: Sequence[LegendSign], room: int, look: Look) -> str:
    """Return as many of ``signs``, the first before the others, as ``room`` cells of a border hold."""
    text = ""
    for sign in signs:
        entry = f"{sign.sign.strip()} {to_ascii(sign.meaning, look.glyphs)}".strip()
        longer = f"{text}{_BETWEEN}{entry}" if text else entry
        if cell_len(separated(longer, look.glyphs)) > room:
            continue
        text = longer
    return text
