"""The drawing of one map cell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from rich.style import Style

from rl_tui.screen.draw.block_signs import Direction, Sign, SignName, block_number, block_sign, sign_size
from rl_tui.screen.draw.canvas import Canvas, Drawn
from rl_tui.screen.panels.grid import marks
from rl_tui.screen.panels.grid.draft_cells import DraftCell, draw_draft_cell
from rl_tui.screen.panels.grid.form import LEAST_ARROWS, CellForm
from rl_tui.screen.panels.grid.map import HATCH, PLAIN, CellExtra, Wall
from rl_tui.screen.panels.grid.trail import put_frame, put_trail, put_way, trace_colour
from rl_tui.screen.panels.world.edit_marks import put_marks
from rl_tui.screen.panels.world.shown_policy import off_way_style
from rl_tui.screen.theme.look import Look
from rl_tui.screen.theme.roles import paled
from rl_tui.worlds.drawing import CellKind

NO_VALUE: Final = "0"
_LEAST_ARROW: Final = 2  # columns and rows of a block arrow
_LEAST_FRAMED: Final = (4, 2)  # columns and rows of a cell
_LEAST_APART: Final = 4  # columns of a cell whose signs do not touch
_START_WORD: Final = "start"
_CORNER: Final = 3  # columns of the agent in a corner
_WITH_PLATE: Final = 7  # columns of a cell whose agent has a plate
_BOLD: Final = Style(bold=True)
_REVERSE: Final = Style(reverse=True)

_ALIVE: Final = (CellKind.FLOOR, CellKind.START)


class Face(NamedTuple):
    """Everything that decides a cell's look.

    ``greedy``: empty if all actions are equal or unknown. ``lead``: advantage of the greedy action, up to
    ``MOST_LEAD``. ``differs``: the second run has other greedy actions.
    """

    kind: CellKind
    agent: bool
    text: str | None
    greedy: tuple[Sign, ...]
    style: Style
    lead: int = marks.MOST_LEAD
    reward: marks.CellReward | None = None
    stops: bool = False
    cursor: bool = False
    differs: bool = False
    extra: CellExtra = PLAIN


def drawn_cell(face: Face, form: CellForm, look: Look) -> Drawn:
    """Draw a cell's rows."""
    return [list(strip) for strip in _Cell(face, form, look).drawn().strips()]


