"""Cells side by side, as the rows of a panel."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Final

from rich.segment import Segment
from textual.strip import Strip

from rl_tui.tui.draw.number_form import SteadyForms
from rl_tui.tui.panels.numbers_in_common import ends
from rl_tui.tui.panels.world.grid.action_form import ActionForm
from rl_tui.tui.panels.world.grid.action_values import ActionArtist
from rl_tui.tui.panels.world.grid.cells import CellArtist
from rl_tui.tui.panels.world.grid.form import CellForm
from rl_tui.tui.panels.world.grid.map import CellContent, MapPart
from rl_tui.worlds.mdp.space import FloatArray

_DECIMALS: Final = 2


def origin(form: CellForm | ActionForm, part: MapPart, width: int, height: int) -> tuple[int, int]:
    """Return column and row at which ``part`` begins, in the middle of width × height characters."""
    return (
        max(0, (width - part.columns * form.width) // 2),
        max(0, (height - part.rows * form.height) // 2),
    )


def draw_grid(
    cells: Sequence[CellContent],
    artist: CellArtist | ActionArtist,
    values: FloatArray,
    part: MapPart,
    width: int,
    height: int,
    number_forms: SteadyForms,
) -> list[Strip]:
    """Return ``cells``, those of ``part`` row by row, in the middle of width × height characters.

    ``values`` are all numbers that have one form, not only those in view: the tints go from the least to the
    greatest of them, 0 included.
    """
    form, text = artist.form, artist.look.palette.text
    low, high = ends(values)
    number_form = number_forms.form(type(form).__name__, values, form.digits, most=_DECIMALS)
    drawn = artist.drawn(cells, min(low, 0.0), max(high, 0.0), number_form)
    left, top = origin(form, part, width, height)
    before = Segment(" " * left, text)
    after = Segment(" " * max(0, width - part.columns * form.width - len(before.text)), text)
    strips = [Strip([Segment(" " * width, text)], width)] * top
    for row in range(part.rows):
        faces = drawn[row * part.columns : (row + 1) * part.columns]
        for line in range(form.height):
            segments = [before, *chain.from_iterable(face[line] for face in faces), after]
            strips.append(
                Strip(Segment.simplify(filter(_has_text, segments))).adjust_cell_length(width, text)
            )
    return strips + [Strip([Segment(" " * width, text)], width)] * (height - len(strips))


def _has_text(segment: Segment) -> bool:
    return bool(segment.text)
