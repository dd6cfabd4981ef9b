"""What is marked while one draws: states whose best actions turned, and those without a way to an end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from rich.style import Style

from rl_tui.live.world_editor import EditorView
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.theme.look import Look


class EditMarks(NamedTuple):
    """What is to be marked of a state: no way leads from it to an end; the last edit turned what is best."""

    is_endless: bool = False
    is_turned: bool = False

    def signs(self, look: Look) -> Iterator[tuple[str, Style]]:
        """Yield the signs, what is worse first, on the background of the panel: seen on every tint."""
        bold = Style(bold=True)
        if self.is_endless:
            yield look.glyphs.endless, look.palette.bad + bold
        if self.is_turned:
            yield look.glyphs.turned, look.palette.you + bold


UNMARKED = EditMarks()


def marks_of(editor: EditorView, state: int) -> EditMarks:
    """Return the marks of ``state``."""
    return EditMarks(state in editor.endless, state in editor.turned)


def put_marks(canvas: Canvas, marks: EditMarks, wish: tuple[int, int], look: Look) -> None:
    """Put the signs where a cell is empty: at the column and row ``wish``, in a corner, or in the middle."""
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
    """Yield the signs of a legend, as far as there are any: what is drawn and not in force, and the marks."""
    if editor.draft is not editor.base:
        yield LegendSign(look.glyphs.drafted, "drawn", look.palette.dim)
    yield from mark_signs(editor, look)


def with_signs(titles: Sequence[str], editor: EditorView, look: Look) -> tuple[str, ...]:
    """Return ``titles`` with the signs and what they mean behind them, then without."""
    said = ", ".join(f"{each.sign} {each.meaning}" for each in edit_signs(editor, look))
    return (*(f"{title} · {said}" for title in titles if said), *titles)


def mark_signs(editor: EditorView, look: Look) -> Iterator[LegendSign]:
    """Yield the signs of the marks alone."""
    if editor.endless:
        ((sign, style),) = EditMarks(is_endless=True).signs(look)
        yield LegendSign(sign, "no end", style, "no path to a terminal state")
    if editor.turned:
        ((sign, style),) = EditMarks(is_turned=True).signs(look)
        yield LegendSign(sign, "changed", style, "another action is optimal now")
