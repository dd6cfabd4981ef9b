"""How the cells of a map look: the sign, the number and the tint of each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache, partial
from itertools import chain
from typing import Final, NamedTuple

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.panels.grid.draft_cells import DraftCell, draw_draft_cell
from rl_tui.screen.panels.grid.form import LEAST_ARROWS, CellForm
from rl_tui.screen.panels.grid.map import PLAIN, CellContent, CellExtra, Sign
from rl_tui.screen.panels.grid.rewards import CellReward
from rl_tui.screen.panels.grid.trail import put_trace
from rl_tui.screen.panels.world.edit_marks import put_marks
from rl_tui.screen.panels.world.shown_policy import fraction, off_way_style
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import CellKind

SEVERAL: Final = "*"  # in place of the arrows where they do not fit
START: Final = "S"
_MOST_KEPT: Final = 20_000
MOST_ROWS: Final = 512

_ALIVE: Final = (CellKind.FLOOR, CellKind.START)

Drawn = list[list[Segment]]


def strips_of_row(cells: Sequence[Drawn], left: int, width: int, style: Style) -> tuple[Strip, ...]:
    """Return the strips of ``width`` characters for a row of ``cells``, which begins at column ``left``."""
    before = Segment(" " * left, style)
    strips = []
    for lines in zip(*cells, strict=True):
        segments = [before, *chain.from_iterable(lines)]
        taken = sum(each.cell_length for each in segments)
        segments.append(Segment(" " * max(0, width - taken), style))
        inked = Segment.simplify(each for each in segments if each.text)
        strips.append(Strip(inked).adjust_cell_length(width, style))
    return tuple(strips)


class Face(NamedTuple):
    """All that makes a cell look as it does; ``text`` is its value, None where nothing can be done.

    ``stops`` marks a breakpoint, ``cursor`` the cell the cursor stands on, ``differs`` greedy actions that
    are others in the lane beside this one. ``is_tie`` tells several signs from one of two characters.
    """

    kind: CellKind
    agent: bool
    text: str | None
    signs: str
    style: Style
    reward: CellReward | None = None
    stops: bool = False
    cursor: bool = False
    differs: bool = False
    extra: CellExtra | None = None
    is_tie: bool = False


class CellArtist:
    """Draws cells of one form. What looks the same is drawn once.

    Without a table of the world many states may be impossible: the zero of one that was never visited is
    written as a dot.
    """

    def __init__(self, look: Look, form: CellForm, *, has_table: bool) -> None:
        self.look = look
        self.form = form
        palette, glyphs = look.palette, look.glyphs
        self._idle_styles = {
            CellKind.HOLE: palette.hole,
            CellKind.GOAL: palette.goal,
            CellKind.WALL: palette.wall,
            CellKind.CLIFF: palette.cliff,
        }
        self._idle_signs = {
            CellKind.HOLE: glyphs.hole,
            CellKind.GOAL: glyphs.goal,
            CellKind.CLIFF: glyphs.cliff,
        }
        self._has_table = has_table
        # what looks the same is drawn once
        self.strips = lru_cache(MOST_ROWS)(self._strips)
        self.drawn = lru_cache(_MOST_KEPT)(partial(_drawn, form=form, look=look))
        self._text = lru_cache(_MOST_KEPT)(partial(value_text, look=look))
        self._signs = lru_cache(_MOST_KEPT)(partial(_signs, look=look))

    def _strips(self, faces: tuple[Face, ...], left: int, width: int) -> tuple[Strip, ...]:
        """Return a row of cells with these ``faces``."""
        return strips_of_row([self.drawn(face) for face in faces], left, width, self.look.palette.text)

    def shown_reward(self, reward: CellReward) -> str:
        """Return how a cell without other signs shows what it pays."""
        # a single row has one character for it, two rows have arrows beside it
        return reward_text(reward, self.form.width if self.form.height > 2 else 1, self.look)

    def face(self, cell: CellContent, low: float, high: float, number_form: NumberForm) -> Face:
        """Return how ``cell`` looks, tinted by its value from ``low`` to ``high``."""
        kind, agent, value, known, greedy, reward, stops, cursor, differs, _, extra = cell
        palette = self.look.palette
        if value is None:
            style = self._idle_styles.get(kind, palette.dim)
            if extra is not None and extra.draft is not None and kind in _ALIVE:
                style = palette.start if kind is CellKind.START else palette.text
            return Face(
                kind, agent, None, self._idle_signs.get(kind, ""), style, None, stops, cursor, differs, extra
            )
        style = value_style(value, low, high, self.look) if known else palette.unvisited
        is_dot = not known and value == 0.0 and not self._has_table
        text = self.look.glyphs.stay if is_dot else self._text(value, number_form)
        signs, is_tie = self._signs(greedy), len(greedy) > 1
        return Face(kind, agent, text, signs, style, reward, stops, cursor, differs, extra, is_tie)


def _drawn(face: Face, form: CellForm, look: Look) -> Drawn:
    canvas = Canvas(form.width, form.height, look.palette.text)
    _draw_cell(canvas, face, form, look)
    return [list(strip) for strip in canvas.strips()]


def _signs(greedy: tuple[Sign, ...], look: Look) -> str:
    direction = look.glyphs.direction
    return "".join(direction(each) if isinstance(each, tuple) else each for each in greedy)


def _draw_cell(canvas: Canvas, face: Face, form: CellForm, look: Look) -> None:
    if face.cursor and form.height == 1:
        face = face._replace(style=look.palette.focus)
    extra = face.extra or PLAIN
    if extra.draft is not None:
        _draw_draft(canvas, face, extra.draft, form, look)
        return
    if extra.name:
        face = _named(face, extra.name, form)
    filling = _filling(face, look)
    for row in range(form.height):
        canvas.put(0, row, filling * form.width, face.style)
    if face.cursor:
        canvas.put(0, _value_row(form), " " * form.width, look.palette.focus)
    if face.kind is CellKind.WALL:
        return
    if not form.has_values or (form.height == 1 and face.text is None):
        _draw_signs_alone(canvas, face, form, look)
    elif form.height == 1:
        _draw_small(canvas, face, form, look)
    else:
        _draw_large(canvas, face, form, look)
    if form.height == 1:
        style = differing_style(face.style) if face.differs and not face.signs else face.style
        _put_name(canvas, form.width - len(extra.name), face, style)
    if extra.trace is not None:
        put_trace(canvas, extra.trace, look)


def _draw_draft(canvas: Canvas, face: Face, draft: DraftCell, form: CellForm, look: Look) -> None:
    """Draw what stands in a cell that is not in force yet, the agent before it, without values."""
    ways = _signs(draft.ways, look)
    label = _mark(face, look) + (face.signs or (ways if len(ways) < form.width else SEVERAL))
    pays = CellReward(draft.pays, draft.pays > 0.0) if draft.pays else None
    reward = "" if pays is None else reward_text(pays, form.width, look)
    row = max(0, _value_row(form) - 1)
    draw_draft_cell(canvas, label, reward, face.style, look, is_wall=face.kind is CellKind.WALL, row=row)
    if face.cursor and form.height > 1:
        canvas.restyle(0, _value_row(form), form.width, look.palette.focus)


def _filling(face: Face, look: Look) -> str:
    if face.kind is CellKind.WALL:
        return look.glyphs.wall
    is_floor = face.kind in _ALIVE
    return look.glyphs.unreached if is_floor and not (face.extra or PLAIN).is_reached else " "


def _draw_large(canvas: Canvas, face: Face, form: CellForm, look: Look) -> None:
    """Draw arrows above the value, the mark beside the arrows, what the cell pays in the corner."""
    row = _value_row(form) - 1
    signs = _fitting(face, form.most_signs, form.width - 2)
    start = (form.width - max(1, len(signs))) // 2
    after = start + max(1, len(signs))
    has_room = after < form.width - (face.stops and row == 0)
    _put_signs(canvas, start, row, signs, after if has_room else None, face, look)
    mark = start - (2 if form.width >= 10 else 1)
    _put_mark(canvas, mark, row, face, look)
    named = _put_name(canvas, 0, face, face.style)
    room = form.width if row else mark if _mark(face, look) else start
    put_reward(canvas, named, 0, room - named, face.reward, look)
    if face.text is not None:
        style = look.palette.focus if face.cursor else face.style
        canvas.put((form.width - len(face.text)) // 2, row + 1, face.text, style)
    if face.stops:
        canvas.put(form.width - 1, 0, look.glyphs.breakpoint, look.palette.breakpoint)
    put_marks(canvas, (face.extra or PLAIN).marks, (after + face.differs, row), look)


def _named(face: Face, name: str, form: CellForm) -> Face:
    """Return ``face`` with its name: in a corner, in place of the value, or in place of the arrows."""
    extra = face.extra or PLAIN
    if len(name) > form.longest_name:
        return face._replace(extra=extra._replace(name=""))
    if form.has_corner:
        return face._replace(extra=extra._replace(name=name.strip()))
    if face.text is None:
        return face
    if form.has_values:
        return face._replace(text=name, extra=extra._replace(name=""))
    return face if len(name) <= form.width - LEAST_ARROWS else face._replace(signs="")


def _put_name(canvas: Canvas, x: int, face: Face, style: Style) -> int:
    """Put the name of the state into the first row, if there is room; return what it takes with a blank."""
    name, is_reached = (face.extra or PLAIN).name, (face.extra or PLAIN).is_reached
    is_free = canvas.is_blank(x, 0, min(len(name) + 1, canvas.width - x)) or not is_reached
    if not name or not is_free:
        return 0
    canvas.put(x, 0, name, style)
    return len(name) + 1


def _value_row(form: CellForm) -> int:
    """Return the row of the value, which is where the cursor is drawn."""
    return (form.height - 1) // 2 + (form.height > 1)


def _draw_signs_alone(canvas: Canvas, face: Face, form: CellForm, look: Look) -> None:
    """Draw mark and arrow, before a name at the right or in place of it."""
    middle, end = max(1, (form.width - 1) // 2), form.width - len((face.extra or PLAIN).name)
    signs = _fitting(face, 1, end - middle)
    after = middle + max(1, len(signs))
    _put_signs(canvas, middle, 0, signs, after if after < end else None, face, look)
    _put_mark_or_reward(canvas, middle - 1, face, look)


def _draw_small(canvas: Canvas, face: Face, form: CellForm, look: Look) -> None:
    """Draw mark, arrows and value in one row."""
    text = (face.text or "").rjust(form.digits)
    has_mark = _mark(face, look) or face.reward or face.stops or any((face.extra or PLAIN).marks)
    mark = 1 if has_mark else 0
    # a blank before it all, so that neighbours keep apart without colours too
    end = form.width - form.digits
    signs = _fitting(face, max(1, form.most_signs - mark), end - mark)
    canvas.put(end, 0, text, face.style)
    before = end - max(1, len(signs)) - 1
    beside = before if not mark else None if signs else end - 1
    _put_signs(canvas, end - len(signs), 0, signs, beside, face, look)
    _put_mark_or_reward(canvas, before, face, look)


def value_text(x: float, number_form: NumberForm, look: Look) -> str:
    """Return a value in the form of all; a dash for NaN."""
    return numbers.missing(look.glyphs) if math.isnan(x) else number_form.text(x, look.glyphs)


def value_style(x: float, low: float, high: float, look: Look) -> Style:
    """Return the tint of a value from ``low`` to ``high``; of NaN that of no value."""
    return look.palette.text if math.isnan(x) else look.palette.value(fraction(x, low, high))


def _fitting(face: Face, most: int, room: int) -> str:
    """Return the arrows of the greedy actions, or what stands in a cell where nothing can be done.

    Of several actions there may be ``most`` characters, of one as many as ``room`` is there.
    """
    return face.signs if len(face.signs) <= (most if face.is_tie else max(1, room)) else SEVERAL


def _sign_style(face: Face, look: Look) -> Style:
    if (face.extra or PLAIN).is_off_way:
        return off_way_style(face.style, look)
    return face.style if face.text is None else face.style + Style(bold=True)


def _put_signs(
    canvas: Canvas, x: int, y: int, signs: str, beside: int | None, face: Face, look: Look
) -> None:
    """Put the arrows, and ``beside`` them whether they differ; where that is None they are reversed then."""
    style = _sign_style(face, look)
    if face.differs and beside is None:
        style = differing_style(style)
    elif face.differs and beside is not None:
        canvas.put(beside, y, look.glyphs.differs, style)
    canvas.put(x, y, signs, style)


def differing_style(style: Style) -> Style:
    """Return ``style`` of an arrow for one that differs, where there is no room for a sign beside it."""
    return style + Style(reverse=not style.reverse)


def mark_of(kind: CellKind, agent: bool, way: str, look: Look) -> str:
    """Return what marks a cell of ``kind``, in which the ``agent`` is or not, or the only ``way`` out of it.

    Empty where nothing does.
    """
    if agent:
        return look.glyphs.agent
    return START if kind is CellKind.START else way


def _mark(face: Face, look: Look) -> str:
    return mark_of(face.kind, face.agent, (face.extra or PLAIN).way, look)


def _put_mark(canvas: Canvas, x: int, y: int, face: Face, look: Look) -> None:
    mark = _mark(face, look)
    if mark:
        canvas.put(x, y, mark, face.style + (look.palette.agent if face.agent else look.palette.start))


def _put_mark_or_reward(canvas: Canvas, x: int, face: Face, look: Look) -> None:
    """Put the mark, or where there is none that of the last edit, or the sign of what the cell pays.

    The agent on a breakpoint has the colour of one.
    """
    edit = next((face.extra or PLAIN).marks.signs(look), None)
    if face.stops:
        canvas.put(x, 0, look.glyphs.agent if face.agent else look.glyphs.breakpoint, look.palette.breakpoint)
    elif _mark(face, look):
        _put_mark(canvas, x, 0, face, look)
        if edit is not None and canvas.is_blank(x - 1, 0, 1):
            canvas.put(x - 1, 0, *edit)
    elif edit is not None:
        canvas.put(x, 0, *edit)
    else:
        put_reward(canvas, x, 0, 1, face.reward, look)


def put_reward(canvas: Canvas, x: int, y: int, room: int, reward: CellReward | None, look: Look) -> None:
    """Put what a cell pays; where it does not fit, whether that is more or less than usual.

    It stands on the background of the panel, so that it is seen on every tint.
    """
    if reward is None or room < 1:
        return
    canvas.put(x, y, reward_text(reward, room, look), reward_style(reward, look))


def reward_text(reward: CellReward, room: int, look: Look) -> str:
    """Return what a cell pays in ``room`` characters; where it does not fit, whether that is much."""
    text = ("+" if reward.reward > 0.0 else "") + numbers.brief(reward.reward, look.glyphs, decimals=2)
    if len(text) <= room:
        return text
    return "+" if reward.good else look.glyphs.minus


def reward_style(reward: CellReward, look: Look) -> Style:
    """Return the style of what a cell pays."""
    return (look.palette.good if reward.good else look.palette.bad) + Style(bold=True)
