"""Traces of steps on a map."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.style import Style

from rl_tui.screen.draw.block_signs import Direction
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.kit.snapshot_facts import followed_step
from rl_tui.screen.theme.roles import faded, readable

if TYPE_CHECKING:
    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.draw.canvas import Canvas
    from rl_tui.screen.theme.look import Look
    from rl_tui.worlds.drawing import Grid
    from rl_tui.worlds.world import World

_RECENT: Final = 16
"""Steps after which a visited cell is no longer recent."""
_LEAST_BLANK: Final = 2 / 3  # share of a row. In fewer pieces a frame forms no line
_LEAST_PADDED: Final = 11  # columns of a cell
_UNDERLINED: Final = Style(underline=True)


class LastWay(NamedTuple):
    """The last step's direction."""

    direction: Direction
    slipped: bool


class Trace(NamedTuple):
    """Traces of steps in a cell.

    ``error``: sign of the last update's error, None if elsewhere. ``share``: remaining colour of its frame.
    ``is_next``: the open panel's pair may lead here.
    """

    was_here: bool = False
    is_recent: bool = False
    error: int | None = None
    share: float = 1.0
    way: LastWay | None = None
    is_next: bool = False


def subject_traces(
    world: World, grid: Grid, subject: range, next_states: Collection[int]
) -> dict[int, Trace]:
    """Mark the open panel's pair and next states."""
    found = {int(grid.cell_of_state[state]): Trace(is_next=True) for state in next_states}
    if len(subject) == 1:
        cell = int(grid.cell_of_state[world.space.state_of(subject.start)])
        direction = grid.directions[int(world.space.pair_action[subject.start])]
        way = None if direction is None else LastWay(direction, slipped=False)
        found[cell] = Trace(way=way)
    return found


def traces(snapshot: Snapshot, grid: Grid) -> dict[int, Trace]:
    """Return the traces, without the agent's cell."""
    found = {}
    trail, cell_of = snapshot.trail, grid.cell_of_state
    if trail:
        here = int(cell_of[trail[-1].next_state])
        newest = {int(cell_of[each.state]): each.step for each in trail}
        for cell, step in newest.items():
            if cell != here:
                found[cell] = Trace(was_here=True, is_recent=trail[-1].step - step < _RECENT)
    last = followed_step(snapshot)
    if last is not None and last.updated_pair >= 0:
        cell = int(cell_of[snapshot.world.space.state_of(last.updated_pair)])
        found[cell] = found.get(cell, Trace())._replace(error=last.error_sign)
    if last is not None and trail and trail[-1].step == last.step:
        start, end = (divmod(int(cell_of[state]), grid.columns) for state in (last.state, last.next_state))
        direction = end[0] - start[0], end[1] - start[1]
        if any(direction) and max(map(abs, direction)) == 1:
            cell = int(cell_of[last.state])
            found[cell] = found.get(cell, Trace())._replace(way=LastWay(direction, trail[-1].slipped))
    return found


def put_trail(canvas: Canvas, trace: Trace, look: Look, *, inner: int, ink: Style) -> None:
    """Mark an empty corner, or underline a full cell."""
    if not trace.was_here:
        return
    places = [(inner - 1, 0), (0, 0), (inner - 1, canvas.height - 1), (0, canvas.height - 1)]
    if canvas.height == 1:
        places = [(x, 0) for x in range(max(1, inner - 1))]
    place = next((each for each in places if canvas.is_blank(*each, 1)), None)
    if place is None:
        canvas.restyle(0, canvas.height - 1, canvas.width, _UNDERLINED)
    else:
        canvas.put_over(*place, look.glyphs.trail if trace.is_recent else look.glyphs.trail_old, ink)


def trace_colour(trace: Trace, ground: Style, look: Look) -> Style | None:
    """Return the frame's colour for a next state or the error's sign.

    An error's colour has the weight ``share``, the ``ground`` the rest.
    """
    if trace.error is None:
        return look.palette.source_line if trace.is_next else None
    colour = readable(look.palette.error(trace.error), ground)
    if trace.share < 1.0:
        colour += Style(color=faded(ground + colour, trace.share).color)
    return colour


def put_frame(canvas: Canvas, colour: Style, look: Look) -> None:
    """Put a frame on seams and blanks."""
    glyphs = look.glyphs
    for row in range(canvas.height):
        for column, sign in ((0, glyphs.frame[0]), (canvas.width - 1, glyphs.frame[1])):
            if canvas.at(column, row) in f" {glyphs.seam}":
                canvas.put_over(column, row, sign, colour)
    for row, sign in ((0, glyphs.frame[2]), (canvas.height - 1, glyphs.frame[3])):
        free = [x for x in range(1, canvas.width - 1) if canvas.at(x, row) in f" {glyphs.seam}"]
        if canvas.height >= 3 and look.palette.has_shades and len(free) >= _LEAST_BLANK * canvas.width:
            for column in free:
                canvas.put_over(column, row, sign, colour)


def put_way(canvas: Canvas, way: LastWay, number: range, look: Look) -> None:
    """Draw the path on the crossed edge, but not over the ``number`` in the last row."""
    down, right = way.direction
    sign = _way_text(way, look)
    row = 0 if down < 0 else canvas.height - 1 if down else canvas.height // 3
    is_padded = canvas.width >= _LEAST_PADDED and not right
    for text in (f" {sign} ", sign) if is_padded else (sign,):
        # next to the number in the middle
        column = 0 if right < 0 else canvas.width - len(text) - (not right)
        if row < canvas.height - 1 or column >= number.stop or column + len(text) <= number.start:
            _put_whole(canvas, column, row, text, _way_style(way, look))
            return


def _put_whole(canvas: Canvas, column: int, row: int, text: str, style: Style) -> None:
    """Put ``text``, and erase a word that it would cut."""
    cuts = column > 0 and canvas.at(column, row).isalpha()
    x = column - 1
    while cuts and x >= 0 and canvas.at(x, row).isalpha():
        canvas.put_over(x, row, " ", Style.null())
        x -= 1
    canvas.put(column, row, text, style)


def _way_style(way: LastWay, look: Look) -> Style:
    agent = look.palette.agent
    return agent + readable(Style(color=look.palette.bad.color), agent) if way.slipped else agent


def _way_text(way: LastWay, look: Look) -> str:
    glyphs = look.glyphs
    match way.direction:
        case (0, 1):
            return glyphs.track_done + glyphs.head_right
        case (0, -1):
            return glyphs.head_left + glyphs.track_done
        case (1, 0):
            return glyphs.head_down
        case (-1, 0):
            return glyphs.head_up
    return glyphs.direction(way.direction)


def trace_signs(left: dict[int, Trace], ink: Style, look: Look, *, has_ways: bool) -> Iterator[LegendSign]:
    """Yield the signs of trail and slip."""
    if any(trace.was_here for trace in left.values()):
        yield LegendSign(look.glyphs.trail, "trail", ink)
    slips = (trace.way for trace in left.values() if trace.way is not None and trace.way.slipped)
    for way in slips if has_ways else ():
        yield LegendSign(_way_text(way, look), "slipped", _way_style(way, look))
