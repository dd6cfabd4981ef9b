"""Drawn cells that are not active yet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.grid.moves import STEPS

if TYPE_CHECKING:
    from rich.style import Style

    from rl_tui.live.world_editor import EditorView
    from rl_tui.screen.draw.block_signs import Sign
    from rl_tui.screen.draw.canvas import Canvas
    from rl_tui.screen.panels.grid.map import MapPart
    from rl_tui.screen.theme.look import Look
    from rl_tui.worlds.grid.map import LegendEntry

UNKNOWN: Final = "?"
"""Label of a character that the legend does not explain."""
_APART: Final = 5  # columns of a cell from which its sign has blanks around it


class DraftCell(NamedTuple):
    """Kind, restricted exits, and reward."""

    kind: CellKind
    ways: tuple[Sign, ...] = ()
    pays: float = 0.0


def draft_cells(editor: EditorView, grid: Grid, part: MapPart) -> dict[int, DraftCell]:
    """Return the drafted cells that differ, without new rows and columns."""
    draft, base = editor.draft, editor.base
    if draft is base or not isinstance(draft, GridDraft) or not isinstance(base, GridDraft):
        return {}
    if (base.rows, base.columns) != (grid.rows, grid.columns):
        return {}
    row_in = _places(base.row_ids, draft.row_ids, range(part.top, part.top + part.rows))
    column_in = _places(base.column_ids, draft.column_ids, range(part.left, part.left + part.columns))
    legend, before = draft.legend, base.legend
    same = {each for each in legend if legend[each] == before.get(each)}
    found = {}
    for row, its_row in row_in.items():
        line, was = draft.lines[its_row], base.lines[row]
        for column, its_column in column_in.items():
            character = line[its_column]
            if character != was[column] or character not in same:
                found[row * grid.columns + column] = _cell(legend.get(character))
    return found


def _places(base: tuple[int, ...], draft: tuple[int, ...], lines: range) -> Mapping[int, int]:
    if base == draft:
        return {line: line for line in lines}
    place_of = {each: place for place, each in enumerate(draft)}
    return {line: place_of[base[line]] for line in lines if base[line] in place_of}


def _cell(entry: LegendEntry | None) -> DraftCell:
    if entry is None:
        return DraftCell(CellKind.FLOOR, (UNKNOWN,))
    return DraftCell(entry.kind, tuple(STEPS[name] for name in entry.only or ()), entry.reward or 0.0)


def draw_draft_cell(
    canvas: Canvas, label: str, reward: str, style: Style, look: Look, *, is_wall: bool, row: int
) -> None:
    """Hatch a cell, with ``label`` and reward."""
    for each in range(canvas.height):
        canvas.put(0, each, look.glyphs.drafted * canvas.width, look.palette.dim)
        for column in range(0, canvas.width * is_wall, 2):
            canvas.put(column, each, look.glyphs.wall, style)
    if canvas.height == 1:
        beside = f"{label}{reward}"
        _put_middle(canvas, beside if len(beside) <= canvas.width else label, row, style)
        return
    _put_middle(canvas, label or reward, row, style)
    if label:
        _put_middle(canvas, reward, row + 1, style)


def _put_middle(canvas: Canvas, text: str, row: int, style: Style) -> None:
    if text:
        text = f" {text} " if len(text) + 2 <= canvas.width and canvas.width >= _APART else text
        canvas.put((canvas.width - len(text)) // 2, row, text, style)
