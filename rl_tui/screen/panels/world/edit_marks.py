"""Marks while editing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from rich.style import Style

from rl_tui.live.world_editor import EditorView
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.theme.look import Look


class EditMarks(NamedTuple):
    """No way to an end, and changed optimal actions."""

    is_endless: bool = False
    is_turned: bool = False

    def signs(self, look: Look) -> Iterator[tuple[str, Style]]:
        """Yield signs, serious ones first, readable on every colour."""
        bold = Style(bold=True)
        if self.is_endless:
            yield look.glyphs.endless, look.palette.bad + bold
        if self.is_turned:
            yield look.glyphs.turned, look.palette.you + bold


UNMARKED = EditMarks()


def marks_of(editor: EditorView, state: int) -> EditMarks:
    """Return a state's marks."""
    return EditMarks(state in editor.endless, state in editor.turned)


def put_marks(canvas: Canvas, marks: EditMarks, wish: tuple[int, int], look: Look) -> None:
    """Put the signs, preferably at ``wish``."""
    signs = list(marks.signs(look))
    if not signs:
        return
    last, bottom = canvas.width - len(signs), canvas.height - 1
    middle = ((x, bottom // 2) for x in range(last, -1, -1))
    places = (wish, (last, 0), (0, 0), (last, bottom), (0, bottom), *middle)
    place = next((each for each in places if each[0] <= last and canvas.is_blank(*each, len(signs))), None)
    if place is not None:
        for x, (sign, style) in enumerate(signs, start=place[0]):
            canvas.put(x, place[1], sign, style)


def edit_signs(editor: EditorView, look: Look) -> Iterator[LegendSign]:
    """Yield the entries of drafts and marks."""
    if editor.draft is not editor.base:
        yield LegendSign(look.glyphs.drafted, "drawn", look.palette.dim)
    yield from mark_signs(editor, look)


def with_signs(titles: Sequence[str], editor: EditorView, look: Look) -> tuple[str, ...]:
    """Return ``titles`` with the signs, then without."""
    said = ", ".join(f"{each.sign} {each.meaning}" for each in edit_signs(editor, look))
    return (*(f"{title} · {said}" for title in titles if said), *titles)


def mark_signs(editor: EditorView, look: Look) -> Iterator[LegendSign]:
    """Yield the entries of marks."""
    if editor.endless:
        ((sign, style),) = EditMarks(is_endless=True).signs(look)
        yield LegendSign(sign, "no end", style, "no path to a terminal state")
    if editor.turned:
        ((sign, style),) = EditMarks(is_turned=True).signs(look)
        yield LegendSign(sign, "changed", style, "another action is optimal now")
