"""Tools to edit a map."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.panels.draw_panel import Sign, ToolCell, WorldNumber
from rl_tui.screen.playground.modes import brushes, rules
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.world import World

_WALL_PAYS: Final = "walls have no reward: they cannot be entered"
_NOT_WHOLE: Final = "finish the map first: rows and columns change only in a valid map"
_NOTHING_COPIED: Final = "nothing copied yet: w m marks a corner, w c copies up to the cursor"
_PICK, _ARROW_KEY, _JUMP = "comma", "A", "J"

ARROW: Final = brushes.Brush(_ARROW_KEY, "A", "arrow")
"""In place of a brush when clicks only move the cursor."""


class MapTools(rules.Toolbox[GridDraft]):
    """Brush, rectangles, copies and jumps."""

    rest = "rows, copy, rules, save"

    def __init__(self) -> None:
        self._brush = brushes.BRUSHES[1]
        self.corner: int | None = None
        """Where a rectangle was begun."""
        self.copied: tuple[str, ...] = ()
        self._jump_from: int | None = None
        self._added: tuple[tuple[int, int], int] | None = None  # the size of the map with it, and its cell

    # Display

    def about(self, desk: rules.Desk[GridDraft]) -> tuple[str, ...]:
        """Describe the cell under the cursor."""
        row, column = _here(desk)
        character = desk.draft.lines[row][column]
        entry = desk.draft.legend.get(character)
        reward = "" if entry is None or entry.is_wall else f" pays {rules.number_text(entry.pays)}"
        where, what = f"row {row}, column {column}", f"{character} {brushes.called(entry)}{reward}"
        rows, columns = self._rectangle(desk)
        size = f"{len(rows)} × {len(columns)} cells · " if self.corner is not None else ""
        return f"{size}here: {what} · {where}", f"{size}here: {what}", what

    @property
    def in_hand(self) -> ToolCell:
        """The brush, or an unfinished jump."""
        if self._jump_from is not None:
            tool = next(each for each in self.tools if each.key == _JUMP)
            return ToolCell(_JUMP, _JUMP, tool.label, sign=tool.sign)
        brush = self._brush
        shown = "V" if brush.key == "V" else brush.character
        return ToolCell(brush.key, shown, brush.label, sign=brush.sign)

    def advice(self, desk: rules.Desk[GridDraft]) -> tuple[str, ...]:
        """Describe what enter, click or drag does."""
        if self._jump_from is not None:
            return "enter or a click: where it leads · esc: drop it", "enter: it leads here", "enter: to here"
        if self._brush is ARROW:
            return "click: cursor · drag: rectangle · wheel: reward", "click: cursor · drag: rectangle"
        return "enter, shift+arrow, click or drag paints", "enter or a click paints", "enter paints"

    def numbers(self, desk: rules.Desk[GridDraft]) -> tuple[WorldNumber, ...]:
        """Return the numbers of map and cell."""
        draft, (row, column) = desk.draft, _here(desk)
        entry = draft.legend.get(draft.lines[row][column])
        return (
            WorldNumber(rules.PAYS, 0.0 if entry is None else entry.pays),
            WorldNumber(rules.LIVING, rules.number_of(draft, rules.LIVING.name)),
            WorldNumber(rules.NOISE, rules.number_of(draft, rules.NOISE.name)),
            WorldNumber(rules.LIMIT, rules.number_of(draft, rules.LIMIT.name)),
            WorldNumber(rules.WIND, _wind(draft, rules.WIND.name, column), is_short=True),
            WorldNumber(rules.WIND_ROWS, _wind(draft, rules.WIND_ROWS.name, row), is_short=True),
        )

    def can_pay(self, desk: rules.Desk[GridDraft]) -> bool:
        """Return whether the selection can have a reward."""
        return brushes.pays(desk.draft, *self._rectangle(desk))

    def number_edits(self, desk: rules.Desk[GridDraft], name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set a number."""
        draft, (row, column) = desk.draft, _here(desk)
        if name == rules.PAYS.name:
            if not self.can_pay(desk):
                raise ValueError(_WALL_PAYS)
            return (self._reward_edit(desk, value),)
        where = {rules.WIND.name: (str(column),), rules.WIND_ROWS.name: (str(row),)}.get(name, ())
        is_whole = name in (rules.LIMIT.name, rules.WIND.name, rules.WIND_ROWS.name)
        return rules.checked(draft, Edit(name, where, repr(int(value) if is_whole else value)))

    def picked(self, desk: rules.Desk[GridDraft]) -> frozenset[int]:
        """Return the rectangle's cells."""
        if self.corner is None:
            return frozenset()
        width = _drawing(desk).columns
        return frozenset(row * width + column for row, column in self._cells(desk))

    # Pointer and moving keys

    def paint(self, desk: rules.Desk[GridDraft], places: Sequence[int]) -> None:
        """Paint or mark ``places``, or end a jump."""
        before = desk.view.cursor_place
        desk.view.put_cursor(places[-1])
        if self._jump_from is not None:
            self.enter(desk)
        elif self._brush is not ARROW:
            desk.draw(brushes.painted(desk.draft, self._brush, [_cell(desk, place) for place in places]))
        elif len(places) > 1:
            self.corner = places[0]
        elif before == places[0]:
            self.corner = None

    def turn(self, desk: rules.Desk[GridDraft], place: int, amount: float) -> None:
        """Raise a cell's reward."""
        self._pay_more(desk, [_cell(desk, place)], amount)

    def go_along(self, desk: rules.Desk[GridDraft], step: tuple[int, int]) -> None:
        """Paint towards ``step``, or extend a rectangle."""
        before = desk.view.cursor_place
        if before is None:
            return
        there = desk.view.moved(before, *step)
        if self._brush is not ARROW:
            self.paint(desk, (before, there))
            return
        self.corner = before if self.corner is None else self.corner
        desk.view.put_cursor(there)

    def place_added(self, world: World) -> int | None:
        """Return an added line's cell, once in ``world``."""
        grid = world.drawing
        if self._added is None or not isinstance(grid, Grid):
            return None
        size, place = self._added
        if size != (grid.rows, grid.columns):
            return None
        self._added = None
        return place

    # Brushes

    def take(self, desk: rules.Desk[GridDraft], brush: brushes.Brush) -> None:
        """Take a brush, and paint the selection."""
        self._brush = brush
        self._fill_rectangle(desk)

    def choose(self, desk: rules.Desk[GridDraft], brush: brushes.Brush) -> None:
        """Take a clicked brush, and paint a rectangle."""
        self._brush = brush
        if self.corner is not None:
            self._fill_rectangle(desk)

    def point(self, desk: rules.Desk[GridDraft]) -> None:
        """Drop the brush: clicks only move the cursor."""
        self._brush = ARROW

    def pick_up(self, desk: rules.Desk[GridDraft]) -> None:
        """Make the cell here the brush."""
        row, column = _here(desk)
        character = desk.draft.lines[row][column]
        self._brush = brushes.Brush(_PICK, character, brushes.called(desk.draft.legend.get(character)))

    def enter(self, desk: rules.Desk[GridDraft]) -> None:
        """Paint, or end a jump."""
        source, place = self._jump_from, desk.view.cursor_place
        if source is None or place is None:
            self._fill_rectangle(desk)
            return
        self._jump_from = None
        try:
            desk.draw(brushes.jump(desk.draft, _cell(desk, source), _cell(desk, place)))
        except ValueError as fault:
            desk.tell(str(fault))

    def fill(self, desk: rules.Desk[GridDraft]) -> None:
        """Paint the rectangle, or the region of equal cells."""
        if self.corner is not None:
            self._fill_rectangle(desk)
        elif self._brush is not ARROW:
            draft = desk.draft
            desk.draw(brushes.painted(draft, self._brush, brushes.region(draft, _here(desk))))

    def _fill_rectangle(self, desk: rules.Desk[GridDraft]) -> None:
        if self._brush is ARROW:
            desk.tell("The arrow paints nothing: take a brush.")
            return
        draft, cells = desk.draft, self._cells(desk)
        rows, columns = self._rectangle(desk)
        self.corner = None
        filled = Edit(
            "cell", (brushes.span(rows), brushes.span(columns)), brushes.character_of(draft, self._brush)
        )
        desk.draw((*brushes.before_painting(draft, self._brush, cells), filled))

    # Jumps, rewards, rectangles, lines

    def begin_jump(self, desk: rules.Desk[GridDraft]) -> None:
        """Start a jump under the cursor."""
        self._jump_from = desk.view.cursor_place
        desk.tell("Go to the end of the jump, then press enter.")

    def cancel(self) -> bool:
        """Cancel a jump or rectangle, and return whether there was one."""
        had = self._jump_from is not None or self.corner is not None
        self._jump_from = self.corner = None
        return had

    def ask_reward(self, desk: rules.Desk[GridDraft]) -> None:
        """Ask for the selection's reward."""
        draft, (rows, columns) = desk.draft, self._rectangle(desk)
        entry = draft.legend.get(draft.lines[rows.start][columns.start])
        now = 0.0 if entry is None else entry.pays
        hint = "Paid on entering or leaving the cell: the map's rules decide."
        desk.ask(
            Prompt("Reward of the cell", hint, f"{now:g}", rules.number_in),
            lambda value: desk.draw((self._reward_edit(desk, float(value)),)),
        )

    def _reward_edit(self, desk: rules.Desk[GridDraft], value: float) -> Edit:
        rows, columns = self._rectangle(desk)
        return Edit("reward", (brushes.span(rows), brushes.span(columns)), repr(value))

    def pay(self, desk: rules.Desk[GridDraft], amount: float) -> None:
        """Raise the reward of the selected cells."""
        self._pay_more(desk, self._cells(desk), amount)

    def _pay_more(self, desk: rules.Desk[GridDraft], cells: Sequence[brushes.Cell], amount: float) -> None:
        edits = brushes.paying_more(desk.draft, cells, amount)
        if edits:
            desk.draw(edits)
        else:
            desk.tell(_WALL_PAYS)

    def mark(self, desk: rules.Desk[GridDraft]) -> None:
        """Start or drop a rectangle."""
        self.corner = desk.view.cursor_place if self.corner is None else None

    def copy(self, desk: rules.Desk[GridDraft]) -> None:
        """Copy the selected cells."""
        rows, columns = self._rectangle(desk)
        lines = desk.draft.lines
        self.copied = tuple(lines[row][columns.start : columns.stop] for row in rows)
        self.corner = None
        desk.tell(f"copied {len(rows)} × {len(columns)} cells: w v pastes them")

    def paste(self, desk: rules.Desk[GridDraft]) -> None:
        """Paste here, clipped by the map."""
        draft, (top, left) = desk.draft, _here(desk)
        cells = {
            (top + row, left + column): character
            for row, line in enumerate(self.copied)
            for column, character in enumerate(line)
            if top + row < draft.rows and left + column < draft.columns
        }
        desk.draw(tuple(brushes.runs(list(cells), cells.__getitem__)))

    def resize(self, desk: rules.Desk[GridDraft], name: str, count: int, *, at_end: bool) -> None:
        """Add a row or column here or ``at_end``, or remove one."""
        draft, (row, column) = desk.draft, _here(desk)
        self.corner = self._jump_from = None
        last, here = (draft.rows, row) if name == "rows" else (draft.columns, column)
        if count > 0 and not at_end:
            rows, columns = draft.rows + count * (name == "rows"), draft.columns + count * (name == "columns")
            self._added = (rows, columns), row * columns + column
        desk.draw((Edit(name, (), f"{count:+d}@{last if at_end else here}"),))

    def _rectangle(self, desk: rules.Desk[GridDraft]) -> tuple[range, range]:
        place = desk.view.cursor_place or 0
        corner = place if self.corner is None else self.corner
        (top, left), (bottom, right) = _cell(desk, corner), _cell(desk, place)
        rows, columns = sorted((top, bottom)), sorted((left, right))
        return range(rows[0], rows[1] + 1), range(columns[0], columns[1] + 1)

    def _cells(self, desk: rules.Desk[GridDraft]) -> list[brushes.Cell]:
        rows, columns = self._rectangle(desk)
        return [(row, column) for row in rows for column in columns]


