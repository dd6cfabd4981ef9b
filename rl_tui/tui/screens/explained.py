"""Terms on the left and what they mean on the right, wrapped: pages of them are drawn at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap
from typing import Final, NamedTuple

from rich.segment import Segment
from rich.style import Style
from textual.geometry import Size
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.glyphs import Glyphs

_LEFT: Final = 14  # columns
_BOLD: Final = Style(bold=True)


class Explanation(NamedTuple):
    """What ``term`` means; a heading where there is no ``meaning``."""

    term: str
    meaning: str = ""


class Explained(Widget):
    """Draws ``rows`` in the characters of ``glyphs``, as high as they come out at its width.

    A line is only made when it is drawn, and nothing but wrapping is needed to know how many there are.
    """

    DEFAULT_CSS = """
    Explained {
        width: 1fr;
        height: auto;
    }
    """

    def __init__(self, rows: Sequence[Explanation], glyphs: Glyphs, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self._rows = [Explanation(to_ascii(row.term, glyphs), to_ascii(row.meaning, glyphs)) for row in rows]
        self._wrapped: tuple[int, list[Explanation]] = (0, [])

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the number of lines at ``width`` columns."""
        return len(self._lines(width))

    def render_line(self, y: int) -> Strip:
        """Draw one line."""
        width, style = self.size.width, self.rich_style
        lines = self._lines(width)
        if y >= len(lines):
            return Strip.blank(width, style)
        term, meaning = lines[y]
        left = Segment(term.ljust(_LEFT), style if meaning else style + _BOLD)
        return Strip([left, Segment(meaning, style)]).adjust_cell_length(width, style)

    def _lines(self, width: int) -> list[Explanation]:
        if self._wrapped[0] != width:
            self._wrapped = width, [line for row in self._rows for line in _wrapped(row, width)]
        return self._wrapped[1]


def _wrapped(row: Explanation, width: int) -> Iterator[Explanation]:
    term, meaning = row
    for part in wrap(meaning, max(1, width - _LEFT), break_on_hyphens=False) or [""]:
        yield Explanation(term, part)
        term = ""
