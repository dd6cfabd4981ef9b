"""How much room labels and a body take around a map, and the labels themselves."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.screen.draw.canvas import Canvas
from rl_tui.worlds.drawing import Grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rl_tui.screen.theme.look import Look
    from rl_tui.worlds.drawing import Axes

_LEAST_BODY: Final = 4  # rows
_MOST_BODY: Final = 9
_BODY_SHARE: Final = 3  # it has one row of so many
_LEAST_MAP: Final = 5  # rows of a map below a body

# How much room


class Margins(NamedTuple):
    """Columns of labels left of a map, and above it the rows of a body and of labels."""

    left: int = 0
    body: int = 0
    labels: int = 0

    @property
    def above(self) -> int:
        """The rows above the map."""
        return self.body + self.labels


NO_MARGINS: Final = Margins()


def wanted_margins(grid: Grid, height: int) -> Margins:
    """Return the margins that ``grid`` should have in ``height`` rows."""
    axes, body = grid.axes, 0
    if grid.body is not None and height >= _LEAST_BODY + _LEAST_MAP:
        body = max(_LEAST_BODY, min(_MOST_BODY, height // _BODY_SHARE))
    if axes is None:
        return Margins(body=body)
    longest = max(map(len, axes.rows))
    return Margins(longest + bool(longest), body, 1 + bool(axes.blocks))


def margins_in(grid: Grid, cell: tuple[int, int], width: int, height: int) -> Margins:
    """Return the margins of a map of such cells, columns × rows, in width × height characters.

    They are what the map leaves free. A map that scrolls gives way to one row of labels, and every map to
    its body.
    """
    wanted = wanted_margins(grid, height)
    across, down = width - grid.columns * cell[0], height - grid.rows * cell[1]
    left = wanted.left if across >= wanted.left or across < 0 else 0
    labels = max(0, min(wanted.labels, down))
    lacks_body = wanted.body > 0 and down - labels < _LEAST_BODY
    if down < 0 or lacks_body:
        return Margins(left, wanted.body, min(1, wanted.labels))
    return Margins(left, min(_MOST_BODY, down - labels) if wanted.body else 0, labels)


# The labels


class LabelledPart(NamedTuple):
    """The cells of a map in view, and their size."""

    top: int
    left: int
    rows: int
    columns: int
    cell: tuple[int, int]


def labelled(
    strips: Sequence[Strip], axes: Axes, part: LabelledPart, margins: Margins, width: int, look: Look
) -> list[Strip]:
    """Return ``strips`` of a map with its labels left of it and above it, ``width`` cells each."""
    head = _column_labels(axes, part, margins, width, look)
    if not margins.left:
        return [*head, *strips]
    labels = _row_labels(axes, part, margins.left, len(strips), look)
    return [*head, *(Strip.join(each) for each in zip(labels, strips, strict=True))]


@lru_cache(8)
def _row_labels(axes: Axes, part: LabelledPart, left: int, height: int, look: Look) -> tuple[Strip, ...]:
    texts = [""] * height
    for row in range(part.rows):
        y = row * part.cell[1] + (part.cell[1] - 1) // 2
        if y < height:
            texts[y] = axes.rows[part.top + row].replace("-", look.glyphs.minus)
    return tuple(Strip([Segment(f"{text:>{left - 1}} ", look.palette.dim)], left) for text in texts)


@lru_cache(8)
def _column_labels(
    axes: Axes, part: LabelledPart, margins: Margins, width: int, look: Look
) -> tuple[Strip, ...]:
    canvas = Canvas(width, margins.labels, look.palette.text)
    wide, start = part.cell[0], margins.left
    if margins.labels > 1:
        for column, name in axes.blocks:
            x = start + (column - part.left) * wide
            if x >= start and x + len(name) <= width:
                canvas.put(x, 0, name, look.palette.dim)
    texts = axes.columns[part.left : part.left + part.columns] if margins.labels else ()
    every = 1 + max(map(len, texts), default=0) // wide  # a blank keeps neighbours apart
    place = 0  # within a block
    for column, text in enumerate(texts):
        x = start + column * wide + (wide - (wide > 4) - len(text)) // 2
        if text and place % every == 0 and x >= 0 and x + len(text) <= width:
            canvas.put(x, margins.labels - 1, text.replace("-", look.glyphs.minus), look.palette.dim)
        place = place + 1 if text else 0
    return tuple(canvas.strips())
