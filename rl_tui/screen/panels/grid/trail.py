"""The trail of an episode on a map: where the agent was, the longer ago the fainter, and where it slipped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.style import Style

from rl_tui.runs.timeline.trail import Trail
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.worlds.drawing import Grid

if TYPE_CHECKING:
    from rl_tui.screen.draw.canvas import Canvas
    from rl_tui.screen.panels.grid.map import Sign
    from rl_tui.screen.theme.look import Look

_NEW: Final = 4
_RECENT: Final = 16
"""So many steps ago a cell that was left is no longer new, no longer recent."""


class Trace(NamedTuple):
    """What the trail leaves in a cell, by the step on which the agent left it last.

    ``grade`` is 3 for the newest steps, 1 for old ones, and 0 in the cell of the agent. ``meant`` is the
    action that was chosen there where another one happened, as its direction or the first letter of its name.
    """

    grade: int
    meant: Sign | None


def traces(trail: Trail, grid: Grid, signs: tuple[Sign, ...]) -> dict[int, Trace]:
    """Return what ``trail`` leaves in each cell it went through; ``signs`` are those of the actions.

    In the cell of the agent itself that is only the last step, if it slipped and led nowhere.
    """
    if not trail:
        return {}
    newest, here = trail[-1], int(grid.cell_of_state[trail[-1].next_state])
    left = {int(grid.cell_of_state[each.state]): each for each in trail}
    found = {}
    for cell, each in left.items():
        meant = signs[each.action] if each.slipped else None
        if cell != here:
            age = newest.step - each.step
            found[cell] = Trace(3 if age < _NEW else 2 if age < _RECENT else 1, meant)
        elif each is newest and meant is not None:
            found[cell] = Trace(0, meant)
    return found


def put_trace(canvas: Canvas, trace: Trace, look: Look, *, says_meant: bool = True) -> None:
    """Put what the trail left where a cell is empty: in a corner, at best by itself; of one row on the left.

    A slip is a sign of its own, with the direction that was meant where there is room, if it ``says_meant``.
    Where a cell has no room at all, its lower row is underlined.
    """
    style = look.palette.bad if trace.meant is not None else _STYLES[trace.grade]
    rows = range(canvas.height - 1, -1, -1)
    if says_meant and trace.meant is not None and canvas.height > 1:
        text = slip_text(trace.meant, look)
        for row in rows:
            x = canvas.width - len(text)
            if canvas.is_blank(x - 1, row, len(text) + 1):
                canvas.put(x, row, text, style)
                return
    place = _free_place(canvas)
    if place is None:
        canvas.restyle(0, canvas.height - 1, canvas.width, _UNDERLINED)
    elif trace.meant is not None:
        canvas.put(*place, look.glyphs.slip, style)
    else:
        canvas.put_over(*place, look.glyphs.trail if trace.grade > 1 else look.glyphs.trail_old, style)


def _free_place(canvas: Canvas) -> tuple[int, int] | None:
    """Return column and row of an empty character that stays apart from the neighbouring cells."""
    last = canvas.width - 1
    if canvas.height == 1:
        return next(((x, 0) for x in range(max(1, last)) if canvas.is_blank(x, 0, 1)), None)
    corners = [(x, y) for y in range(canvas.height - 1, -1, -1) for x in (last, 0)]
    for length in (2, 1):
        for x, y in corners:
            if canvas.is_blank(x - (length - 1 if x else 0), y, length):
                return x, y
    return None


def trail_signs(left: Iterable[Trace], look: Look, *, is_high: bool) -> Iterator[LegendSign]:
    """Yield the signs of trail and slip, as far as there are any; ``is_high`` cells say what was meant."""
    traces_left = list(left)
    if any(trace.grade for trace in traces_left):
        yield LegendSign(look.glyphs.trail, "trail", look.palette.strong, "trail of the episode")
    meant = next((trace.meant for trace in traces_left if trace.meant is not None), None)
    if meant is not None and is_high:
        yield LegendSign(slip_text(meant, look), "meant, slipped", look.palette.bad)
    elif meant is not None:
        yield LegendSign(look.glyphs.slip, "slip", look.palette.bad, "slipped here")


def slip_text(meant: Sign, look: Look) -> str:
    """Return the sign of a slip with the action that was meant: ``~→``."""
    return look.glyphs.slip + (look.glyphs.direction(meant) if isinstance(meant, tuple) else meant)


_STYLES: Final = (Style.null(), Style.null(), Style.null(), Style(bold=True))
_UNDERLINED: Final = Style(underline=True)
