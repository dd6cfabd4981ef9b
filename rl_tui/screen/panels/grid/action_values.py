"""Map cells with Q of every action."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, partial
from typing import Final, NamedTuple

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from rl_tui.screen.draw.block_signs import Sign
from rl_tui.screen.draw.canvas import Canvas, Drawn, strips_of_row
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.action_form import FRAME, ActionForm, Places, side_of
from rl_tui.screen.panels.grid.cell import Face
from rl_tui.screen.panels.grid.cells import MOST_KEPT, MOST_ROWS, CellArtist
from rl_tui.screen.panels.grid.form import LEAST_DIGITS, CellForm
from rl_tui.screen.panels.grid.map import PLAIN, ActionValue, CellContent, CellExtra, MapPart
from rl_tui.screen.panels.grid.marks import (
    CellReward,
    mark_of,
    put_reward,
    reward_text,
    sign_text,
    value_text,
)
from rl_tui.screen.panels.grid.trail import put_trail
from rl_tui.screen.panels.world.edit_marks import put_marks
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import CellKind

_AROUND_MIDDLE: Final = 5  # columns between the numbers beside the middle, if they fit


class ActionEntry(NamedTuple):
    """One action. ``text``: a dot if new."""

    sign: Sign
    text: str
    style: Style
    is_new: bool
    is_greedy: bool


class ActionFace(NamedTuple):
    """Everything that decides a cell's look. See :class:`CellContent`."""

    kind: CellKind
    agent: bool
    entries: tuple[ActionEntry, ...]
    reward: CellReward | None
    stops: bool
    cursor: bool
    differs: bool
    extra: CellExtra
    field: int


class ActionArtist:
    """Draws cells with Q of every action."""

    def __init__(self, look: Look, form: ActionForm) -> None:
        self.look = look
        self.form = form
        self._idle = CellArtist(look, CellForm(form.width, form.height))  # for cells without values
        # equal rows are drawn once
        self.strips = lru_cache(MOST_ROWS)(self._strips)
        self._drawn = lru_cache(MOST_KEPT)(partial(_drawn, form=form, look=look))
        self._text = lru_cache(MOST_KEPT)(partial(value_text, look=look))

    def shown_reward(self, reward: CellReward) -> str:
        """Write a cell's reward."""
        return reward_text(reward, _reward_room(self.form), self.look)

    def _strips(self, faces: tuple[ActionFace | Face, ...], width: int) -> tuple[Strip, ...]:
        cells = [self._idle.drawn(each) if isinstance(each, Face) else self._drawn(each) for each in faces]
        return strips_of_row(cells, width, self.look.palette.text)

    def face(
        self, cell: CellContent, scale: ValueScale, number_form: NumberForm, leads: Sequence[float]
    ) -> ActionFace | Face:
        """Return a cell's look, actions coloured on ``scale``."""
        if not cell.actions:
            return self._idle.face(cell, scale, number_form, leads)
        field = max(LEAST_DIGITS, number_form.cells)  # steady: the widest number so far
        entries = tuple(self._entry(action, scale, number_form) for action in cell.actions)
        marks = cell.reward, cell.stops, cell.cursor, cell.differs, cell.extra or PLAIN
        return ActionFace(cell.kind, cell.agent, entries, *marks, field)

    def _entry(self, action: ActionValue, scale: ValueScale, number_form: NumberForm) -> ActionEntry:
        palette = self.look.palette
        sign, q, is_new, is_greedy = action
        style = palette.unvisited if is_new else scale.style(q, palette)
        if self.form.places is Places.TINTS:
            text = ""
        else:
            text = self.look.glyphs.untried if is_new and q == 0.0 else self._text(q, number_form)
        return ActionEntry(sign, text, style, is_new, is_greedy)


def _drawn(face: ActionFace, form: ActionForm, look: Look) -> Drawn:
    canvas = Canvas(form.width, form.height, look.palette.text)
    if form.places.is_list:
        _draw_list(canvas, face, form, look)
    elif form.places is Places.TINTS:
        _draw_tints(canvas, face, form, look)
    else:
        _draw_sides(canvas, face, form._replace(digits=face.field), look)
    put_marks(canvas, face.extra.marks, (form.width - 1, 0), look)
    put_trail(canvas, face.extra.trace, look, inner=form.width, ink=Style.null())
    return [list(strip) for strip in canvas.strips()]


