"""The cells of a map as rows of text."""

from __future__ import annotations

from collections.abc import Sequence

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.action_form import ActionForm
from rl_tui.screen.panels.grid.action_values import ActionArtist
from rl_tui.screen.panels.grid.cells import CellArtist
from rl_tui.screen.panels.grid.form import CellForm
from rl_tui.screen.panels.grid.map import CellContent, MapPart


def origin(form: CellForm | ActionForm, part: MapPart, width: int, height: int) -> tuple[int, int]:
    """Return column and row at which ``part`` begins, in the middle of width × height characters."""
    return (
        max(0, (width - part.columns * form.width) // 2),
        max(0, (height - part.rows * form.height) // 2),
    )


def draw_grid(
    cells: Sequence[CellContent],
    artist: CellArtist | ActionArtist,
    number_form: NumberForm,
    scale: ValueScale,
    range_of_v: ValueScale,
    part: MapPart,
    width: int,
    height: int,
) -> list[Strip]:
    """Return ``cells``, those of ``part`` row by row, in the middle of width × height characters.

    ``scale`` is that of the tints, ``range_of_v`` that by which actions lead.
    """
    form, text = artist.form, artist.look.palette.text
    faces = [artist.face(cell, scale, number_form, range_of_v) for cell in cells]
    left, top = origin(form, part, width, height)
    blank = Strip([Segment(" " * width, text)], width)
    strips = [blank] * top
    for first in range(0, len(faces), part.columns):
        strips += artist.strips(tuple(faces[first : first + part.columns]), left, width)
    return strips + [blank] * (height - len(strips))