class _Cell:
    def __init__(self, face: Face, form: CellForm, look: Look) -> None:
        self.face, self.form, self.look, self.glyphs = face, form, look, look.glyphs
        self.extra, self.name = face.extra, face.extra.name
        self.ink = look.palette.focus if face.cursor and form.height == 1 else face.style
        self.canvas = Canvas(form.width, form.height, look.palette.text)
        self.has_blocks = form.has_blocks and look.glyphs.braille

    def drawn(self) -> Canvas:
        if self.extra.draft is not None:
            self._draw_draft(self.extra.draft)
            return self.canvas
        self._take_name()
        self._fill()
        if self.face.kind is not CellKind.WALL:
            self._draw_content()
            self._put_marks()
            self._put_edges()
            self._put_seams()
        self._put_trace_frame(trace_colour(self.extra.trace, self.ink, self.look))
        if self.face.cursor and self.form.height > 1:
            self._put_cursor()
        if self.face.agent:
            self._put_agent()
        if self.extra.trace.way is not None and self.form.has_blocks:
            put_way(self.canvas, self.extra.trace.way, self._number, self.look)
        return self.canvas

    def _draw_content(self) -> None:
        if self.face.text is None:
            self._draw_end()
        elif self.form.height == 1:
            self._draw_row()
        else:
            self._draw_sign()
            form, rows = self.form, self._value_rows
            for y, text in enumerate(rows, form.height - len(rows)):
                ink = self.ink if text == NO_VALUE else self.ink + _BOLD
                self.canvas.put(self._number.start, y, text, ink)

    @property
    def _number(self) -> range:
        """The columns of the value in the last row."""
        length = max(map(len, self._value_rows), default=0)
        start = self._centred(length)
        return range(start, start + length)

    def _centred(self, length: int) -> int:
        return self.form.centred(length, as_blocks=self.has_blocks)

    # The ground

    def _fill(self) -> None:
        """Fill the cell. Blanks have the page as ink, for the seams."""
        width, height, glyphs, ink = self.form.width, self.form.height, self.glyphs, self.ink
        is_floor = self.face.kind in _ALIVE
        for row in range(height):
            if self.face.kind is CellKind.WALL:
                self._fill_wall(row)
            elif is_floor and not self.extra.is_reached:
                self.canvas.put(0, row, glyphs.unreached * width, self.look.palette.rule)
            else:
                self.canvas.put(0, row, " " * width, self._blank)
            if self.face.kind is CellKind.CLIFF:
                above, left = self.extra.hatch[0] * height, self.extra.hatch[1] * width
                for column in range(-(above + row + left) % HATCH, width, HATCH):
                    self.canvas.put(column, row, glyphs.cliff, ink)

    @property
    def _blank(self) -> Style:
        palette = self.look.palette
        return self.ink + (palette.rule if self.ink.bgcolor is None else palette.page)

    def _fill_wall(self, row: int) -> None:
        if self.extra.wall is Wall.PAGE and not self.face.cursor:
            return
        has_ground = self.ink.bgcolor is not None and self.glyphs.braille
        sign = " " if has_ground else self.glyphs.wall
        if has_ground and row == 0 and self.extra.wall is Wall.LIT and self.form.height > 1:
            sign = self.glyphs.lit_edge
        self.canvas.put(0, row, sign * self.form.width, self.ink)

    def _put_edges(self) -> None:
        form, is_low = self.form, self.form.height == 1
        after = is_low and (form.width <= LEAST_ARROWS or (form.has_values and not form.has_seam))
        if form.width >= LEAST_ARROWS and self.extra.edges[not after]:
            for row in range(form.height):
                edge = self.glyphs.edges[not after]
                self.canvas.put_where_blank(0 if after else form.width - 1, row, edge, self.ink + _BOLD)

    def _put_seams(self) -> None:
        if not self.form.has_seam or not self.extra.is_reached or self.face.kind is CellKind.CLIFF:
            return
        for row in range(self.form.height):
            self.canvas.put_where_blank(self.form.width - 1, row, self.glyphs.seam, self._blank)

    def _put_cursor(self) -> None:
        has_frame = self.glyphs.braille and self.form.width >= 5
        is_bare = not has_frame or self.face.kind is CellKind.WALL
        rows = len(self._value_rows) or int(is_bare)  # a bar without a number looks like a value
        for row in range(self.form.height - rows, self.form.height):
            self.canvas.restyle(0, row, self.form.inner, self.look.palette.focus)
        if has_frame:
            put_frame(self.canvas, self.look.palette.you, self.look)

    def _put_trace_frame(self, colour: Style | None) -> None:
        form, (width, height) = self.form, _LEAST_FRAMED
        has_frame = form.width > width or (form.width == width and form.height >= height)
        if colour is not None and self.glyphs.braille and has_frame:
            put_frame(self.canvas, colour, self.look)
        elif colour is not None and (form.has_values or self.extra.trace.is_next):
            palette = self.look.palette
            is_coloured = palette.has_shades and self.glyphs.braille
            lit = Style(color=palette.page.color, bgcolor=colour.color) if is_coloured else _REVERSE
            for x in range(form.inner):
                if not self.canvas.is_blank(x, form.value_row, 1):
                    self.canvas.restyle(x, form.value_row, 1, lit)

    # Signs and values

    def _draw_end(self) -> None:
        kind, form = self.face.kind, self.form
        rows = sign_size(form.width, form.height)[1] if self.has_blocks else 0
        if kind is CellKind.HOLE and rows:
            self._put_block("ring", 2 * rows)
        elif kind is CellKind.GOAL and rows and (rows > _LEAST_ARROW or self.face.reward is None):
            self._put_block("star", min(2 * rows + 2, form.inner - (rows > _LEAST_ARROW)))
        elif kind is not CellKind.CLIFF:
            self.canvas.put((form.inner - 1) // 2, (form.height - 1) // 2, self._end_sign, self.ink)

    @property
    def _end_sign(self) -> str:
        glyphs = self.glyphs
        signs = {CellKind.HOLE: glyphs.hole, CellKind.GOAL: glyphs.goal, CellKind.CLIFF: glyphs.cliff}
        return signs.get(self.face.kind, "")

    def _put_block(self, name: SignName, columns: int) -> None:
        form, free = self.form, self._agent_end(0)
        if free + columns > form.inner:
            self.canvas.put(form.inner - 2, (form.height - 1) // 2, self._end_sign, self.ink)
            return
        left, above = free + (form.inner - free - columns) // 2, self.face.reward is not None
        self._put_rows(left, above, block_sign(name, columns, form.height - above), self.ink)

    def _put_rows(self, left: int, top: int, rows: Sequence[str], ink: Style) -> None:
        for y, row in enumerate(rows, start=top):
            self.canvas.put(left + len(row) - len(row.lstrip()), y, row.strip(), ink)

    @property
    def _sign_ink(self) -> Style:
        if self.extra.is_off_way:
            return off_way_style(self.ink, self.look)
        if self.extra.has_turned:
            return self.ink + self.look.palette.you + _BOLD
        return paled(self.ink + _BOLD, self.face.lead / marks.MOST_LEAD)

    def _draw_sign(self) -> None:
        form, face, canvas = self.form, self.face, self.canvas
        if not face.greedy:
            middle = self._centred(1), (form.height - 1) // 2
            canvas.put(*middle, self.glyphs.untried, paled(self.ink, 0.3))
            return
        top = min(1, form.value_row - form.arrow_rows)
        if not self.has_blocks:
            self._draw_letters(form.value_row // 2)
        elif not (self._put_blocks(top) or self._put_rose()):
            self._draw_letters(top + 1)

    def _put_blocks(self, top: int) -> bool:
        """Put the greedy directions side by side, smaller below or beside the agent."""
        form, count, rows = self.form, len(self.face.greedy), self.form.arrow_rows
        directions = sorted(
            (each for each in self.face.greedy if isinstance(each, tuple)), key=lambda each: each[1]
        )
        free = self._agent_end(top)
        if free == _CORNER:
            free += 1  # both may be black
            if count * (2 * rows + 1) - 1 > form.inner - free and form.value_row > _LEAST_ARROW:
                top, rows, free = 1, form.value_row - 1, 0
        room = form.inner - free
        columns = min(2 * rows, (room + 1) // count - 1 if count > 1 else room)
        columns -= columns > 3 and columns % 2
        if len(directions) < count or columns <= _LEAST_ARROW or (count > 1 and rows == _LEAST_ARROW):
            return False
        gap = min(2, (room - count * columns) // max(1, count - 1))
        left = free + (room - count * columns - (count - 1) * gap) // 2
        low = min(rows, max(_LEAST_ARROW, columns // 2))
        for place, direction in enumerate(directions):
            sign = block_sign("arrow" if any(direction) else "square", columns, low, direction)
            x, y = left + place * (columns + gap), top + (rows - low + 1) // 2
            self._put_rows(x, y, sign, self._sign_ink)
        return True

    def _put_rose(self) -> bool:
        """Put letters around a centre, in three rows above the number."""
        form, top = self.form, min(1, self.form.value_row - 3)
        ways = [each for each in self.face.greedy if isinstance(each, tuple)]
        middle = max((form.inner - 1) // 2, self._agent_end(top) + 2)
        if top < 0 or middle + 2 >= form.inner or len(ways) < len(self.face.greedy):
            return False
        for down, right in ways:
            text = marks.sign_text((down, right), self.look)
            self.canvas.put(middle + 2 * right, top + 1 + down, text, self._sign_ink)
        return True

    def _agent_end(self, row: int) -> int:
        if not self.face.agent:
            return 0
        rows = self._plate_rows
        if rows:
            return 2 * rows + 4  # with a margin and a gap, because sign and plate may both be black
        return _CORNER if row == 0 else 0

    @property
    def _plate_rows(self) -> int:
        return self.form.plate_rows if self.has_blocks else 0

    def _draw_letters(self, row: int) -> None:
        form = self.form
        text = self._letters(form.most_signs, form.width - 2)
        left = self._centred(len(text))
        if left < self._agent_end(row):
            left = form.inner - len(text)
        ink = self.look.palette.focus if self.extra.has_turned else self._sign_ink  # letters are thin
        self.canvas.put(max(0, left), row, text, ink)

    def _letters(self, most: int, room: int) -> str:
        text = "".join(marks.sign_text(each, self.look) for each in self.face.greedy)
        return text if len(text) <= (most if len(self.face.greedy) > 1 else max(1, room)) else marks.SEVERAL

    @property
    def _text(self) -> str:
        text = self.face.text or ""
        return text if len(text) <= self.form.most_digits else self.glyphs.no_room

    @property
    def _value_rows(self) -> tuple[str, ...]:
        if not (self.form.has_values and self._text):
            return ()
        rows = block_number(self._text) if self.has_blocks and self.form.has_block_values else ()
        return rows if rows and len(rows[0]) < self.form.inner else (self._text,)

    def _draw_row(self) -> None:
        form, has_signs = self.form, bool(self.face.greedy)
        start = form.inner - form.digits if form.has_values else max(1, (form.width - 1) // 2)
        if self._has_gap:
            start = max(2, start)
        if not has_signs and not (self._text and form.has_values):
            dot = "" if self.name else self.glyphs.untried
            middle = max(min(1, form.width - 1), (form.inner - 1) // 2)
            self._put_letters(start if self._has_gap else middle, dot)
        elif not form.has_values:
            self._put_letters(start, self._letters(1, form.width - len(self.name) - start))
        else:
            has_mark = any((self._mark, self.face.reward, self.face.stops, *self.extra.marks))
            most, room = max(1, form.most_signs - has_mark), start - has_mark
            letters = self._letters(most, room) if has_signs else ""
            self.canvas.put(start, 0, self._text.rjust(form.digits), self.ink)
            self._put_letters(start - len(letters), letters)

    @property
    def _has_gap(self) -> bool:
        """True if a blank separates agent or start from the letter."""
        is_free = not (self.form.has_values or self.name or self.face.text is None)
        return is_free and bool(self._mark) and self.form.width > LEAST_ARROWS

    def _put_letters(self, start: int, letters: str) -> None:
        face, is_dot = self.face, letters == self.glyphs.untried
        before = start - 2 if is_dot or self._has_gap or not (letters or face.text is None) else start - 1
        if self._mark or face.stops or any(self.extra.marks) or face.reward:
            self._put_mark(max(0, before))
        is_free = face.differs and self.canvas.is_blank(0, 0, 1) and start > 0
        if is_free:
            self.canvas.put(0, 0, self.glyphs.differs, self.ink)
        ink = paled(self.ink, 0.3) if is_dot else self._sign_ink
        self.canvas.put(
            start, 0, letters, marks.differing_style(ink) if face.differs and not is_free else ink
        )

    # Marks

    @property
    def _mark(self) -> str:
        return marks.mark_of(self.face.kind, self.face.agent, self.extra.way, self.look)

    def _put_mark(self, x: int) -> None:
        palette, canvas, face = self.look.palette, self.canvas, self.face
        edit = next(self.extra.marks.signs(self.look), None)
        if face.stops:
            canvas.put(x, 0, self.glyphs.agent if face.agent else self.glyphs.breakpoint, palette.breakpoint)
        elif self._mark:
            canvas.put(x, 0, self._mark, self.ink + (palette.agent if face.agent else palette.start))
            if edit is not None and canvas.is_blank(x - 1, 0, 1):
                canvas.put(x - 1, 0, *edit)
        elif edit is not None:
            canvas.put(x, 0, *edit)
        else:
            marks.put_reward(canvas, x, 0, 1, face.reward, self.look)

    def _put_marks(self) -> None:
        form, canvas, face, inner = self.form, self.canvas, self.face, self.form.inner
        if form.height == 1:
            if face.text is None:
                self._put_letters(max(1, (form.width - 1) // 2), "")
            start = form.width - len(self.name)
            if self.name and (canvas.is_blank(start, 0, len(self.name)) or not self.extra.is_reached):
                style = marks.differing_style(self.ink) if face.differs and not face.greedy else self.ink
                canvas.put(start, 0, self.name, style)
            put_trail(canvas, self.extra.trace, self.look, inner=inner, ink=self.ink)
            return
        left = _CORNER if face.agent and not self._plate_rows else 0
        if self.name and (canvas.is_blank(left, 0, len(self.name)) or not self.extra.is_reached):
            canvas.put(left, 0, self.name, paled(self.ink, 0.5))
            left += len(self.name) + 1
        if face.stops:
            canvas.put(inner - 1, 0, self.glyphs.breakpoint, self.look.palette.breakpoint)
        room = next((x for x in range(left, inner) if not canvas.is_blank(x, 0, 1)), inner) - left
        marks.put_reward(canvas, left, 0, room, face.reward, self.look)
        if self.extra.way is None and face.kind is CellKind.START:
            self._put_start(left)
        if canvas.at(inner - 1, 0) != marks.START:
            put_trail(canvas, self.extra.trace, self.look, inner=inner, ink=self.ink)
        if self.extra.way is not None:
            self._put_one_way(self.extra.way)
        if face.differs:
            self._put_differing(left)
        put_marks(canvas, self.extra.marks, (left, 0), self.look)

    def _put_start(self, left: int) -> None:
        """Put a word, or a letter where it touches nothing."""
        form, canvas, style = self.form, self.canvas, paled(self.ink, 0.5)
        last = form.inner - 1
        before_trail = last - self.extra.trace.was_here
        x = before_trail - len(_START_WORD)
        if form.says_start and canvas.is_blank(x - 1, 0, len(_START_WORD) + 1):
            canvas.put(x, 0, _START_WORD, style)
            return
        free = ((before_trail, 0, -1), (left, 0, 1), (last, form.value_row, -1), (last, 0, -1), (0, 0, 0))
        for x, y, beside in free if form.width < _LEAST_APART else free[:-1]:
            if canvas.is_blank(min(x, x + beside), y, 1 + abs(beside)):
                canvas.put(x, y, marks.START, style)
                return

    def _put_one_way(self, way: Direction) -> None:
        down, right = way
        middle = (self.form.inner - 1) // 2
        x = middle if down else (self.form.inner - 1 if right > 0 else 0)
        y = (self.form.height - 1 if down > 0 else 0) if down else self.form.height // 2
        if self.canvas.is_blank(x, y, 1):
            self.canvas.put(x, y, marks.one_way_sign(way, self.look), self.ink + _BOLD)

    def _put_differing(self, left: int) -> None:
        last, bottom = self.form.inner - 1, self.form.height - 1
        for place in ((left, 0), (last, 0), (0, bottom), (last, bottom)):
            if self.canvas.is_blank(*place, 1):
                self.canvas.put(*place, self.glyphs.differs, self.ink)
                return

    def _put_agent(self) -> None:
        form, style = self.form, self.look.palette.agent
        if form.height == 1:
            return
        rows = self._plate_rows
        if not rows:
            text = f" {self.glyphs.agent} " if form.width >= _WITH_PLATE else self.glyphs.agent
            self.canvas.put(int(5 <= form.width < _WITH_PLATE), 0, text, style)
            return
        for row in range(1, 1 + rows):
            self.canvas.put(1, row, " " * (2 * rows + 2), style)
        self._put_rows(2, 1, block_sign("agent", 2 * rows, rows), style)

    def _take_name(self) -> None:
        form, face = self.form, self.face
        if len(self.name) > form.longest_name or face.kind is CellKind.CLIFF:  # hatching would hide some
            self.name = ""
        elif form.has_corner:
            self.name = self.name.strip()
        elif self.name and face.text is not None and form.has_values:
            self.face, self.name = face._replace(text=self.name), ""
        elif self.name and face.text is not None and len(self.name) > form.width - LEAST_ARROWS:
            self.face = face._replace(greedy=())

    def _draw_draft(self, draft: DraftCell) -> None:
        face, form, look = self.face, self.form, self.look
        palette = look.palette
        ways = "".join(marks.sign_text(each, look) for each in draft.ways)
        label = self._mark + (self._end_sign or (ways if len(ways) < form.width else marks.SEVERAL))
        pays = marks.CellReward(draft.pays, draft.pays > 0.0) if draft.pays else None
        reward = "" if pays is None else marks.reward_text(pays, form.width, look)
        row, is_wall = (form.height - 1) // 2, face.kind is CellKind.WALL
        style = palette.text if face.kind in _ALIVE else self.ink
        draw_draft_cell(self.canvas, label, reward, style, look, is_wall=is_wall, row=row)
        if face.cursor and form.height > 1:
            self.canvas.restyle(0, form.value_row, form.width, palette.focus)