class _Block(NamedTuple):
    left: int
    centre: int
    right: int
    end: int
    top: int
    middle: int


def _block(form: ActionForm) -> _Block:
    digits = form.digits
    rows = 5 if form.places is Places.SPREAD_KEYPAD else 3
    between = digits + FRAME + 2 if form.places is Places.KEYPAD else _AROUND_MIDDLE
    least = 3 * (digits + FRAME) if form.places is Places.KEYPAD else 2 * (digits + FRAME) + 1
    room = form.width - (form.width > least)
    width = min(room, 2 * (digits + FRAME) + between)
    start, top = (room - width) // 2, (form.height - rows) // 2
    right = start + width - digits - 1
    return _Block(start + 1, start + (width - digits) // 2, right, start + width, top, top + rows // 2)


def _draw_sides(canvas: Canvas, face: ActionFace, form: ActionForm, look: Look) -> None:
    block, others = _block(form), 0
    for entry in face.entries:
        side = side_of(entry.sign)
        if side is None:
            row = block.middle - (len(face.entries) > 1) + others
            canvas.put(block.centre - 2, row, sign_text(entry.sign, look), look.palette.dim)
            _put_number(canvas, block.centre, row, entry, form, look)
            others += 1
            continue
        down, across = side
        column = (block.left, block.centre, block.right)[across + 1]
        for row, first, last in _parts_of_side(block, side, form):
            canvas.put(first, row, " " * (last - first), entry.style)
        steps = 2 if form.places is Places.SPREAD_KEYPAD and across else 1
        _put_number(canvas, column, block.middle + down * steps, entry, form, look)
    _put_marks_amid(canvas, face, form, block, is_taken=others > 0, look=look)


def _parts_of_side(block: _Block, side: tuple[int, int], form: ActionForm) -> list[tuple[int, int, int]]:
    """Return row, first column, and last column + 1 of each part."""
    down, across = side
    row, digits = block.middle + down, form.digits
    is_tight = block.end == form.width
    start, end = block.left - 1 + is_tight, block.end - is_tight
    if form.places is Places.KEYPAD:
        first = (block.left, block.centre, block.right)[across + 1] - 1
        return [(row, max(start, first), min(end, first + digits + FRAME))]
    if form.places is Places.SPREAD_KEYPAD:
        middle = (start + end) // 2
        if not across:
            return [(row, start, end)]
        if down:
            return [(row + down, start, middle) if across < 0 else (row + down, middle, end)]
    first, last = block.centre - 1, block.centre + digits + 1
    if not across:
        return [(row, first, last)]
    corners = () if form.places is Places.SPREAD_KEYPAD else (row - 1, row + 1)
    if across < 0:
        return [(row, start, block.left + digits + 1), *((each, start, first) for each in corners)]
    return [(row, block.right - 1, end), *((each, last, end) for each in corners)]


def _put_marks_amid(
    canvas: Canvas, face: ActionFace, form: ActionForm, block: _Block, *, is_taken: bool, look: Look
) -> None:
    first, last = block.left + form.digits + 1, block.right - 2
    if is_taken:
        first, last = block.left - 1, block.left - 1
    if face.cursor:
        canvas.put(first, block.middle, " " * (last - first + 1), look.palette.focus)
    centre, is_wide = (first + last) // 2, last - first >= 2
    _put_mark(canvas, centre, block.middle, face, look, beside=centre - 1 if is_wide else None)
    corner = block.top + (form.places is Places.SPREAD_KEYPAD)
    if face.differs:
        here = (centre + 1, block.middle) if is_wide else (block.end - 1, corner)
        canvas.put(*here, look.glyphs.differs, look.palette.text)
    if form.places is not Places.KEYPAD:
        _put_name(canvas, block.left - 1, corner, face, form)
        reward = 2 * block.middle - corner if face.extra.name else corner
        put_reward(canvas, block.left - 1, reward, _reward_room(form), face.reward, look)
    elif not _has_mark(face):
        start = first + (last + 1 - first - len(face.extra.name)) // 2
        _put_name(canvas, start, block.middle, face, form)
        put_reward(
            canvas, centre, block.middle, _reward_room(form) * (not face.extra.name), face.reward, look
        )


def _reward_room(form: ActionForm) -> int:
    if form.places in (Places.CROSS, Places.SPREAD_KEYPAD):
        block = _block(form)
        return block.centre - block.left - 1
    return max(1, form.width // 2 - 2) if form.has_header else 1


def name_room(form: ActionForm) -> int:
    """Return the columns for a state's name."""
    match form.places:
        case Places.CROSS | Places.SPREAD_KEYPAD:
            return _reward_room(form)
        case Places.KEYPAD:
            block = _block(form)
            return block.right - block.left - form.digits - 2 - 2
        case Places.TINTS:
            return 0 if form.most_actions > 4 else _edge(form, diagonals=False)
    if form.has_header:
        return form.width // 2 - 1
    return form.width if form.places is Places.TWO_LISTS and form.height > form.list_rows else 0


def _put_name(canvas: Canvas, x: int, y: int, face: ActionFace, form: ActionForm) -> None:
    if len(face.extra.name) <= name_room(form):  # names have equal width, so all fit or none
        canvas.put_over(x, y, face.extra.name.strip(), Style.null())


def _draw_list(canvas: Canvas, face: ActionFace, form: ActionForm, look: Look) -> None:
    width = form.sign_width + form.digits + (FRAME if form.is_framed else 1)
    if form.places is Places.LIST:
        start, blank = form.width - form.entry_width, form.entry_width - width
        start += blank // 2
    else:
        start, blank = 0, form.width - 2 * width - 1
    for number, entry in enumerate(face.entries):
        column, row = divmod(number, form.list_rows)
        x, y = start + column * (width + 1), row + form.has_header
        if blank > 0 and form.places is Places.TWO_LISTS:  # binds both lists to one cell
            canvas.put(x, y, " " * width, entry.style)
            sign_style = entry.style + Style(bold=entry.is_greedy)
        else:
            sign_style = look.palette.best if entry.is_greedy else look.palette.dim
        canvas.put(x, y, sign_text(entry.sign, look).rjust(form.sign_width), sign_style)
        _put_number(canvas, x + form.sign_width + form.is_framed, y, entry, form, look)
    _put_marks_of_list(canvas, face, form, 0 if form.places is Places.LIST else width, look)


def _put_marks_of_list(canvas: Canvas, face: ActionFace, form: ActionForm, column: int, look: Look) -> None:
    palette = look.palette
    if form.has_header:
        centre = form.width // 2
        if face.cursor:
            canvas.put(0, 0, " " * form.width, palette.focus)
        _put_mark(canvas, centre, 0, face, look, beside=centre - 1)
        if face.differs:
            canvas.put(centre + 1, 0, look.glyphs.differs, palette.text)
        _put_name(canvas, 0, 0, face, form)
        put_reward(canvas, 0, 0, _reward_room(form) * (not face.extra.name), face.reward, look)
        return
    if face.cursor:
        for row in range(form.height):
            canvas.put(column, row, " ", palette.focus)
    _put_name(canvas, 0, form.height - 1, face, form)
    _put_mark(canvas, column, 0, face, look)
    if form.height > 1 or not _has_mark(face):
        put_reward(canvas, column, min(1, form.height - 1), 1, face.reward, look)
    if face.differs:
        has_row = form.height > 2 or (form.height > 1 and face.reward is None) or not _has_mark(face)
        if has_row:
            canvas.put(column, form.height - 1, look.glyphs.differs, palette.text)


def _draw_tints(canvas: Canvas, face: ActionFace, form: ActionForm, look: Look) -> None:
    diagonals = any(all(side) for each in face.entries if (side := side_of(each.sign)) is not None)
    width, edge = form.tinted_width, _edge(form, diagonals)
    columns = ((0, edge), (edge, width - edge), (width - edge, width))
    others = [entry for entry in face.entries if side_of(entry.sign) is None]
    for entry in face.entries:
        side = side_of(entry.sign)
        if side is None:
            place = others.index(entry)
            first, last = place * width // len(others), (place + 1) * width // len(others)
            rows = range(form.height)
        else:
            first, last = columns[side[1] + 1]
            rows = _rows_of_side(side, form.height, diagonals)
        _fill(canvas, first, last, rows, entry, _row_of_sign(side, rows), look)
    _put_name(canvas, 0, 0, face, form)
    _put_marks_on_tints(canvas, face, form, edge, look)


def _edge(form: ActionForm, diagonals: bool) -> int:
    width, marks = form.tinted_width, 1 if form.height == 2 else 0
    return max(2, width // 3) if diagonals else max(1, (width - marks) // 3)


def _rows_of_side(side: tuple[int, int], height: int, diagonals: bool) -> range:
    if side[0] < 0:
        return range(height // 2 if height == 2 else 1)
    if side[0] > 0:
        return range(height - 1, height)
    return range(1, height - 1) if diagonals else range(height)


def _row_of_sign(side: tuple[int, int] | None, rows: range) -> int:
    return rows[len(rows) // 2] if side is None or not side[0] else rows[0]


def _fill(
    canvas: Canvas, first: int, last: int, rows: range, entry: ActionEntry, row: int, look: Look
) -> None:
    for each in rows:
        canvas.put(first, each, " " * (last - first), entry.style)
    if entry.is_greedy:
        sign = sign_text(entry.sign, look)
        canvas.put((first + last - len(sign)) // 2, row, sign, entry.style + Style(bold=True))
    elif entry.is_new:
        canvas.put((first + last - 1) // 2, row, look.glyphs.untried, entry.style)


def _put_marks_on_tints(canvas: Canvas, face: ActionFace, form: ActionForm, edge: int, look: Look) -> None:
    low, width = form.height == 2, form.tinted_width
    has_letter = any(side_of(entry.sign) is None for entry in face.entries)
    centre, row = (width - 1) // 2 - has_letter, 0 if low else form.height // 2
    left, right = centre - 1, centre + 1
    if face.cursor:
        for x in (left, right) if low else range(edge, width - edge):
            canvas.put(x, row, " ", look.palette.focus)
    _put_mark(canvas, left if low else centre, row, face, look)
    if face.differs:
        canvas.put(right, row, look.glyphs.differs, look.palette.text)
    if low:
        put_reward(canvas, left, 1, 1, face.reward, look)
    elif not _has_mark(face):
        put_reward(canvas, centre, row, 1, face.reward, look)


def _put_number(canvas: Canvas, x: int, y: int, entry: ActionEntry, form: ActionForm, look: Look) -> None:
    digits, glyphs, greedy = form.digits, look.glyphs, look.palette.best
    number = entry.text.center(digits) if entry.text == glyphs.untried else entry.text.rjust(digits)
    canvas.put(x, y, number, entry.style)
    if entry.is_greedy and form.is_framed:
        canvas.put(x - 1, y, glyphs.mark_left, greedy)
        canvas.put(x + digits, y, glyphs.mark_right, greedy)
    elif entry.is_greedy:
        canvas.put(x + digits, y, glyphs.mark_after, greedy)


def _put_mark(
    canvas: Canvas, x: int, y: int, face: ActionFace, look: Look, beside: int | None = None
) -> None:
    palette, text = look.palette, mark_of(face.kind, face.agent, face.extra.way, look)
    if face.stops and (beside is None or not text):
        canvas.put(x, y, look.glyphs.agent if face.agent else look.glyphs.breakpoint, palette.breakpoint)
        return
    if face.stops and beside is not None:
        canvas.put(beside, y, look.glyphs.breakpoint, palette.breakpoint)
    if text:
        style = palette.agent if face.agent else palette.start
        canvas.put(x, y, text, (palette.focus if face.cursor else palette.text) + style)


def _has_mark(face: ActionFace) -> bool:
    return face.agent or face.stops or face.kind is CellKind.START or bool(face.extra.way)


# Rows of cells as text


def draw_grid(
    cells: Sequence[CellContent],
    artist: CellArtist | ActionArtist,
    number_form: NumberForm,
    scale: ValueScale,
    leads: Sequence[float],
    part: MapPart,
    width: int,
    height: int,
) -> list[Strip]:
    """Draw the cells of ``part``. ``leads``: steps of a greedy action's colour."""
    text = artist.look.palette.text
    faces = [artist.face(cell, scale, number_form, leads) for cell in cells]
    blank, strips = Strip([Segment(" " * width, text)], width), list[Strip]()
    for first in range(0, len(faces), part.columns):
        strips += artist.strips(tuple(faces[first : first + part.columns]), width)
    return strips + [blank] * (height - len(strips))