def _drawing(desk: rules.Desk[GridDraft]) -> Grid:
    drawing = desk.snapshot.world.drawing
    assert isinstance(drawing, Grid)
    return drawing


def _cell(desk: rules.Desk[GridDraft], place: int) -> brushes.Cell:
    """Return the draft's cell of a place, even if its line was removed."""
    row, column = divmod(place, _drawing(desk).columns)
    return min(row, desk.draft.rows - 1), min(column, desk.draft.columns - 1)


def _here(desk: rules.Desk[GridDraft]) -> brushes.Cell:
    return _cell(desk, desk.view.cursor_place or 0)


def _wind(draft: GridDraft, name: str, line: int) -> float:
    wind = draft.rules.get(name)
    strength = wind[line] if isinstance(wind, list) and line < len(wind) else 0
    return float(strength) if isinstance(strength, int) else 0.0


# The tools, one row each


def _unfinished(_: object, desk: rules.Desk[GridDraft]) -> str:
    return _NOT_WHOLE if desk.snapshot.editor.unfinished else ""


def _no_reward(box: MapTools, desk: rules.Desk[GridDraft]) -> str:
    return "" if box.can_pay(desk) else _WALL_PAYS


def _value(name: str, _: object, desk: rules.Desk[GridDraft]) -> str:
    value = rules.rule_of(desk.draft, name)
    return {True: "on", False: "off", "leaving": "on", "entering": "off"}.get(value, str(value))


