"""Where everything of a picture stands: title, panels one below the other, notes."""

from __future__ import annotations

from typing import Final

from rl_tui.lab.pictures import colours
from rl_tui.lab.pictures.atlas_layout import atlas_shapes
from rl_tui.lab.pictures.chart_layout import chart_shapes
from rl_tui.lab.pictures.picture import Chart, Picture
from rl_tui.lab.pictures.shapes import DrawnPage, Rectangle, Shape, Text, area, wrapped

WIDTH: Final = 760.0
MARGIN: Final = 22.0
_TITLE_SIZE, _TITLE_LINE = 17.0, 22.0
_NOTE_SIZE, _NOTE_LINE = 11.5, 16.0
_BETWEEN: Final = 22.0


def laid_out(picture: Picture) -> DrawnPage:
    """Return ``picture`` as shapes."""
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
