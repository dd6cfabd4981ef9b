"""What the parts of the microscope share: a heading, lines below it, and lines that wrap between groups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from textual.strip import Strip

from rl_tui.screen.draw.canvas import Line, Piece, first_that_fits, fitted, length, spelled, strips_of
from rl_tui.screen.theme.look import Look


@dataclass(frozen=True, slots=True)
class MicroscopeSection:
    """Lines below a heading, which is followed by the first of ``remarks`` (longest first) that has room.

    It takes at least ``rows`` lines, so that what stands below stays where it is from step to step.
    """

    heading: str
    lines: Sequence[Line]
    rows: int
    remarks: Sequence[str] = ()

    def drawn(self, look: Look, width: int) -> list[Line]:
        """Return heading and lines."""
        palette = look.palette
        blank: Line = [Piece("", palette.text)]
        missing = max(0, self.rows - len(self.lines))
        return [self._head(look, width), *self.lines, *([blank] * missing)]

    def _head(self, look: Look, width: int) -> Line:
        palette = look.palette
        head = Piece(f" {self.heading} ", palette.strong)
        forms = [[head, Piece(f" {remark} ", palette.text)] for remark in self.remarks if remark]
        kept = fitted(first_that_fits([*forms, [head]], width, look), width, look)
        return [*kept, Piece(look.glyphs.thin * max(0, width - length(kept)), palette.dim)]


def flowed(groups: Sequence[Line], width: int, look: Look, indent: int = 1) -> list[Line]:
    """Return ``groups``, none of which is broken, as lines of at most ``width`` cells.

    Blanks before a group set it off from the one before and go where a line begins. All lines but the first
    begin after ``indent`` blanks.
    """
    lines: list[list[Piece]] = []
    used = 0
    for group in groups:
        needed = length(spelled(group, look))
        if lines and used + needed <= width:
            lines[-1] += group
            used += needed
            continue
        first, *rest = group
        margin = Piece(" " * (indent if lines else 1), look.palette.text)
        lines.append([margin, Piece(first.text.lstrip(" "), first.style), *rest])
        used = length(spelled(lines[-1], look))
    return list(lines)


def columns_of(text: str, look: Look) -> int:
    """Return how many cells ``text`` takes as it is spelled on this terminal."""
    return length(spelled([Piece(text, look.palette.text)], look))


def aligned(text: str, width: int, look: Look, *, right: bool = False) -> str:
    """Return ``text`` filled up to ``width`` cells as spelled on this terminal."""
    blanks = " " * max(0, width - columns_of(text, look))
    return blanks + text if right else text + blanks


def stacked(sections: Sequence[MicroscopeSection], look: Look, width: int, height: int = 0) -> list[Strip]:
    """Return ``sections`` below one another, a blank line between them where ``height`` has room for it."""
    parts = [section.drawn(look, width) for section in sections]
    needed = sum(map(len, parts)) + len(parts) - 1
    between: list[Line] = [[Piece("", look.palette.text)]] if needed <= height else []
    lines = [line for number, part in enumerate(parts) for line in (*(between if number else ()), *part)]
    return strips_of(lines, width, len(lines), look)
