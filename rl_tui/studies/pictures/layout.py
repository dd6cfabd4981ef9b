"""The layout of a picture in pixels: title, panels, notes, and heat maps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

from rl_tui.studies.pictures import colours
from rl_tui.studies.pictures.chart_layout import chart_shapes
from rl_tui.studies.pictures.picture import AtlasChart, Chart, Picture, number_text
from rl_tui.studies.pictures.shapes import (
    Disc,
    DrawnPage,
    Path,
    Rectangle,
    Shape,
    Text,
    area,
    fitting,
    text_width,
    wrapped,
)

# Heat map of two settings


SIZE: Final = 12.0
_CELL_SIZE: Final = 11.0
_ATLAS_TITLE_SIZE, _ATLAS_TITLE_LINE = 13.5, 20.0
_LABEL_LINE: Final = 18.0
_BAR, _BAR_GAP = 16.0, 18.0
_TALLEST, _LOWEST, _MOST_HEIGHT = 34.0, 8.0, 420.0
_BAR_PARTS: Final = 64
_BESIDE: Final = 6.0  # pixels between names and cells


def atlas_shapes(atlas: AtlasChart, left: float, top: float, width: float) -> tuple[float, list[Shape]]:
    """Return the bottom of the heat map and its shapes."""
    names = max(text_width(name, SIZE) for name in atlas.rows) + _BESIDE
    labels = max(text_width(label, SIZE) for label in atlas.scale.labels)
    y = top
    shapes: list[Shape] = []
    if atlas.title:
        y += _ATLAS_TITLE_LINE
        title = fitting(atlas.title, _ATLAS_TITLE_SIZE, width)
        shapes.append(Text(left, y - 5, title, _ATLAS_TITLE_SIZE, colours.TEXT, bold=True))
    y += _LABEL_LINE
    shapes.append(Text(left, y - 5, atlas.y_label, SIZE, colours.DIM))
    height = min(max(_MOST_HEIGHT / len(atlas.rows), _LOWEST), _TALLEST) * len(atlas.rows)
    box = Rectangle(
        left + names, y + 4, width - names - _BAR_GAP - _BAR - _BESIDE - labels, max(height, 120.0)
    )
    shapes += _cells(atlas, box)
    shapes += _row_names(atlas, box)
    shapes += _column_names(atlas, box)
    shapes += _colour_bar(atlas, Rectangle(box.right + _BAR_GAP, box.top, _BAR, box.height))
    y = box.bottom + 2 * _LABEL_LINE + 4
    shapes.append(Text(box.left + box.width / 2, y - 4, atlas.x_label, SIZE, colours.DIM, anchor="middle"))
    if atlas.best is not None or atlas.marked:
        y += _LABEL_LINE
        shapes += _key(atlas, box.left, y)
    return y, shapes


def _cell(atlas: AtlasChart, box: Rectangle, row: int, column: int) -> Rectangle:
    width, height = box.width / len(atlas.columns), box.height / len(atlas.rows)
    return Rectangle(box.left + column * width, box.bottom - (row + 1) * height, width, height)


def _cells(atlas: AtlasChart, box: Rectangle) -> Iterator[Shape]:
    texts = [[None if value is None else number_text(value, 3) for value in row] for row in atlas.values]
    widest = max((text_width(text, _CELL_SIZE) for row in texts for text in row if text), default=0.0)
    first = _cell(atlas, box, 0, 0)
    marked = atlas.marked
    has_numbers = widest + 6 <= first.width and first.height >= _CELL_SIZE + 5
    for row, values in enumerate(atlas.values):
        for column, value in enumerate(values):
            cell = _cell(atlas, box, row, column)
            if value is None:
                yield area(cell, colours.MISSING, colours.BACKGROUND)
                yield Path(
                    ((cell.left, cell.bottom), (cell.right, cell.top)), stroke=colours.FRAME, width=0.7
                )
                continue
            share = atlas.scale.share(value)
            yield area(cell, colours.ramp_colour(share), colours.BACKGROUND, width=0.6)
            text = texts[row][column]
            if has_numbers and text is not None:
                x, y = cell.left + cell.width / 2, cell.top + cell.height / 2 + _CELL_SIZE / 3
                yield Text(x, y, text, _CELL_SIZE, colours.text_on_ramp(share), anchor="middle")
            if (row, column) in marked:
                yield _dot(cell, colours.text_on_ramp(share), in_corner=has_numbers)
    if atlas.best is not None:
        yield from _frame(_cell(atlas, box, *atlas.best))


def _dot(cell: Rectangle, colour: str, *, in_corner: bool) -> Disc:
    radius = min(2.4, cell.width / 4, cell.height / 4)
    if in_corner:
        return Disc(cell.right - radius - 3, cell.top + radius + 3, radius, colour)
    return Disc(cell.left + cell.width / 2, cell.top + cell.height / 2, radius, colour)


def _frame(cell: Rectangle) -> Iterator[Shape]:
    for inset, colour, width in ((0.0, "#ffffff", 4.5), (0.0, "#05080b", 2.2)):
        inner = Rectangle(
            cell.left + inset, cell.top + inset, cell.width - 2 * inset, cell.height - 2 * inset
        )
        yield Path(inner.corners, stroke=colour, width=width, closed=True)


def _row_names(atlas: AtlasChart, box: Rectangle) -> Iterator[Shape]:
    height = box.height / len(atlas.rows)
    for row in _thinned(len(atlas.rows), (SIZE + 2) / height):
        y = box.bottom - (row + 0.5) * height + SIZE / 3
        yield Text(box.left - _BESIDE, y, atlas.rows[row], SIZE, colours.TEXT, anchor="end")


def _column_names(atlas: AtlasChart, box: Rectangle) -> Iterator[Shape]:
    width = box.width / len(atlas.columns)
    widest = max(text_width(name, SIZE) for name in atlas.columns) + _BESIDE
    for column in _thinned(len(atlas.columns), widest / width):
        x, y = box.left + (column + 0.5) * width, box.bottom + SIZE + 4
        yield Text(x, y, atlas.columns[column], SIZE, colours.TEXT, anchor="middle")


def _thinned(count: int, room: float) -> Sequence[int]:
    return range(0, count, max(1, math.ceil(room - 1e-9)))


def _colour_bar(atlas: AtlasChart, bar: Rectangle) -> Iterator[Shape]:
    part = bar.height / _BAR_PARTS
    for place in range(_BAR_PARTS):
        share = (place + 0.5) / _BAR_PARTS
        # to the end of the bar, so that no background shows between two parts
        box = Rectangle(bar.left, bar.top, bar.width, bar.height - place * part)
        yield area(box, colours.ramp_colour(share))
    yield Path(bar.corners, stroke=colours.FRAME, closed=True)
    for share, label in zip(atlas.scale.tick_shares, atlas.scale.labels, strict=True):
        y = bar.bottom - share * bar.height
        yield Path(((bar.right, y), (bar.right + 3, y)), stroke=colours.FRAME)
        yield Text(bar.right + _BESIDE, y + SIZE / 3, label, SIZE, colours.TEXT)


def _key(atlas: AtlasChart, left: float, y: float) -> Iterator[Shape]:
    if atlas.best is not None:
        yield from _frame(Rectangle(left + 1, y - 11, 14, 11))
        words = "the best"
        yield Text(left + 22, y - 1, words, SIZE, colours.DIM)
        left += 22 + text_width(words, SIZE) + 18
    if atlas.marked:
        yield Disc(left + 3, y - 5, 2.4, colours.TEXT)
        yield Text(left + 12, y - 1, "tied with the best", SIZE, colours.DIM)


# The whole picture


WIDTH: Final = 760.0
MARGIN: Final = 22.0
_TITLE_SIZE, _TITLE_LINE = 17.0, 22.0
_NOTE_SIZE, _NOTE_LINE = 11.5, 16.0
_BETWEEN: Final = 22.0


def laid_out(picture: Picture) -> DrawnPage:
    """Return the shapes of `picture`."""
    shapes: list[Shape] = []
    inside = WIDTH - 2 * MARGIN
    y = MARGIN
    for line in wrapped(picture.title, _TITLE_SIZE, inside):
        y += _TITLE_LINE
        shapes.append(Text(MARGIN, y - 5, line, _TITLE_SIZE, colours.TEXT, bold=True))
    for panel in picture.panels:
        y += _BETWEEN / 2
        bottom, drawn = (
            chart_shapes(panel, MARGIN, y, inside)
            if isinstance(panel, Chart)
            else atlas_shapes(panel, MARGIN, y, inside)
        )
        shapes += drawn
        y = bottom + _BETWEEN / 2
    for note in filter(None, (*picture.notes, picture.band)):
        for line in wrapped(note, _NOTE_SIZE, inside):
            y += _NOTE_LINE
            shapes.append(Text(MARGIN, y - 4, line, _NOTE_SIZE, colours.DIM))
    height = y + MARGIN
    background = area(Rectangle(0.0, 0.0, WIDTH, height), colours.BACKGROUND)
    return DrawnPage(WIDTH, height, picture.title, picture.summary, [background, *shapes])