MapTools.tools = (
    *(
        rules.Tool(each.key, each.label, each.sentence, partial(MapTools.take, brush=each)).also(
            symbol="V" if each.key == "V" else each.character,
            click=partial(MapTools.choose, brush=each),
            sign=each.sign,
            rank=2 if each is brushes.BRUSHES[0] else None,
            hint=(". # S G H C X", "brush"),
        )
        for each in brushes.BRUSHES
    ),
    rules.Tool(_JUMP, "jump", "Begin a jump here.", MapTools.begin_jump).also(
        sign=Sign(CellKind.FLOOR, lambda glyphs: glyphs.right)
    ),
    rules.Tool(_PICK, "pick up", "Take the brush from under the cursor.", MapTools.pick_up, ","),
    rules.Tool(_ARROW_KEY, "arrow", "Paint nothing: click moves, drag marks.", MapTools.point),
    rules.Tool("enter", "paint", "Paint here. shift+arrows paint along the way.", MapTools.enter).also(
        rank=5, is_told=True
    ),
    rules.Tool("equals_sign", "value…", "Type what the cell pays.", MapTools.ask_reward).also(
        symbol="=", why_not=_no_reward, is_of_number=True, rank=6, hint=("= [ ]", "pays")
    ),
    *(
        rules.Tool(key, label, sentence, partial(MapTools.pay, amount=amount)).also(
            symbol=symbol, why_not=_no_reward, is_of_number=True
        )
        for key, symbol, label, sentence, amount in (
            ("left_square_bracket", "[", "less", "Make the cell pay 1 less.", -1.0),
            ("right_square_bracket", "]", "more", "Make the cell pay 1 more.", 1.0),
        )
    ),
    rules.Tool("w m", "mark", "Begin a rectangle at the cursor, or drop it.", MapTools.mark).also(
        value=lambda box, _: "" if box.corner is None else "on"
    ),
    rules.Tool("w c", "copy", "Copy the rectangle.", MapTools.copy),
    rules.Tool("w v", "paste", "Paste what you copied.", MapTools.paste).also(
        why_not=lambda box, _: "" if box.copied else _NOTHING_COPIED
    ),
    rules.Tool("w f", "fill", "Fill the rectangle, else the region around the cursor.", MapTools.fill),
    *(
        rules.Tool(
            key, label, sentence, partial(MapTools.resize, name=name, count=count, at_end=at_end)
        ).also(why_not=_unfinished)
        for key, label, sentence, name, count, at_end in (
            ("w i", "row here", "Add a row here.", "rows", 1, False),
            ("w d", "remove row", "Remove this row.", "rows", -1, False),
            ("w b", "row below", "Add a row at the bottom.", "rows", 1, True),
            ("w h", "column here", "Add a column here.", "columns", 1, False),
            ("w x", "remove column", "Remove this column.", "columns", -1, False),
            ("w e", "column right", "Add a column at the right.", "columns", 1, True),
        )
    ),
    rules.Tool("w r", "rules…", "Set noise, wind, living reward, time limit and more.", rules.ask_rules),
    *(
        rules.Tool(key, label, sentence, partial(rules.next_word, name=name), value=partial(_value, name))
        for key, label, sentence, name in (
            ("w p", "slippery", "Slippery: ahead, left and right equally likely.", "slippery"),
            ("w l", "on leaving", "Pay rewards on leaving a cell, or on entering it.", "rewards"),
            ("w n", "moves", "Switch to the next set of moves.", "moves"),
        )
    ),
)
