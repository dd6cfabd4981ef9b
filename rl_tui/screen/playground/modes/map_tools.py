"""Tools to edit a map: brushes, rewards, rectangles, and whole rows or columns."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.panels.draw_panel import Sign, ToolCell, WorldNumber
from rl_tui.screen.playground.modes.brushes import (
    BRUSHES,
    Brush,
    Cell,
    before_painting,
    called,
    character_of,
    jump,
    painted,
    paying_more,
    pays,
    region,
    runs,
    span,
)
from rl_tui.screen.playground.modes.numbers import LIMIT, LIVING, NOISE, PAYS, WIND, WIND_ROWS
from rl_tui.screen.playground.modes.rules import (
    Desk,
    Tool,
    Toolbox,
    ask_rules,
    fault_of,
    next_word,
    number_of,
    rule_of,
)
from rl_tui.screen.playground.modes.texts import number_in, number_text
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.world import World

# The tools, one row each


def _resize(name: str, count: int, at_end: bool, box: MapTools, desk: Desk) -> None:
    box.resize(name, count, desk, at_end=at_end)


def _unfinished(_: object, desk: Desk) -> str:
    return _NOT_WHOLE if desk.snapshot.editor.unfinished else ""


def _no_reward(box: MapTools, desk: Desk) -> str:
    return "" if box.can_pay(desk) else _WALL_PAYS


def _turn(name: str, _: object, desk: Desk) -> None:
    next_word(desk, name)


def _value(name: str, _: object, desk: Desk) -> str:
    """Return the value of a rule, or on or off for a switch."""
    value = rule_of(desk.draft, name)
    return {True: "on", False: "off", "leaving": "on", "entering": "off"}.get(value, str(value))


_WALL_PAYS: Final = "walls have no reward: they cannot be entered"
_NOT_WHOLE: Final = "finish the map first: rows and columns change only in a valid map"
_NOTHING_COPIED: Final = "nothing is copied yet: w m marks a corner, w c copies up to the cursor"
_PICK, _ARROW_KEY, _JUMP = "comma", "A", "J"

MAP_TOOLS: Final = (
    *(
        Tool(
            each.key,
            each.label,
            each.sentence,
            partial(lambda brush, box, desk: box.take(brush, desk), each),
            "V" if each.key == "V" else each.character,
            click=partial(lambda brush, box, desk: box.choose(brush, desk), each),
            sign=each.sign,
            rank=2 if each is BRUSHES[0] else None,
            hint=(". # S G H C X", "brush"),
        )
        for each in BRUSHES
    ),
    Tool(
        _JUMP,
        "jump",
        "Begin a jump here.",
        lambda box, desk: box.begin_jump(desk),
        sign=Sign(CellKind.FLOOR, lambda glyphs: glyphs.right),
    ),
    Tool(
        _PICK,
        "pick up",
        "Take the brush from under the cursor.",
        lambda box, desk: box.pick_up(desk),
        ",",
    ),
    Tool(
        _ARROW_KEY,
        "arrow",
        "Paint nothing: click moves, drag marks.",
        lambda box, desk: box.point(desk),
    ),
    Tool(
        "enter",
        "paint",
        "Paint here, or along the way with shift.",
        lambda box, desk: box.enter(desk),
        rank=5,
        is_told=True,
    ),
    Tool(
        "equals_sign",
        "value…",
        "Type what the cell pays.",
        lambda box, desk: box.ask_reward(desk),
        "=",
        why_not=_no_reward,
        is_of_number=True,
        rank=6,
        hint=("= [ ]", "pays"),
    ),
    *(
        Tool(
            key,
            label,
            sentence,
            partial(lambda amount, box, desk: box.pay(amount, desk), amount),
            symbol,
            why_not=_no_reward,
            is_of_number=True,
        )
        for key, symbol, label, sentence, amount in (
            ("left_square_bracket", "[", "less", "Let the cell pay 1 less.", -1.0),
            ("right_square_bracket", "]", "more", "Let the cell pay 1 more.", 1.0),
        )
    ),
    Tool(
        "w m",
        "mark",
        "Begin a rectangle at the cursor, or drop it.",
        lambda box, desk: box.mark(desk),
        value=lambda box, _: "on" if box.is_marking else "",
    ),
    Tool("w c", "copy", "Copy the rectangle.", lambda box, desk: box.copy(desk)),
    Tool(
        "w v",
        "paste",
        "Paste what you copied.",
        lambda box, desk: box.paste(desk),
        why_not=lambda box, _: "" if box.has_copied else _NOTHING_COPIED,
    ),
    Tool(
        "w f",
        "fill",
        "Fill the rectangle, else the region around the cursor.",
        lambda box, desk: box.fill(desk),
    ),
    *(
        Tool(key, label, sentence, partial(_resize, name, count, at_end), why_not=_unfinished)
        for key, label, sentence, name, count, at_end in (
            ("w i", "row here", "Add a row here.", "rows", 1, False),
            ("w d", "row away", "Remove this row.", "rows", -1, False),
            ("w b", "row below", "Add a row at the bottom.", "rows", 1, True),
            ("w h", "column here", "Add a column here.", "columns", 1, False),
            ("w x", "column away", "Remove this column.", "columns", -1, False),
            ("w e", "column right", "Add a column at the right.", "columns", 1, True),
        )
    ),
    Tool("w r", "rules…", "Set noise, wind, living reward, time limit and more.", ask_rules),
    *(
        Tool(key, label, sentence, partial(_turn, name), value=partial(_value, name))
        for key, label, sentence, name in (
            ("w p", "slippery", "Slippery: straight on and both sides equally likely.", "slippery"),
            ("w l", "on leaving", "Let cells pay on leaving them, or on entering.", "rewards"),
            ("w n", "moves", "Choose the next kind of moves.", "moves"),
        )
    ),
)


# What they do


ARROW: Final = Brush(_ARROW_KEY, "A", "arrow")
"""In place of a brush when clicks only move the cursor."""


class MapTools(Toolbox):
    """Tools for a map: a brush, rectangles, copies and jumps."""

    tools = MAP_TOOLS
    rest = "rows, copy, rules, save"

    def __init__(self) -> None:
        self._brush = BRUSHES[1]
        self._corner: int | None = None
        self._copied: tuple[str, ...] = ()
        self._jump_from: int | None = None
        self._added: tuple[tuple[int, int], int] | None = None  # the size of the map with it, and its cell

    # Display

    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return the cell under the cursor and its reward."""
        row, column = _here(desk)
        character = _map_of(desk).lines[row][column]
        entry = _map_of(desk).legend.get(character)
        reward = "" if entry is None or entry.is_wall else f" pays {number_text(entry.pays)}"
        where, what = f"row {row}, column {column}", f"{character} {called(entry)}{reward}"
        rows, columns = self._rectangle(desk)
        size = f"{len(rows)} × {len(columns)} cells · " if self._corner is not None else ""
        return f"{size}here: {what} · {where}", f"{size}here: {what}", what

    @property
    def in_hand(self) -> ToolCell:
        """The current brush, or an unfinished jump."""
        if self._jump_from is not None:
            jump = next(each for each in self.tools if each.key == _JUMP)
            return ToolCell(_JUMP, _JUMP, jump.label, sign=jump.sign)
        brush = self._brush
        shown = "V" if brush.key == "V" else brush.character
        return ToolCell(brush.key, shown, brush.label, sign=brush.sign)

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return what enter, a click or a drag does now."""
        if self._jump_from is not None:
            return "enter or a click: where it leads · esc: drop it", "enter: it leads here", "enter: to here"
        if self._brush is ARROW:
            return "click: cursor · drag: rectangle · wheel: reward", "click: cursor · drag: rectangle"
        return "enter, shift+arrow, click or drag paints", "enter or a click paints", "enter paints"

    @property
    def is_marking(self) -> bool:
        """True if a rectangle was begun."""
        return self._corner is not None

    @property
    def has_copied(self) -> bool:
        """True if there is something to paste."""
        return bool(self._copied)

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return the numbers of the map and of the cell."""
        draft, (row, column) = _map_of(desk), _here(desk)
        entry = draft.legend.get(draft.lines[row][column])
        return (
            WorldNumber(PAYS, 0.0 if entry is None else entry.pays),
            WorldNumber(LIVING, number_of(draft, LIVING.name)),
            WorldNumber(NOISE, number_of(draft, NOISE.name)),
            WorldNumber(LIMIT, number_of(draft, LIMIT.name)),
            WorldNumber(WIND, _wind(draft, WIND.name, column), is_short=True),
            WorldNumber(WIND_ROWS, _wind(draft, WIND_ROWS.name, row), is_short=True),
        )

    def can_pay(self, desk: Desk) -> bool:
        """Return True if the selected cells can have a reward."""
        return pays(_map_of(desk), *self._rectangle(desk))

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set the number ``name``."""
        draft, (row, column) = _map_of(desk), _here(desk)
        if name == PAYS.name:
            if not self.can_pay(desk):
                raise ValueError(_WALL_PAYS)
            return (self._reward_edit(desk, value),)
        where = {WIND.name: (str(column),), WIND_ROWS.name: (str(row),)}.get(name, ())
        is_whole = name in (LIMIT.name, WIND.name, WIND_ROWS.name)
        edits = (Edit(name, where, repr(int(value) if is_whole else value)),)
        fault = fault_of(draft, edits, name)
        if fault:
            raise ValueError(fault)
        return edits

    def picked(self, desk: Desk) -> frozenset[int]:
        """Return the cells of the rectangle."""
        if self._corner is None:
            return frozenset()
        width = _drawing(desk).columns
        return frozenset(row * width + column for row, column in self._cells(desk))

    # Pointer and moving keys

    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Paint or mark ``places``, or end an unfinished jump there."""
        before = desk.view.cursor_place
        desk.view.put_cursor(places[-1])
        if self._jump_from is not None:
            self.enter(desk)
        elif self._brush is not ARROW:
            desk.draw(painted(_map_of(desk), self._brush, [_cell(desk, place) for place in places]))
        elif len(places) > 1:
            self._corner = places[0]
        elif before == places[0]:
            self._corner = None

    def turn(self, desk: Desk, place: int, amount: float) -> None:
        """Raise the reward of a cell."""
        self._pay_more(desk, [_cell(desk, place)], amount)

    def go_along(self, desk: Desk, step: tuple[int, int]) -> None:
        """Paint towards ``step``, or extend a rectangle."""
        before = desk.view.cursor_place
        if before is None:
            return
        there = desk.view.moved(before, *step)
        if self._brush is not ARROW:
            self.paint(desk, (before, there))
            return
        self._corner = before if self._corner is None else self._corner
        desk.view.put_cursor(there)

    def place_added(self, world: World) -> int | None:
        """Return the cell of an added row or column, once in ``world``."""
        grid = world.drawing
        if self._added is None or not isinstance(grid, Grid):
            return None
        size, place = self._added
        if size != (grid.rows, grid.columns):
            return None
        self._added = None
        return place

    # Brushes

    def take(self, brush: Brush, desk: Desk) -> None:
        """Take a brush, and paint the selected cells with it."""
        self._brush = brush
        self._fill_rectangle(desk)

    def choose(self, brush: Brush, desk: Desk) -> None:
        """Take a clicked brush, and paint a rectangle if there is one."""
        self._brush = brush
        if self._corner is not None:
            self._fill_rectangle(desk)

    def point(self, desk: Desk) -> None:
        """Drop the brush, so that clicks only move the cursor."""
        self._brush = ARROW

    def pick_up(self, desk: Desk) -> None:
        """Make the cell under the cursor the brush."""
        row, column = _here(desk)
        character = _map_of(desk).lines[row][column]
        self._brush = Brush(_PICK, character, called(_map_of(desk).legend.get(character)))

    def enter(self, desk: Desk) -> None:
        """Paint with the brush, or end a jump."""
        source, place = self._jump_from, desk.view.cursor_place
        if source is None or place is None:
            self._fill_rectangle(desk)
            return
        self._jump_from = None
        try:
            desk.draw(jump(_map_of(desk), _cell(desk, source), _cell(desk, place)))
        except ValueError as fault:
            desk.tell(str(fault))

    def fill(self, desk: Desk) -> None:
        """Paint the rectangle, or else the region of equal cells around the cursor."""
        if self._corner is not None:
            self._fill_rectangle(desk)
        elif self._brush is not ARROW:
            draft = _map_of(desk)
            desk.draw(painted(draft, self._brush, region(draft, _here(desk))))

    def _fill_rectangle(self, desk: Desk) -> None:
        if self._brush is ARROW:
            desk.tell("The arrow paints nothing: take a brush.")
            return
        draft, cells = _map_of(desk), self._cells(desk)
        rows, columns = self._rectangle(desk)
        self._corner = None
        filled = Edit("cell", (span(rows), span(columns)), character_of(draft, self._brush))
        desk.draw((*before_painting(draft, self._brush, cells), filled))

    # Jumps, rewards, rectangles, lines

    def begin_jump(self, desk: Desk) -> None:
        """Start a jump under the cursor."""
        self._jump_from = desk.view.cursor_place
        desk.tell("Go to the end of the jump, then press enter.")

    def cancel(self) -> bool:
        """Cancel an unfinished jump or rectangle. Return True if there was one."""
        had = self._jump_from is not None or self._corner is not None
        self._jump_from = self._corner = None
        return had

    def ask_reward(self, desk: Desk) -> None:
        """Ask for the reward of the selected cells."""
        draft, (rows, columns) = _map_of(desk), self._rectangle(desk)
        entry = draft.legend.get(draft.lines[rows.start][columns.start])
        now = 0.0 if entry is None else entry.pays
        hint = "What is paid on entering, or on leaving, as the map's rules say."
        desk.ask(
            Prompt("Reward of the cell", hint, f"{now:g}", number_in),
            lambda value: desk.draw((self._reward_edit(desk, float(value)),)),
        )

    def _reward_edit(self, desk: Desk, value: float) -> Edit:
        rows, columns = self._rectangle(desk)
        return Edit("reward", (span(rows), span(columns)), repr(value))

    def pay(self, amount: float, desk: Desk) -> None:
        """Raise the reward of the selected cells by ``amount``."""
        self._pay_more(desk, self._cells(desk), amount)

    def _pay_more(self, desk: Desk, cells: Sequence[Cell], amount: float) -> None:
        edits = paying_more(_map_of(desk), cells, amount)
        if edits:
            desk.draw(edits)
        else:
            desk.tell(_WALL_PAYS)

    def mark(self, desk: Desk) -> None:
        """Start a rectangle under the cursor, or drop the current one."""
        self._corner = desk.view.cursor_place if self._corner is None else None

    def copy(self, desk: Desk) -> None:
        """Copy the selected cells."""
        rows, columns = self._rectangle(desk)
        lines = _map_of(desk).lines
        self._copied = tuple(lines[row][columns.start : columns.stop] for row in rows)
        self._corner = None
        desk.tell(f"copied {len(rows)} × {len(columns)} cells: w v pastes them")

    def paste(self, desk: Desk) -> None:
        """Paste the copy at the cursor, clipped by the map."""
        draft, (top, left) = _map_of(desk), _here(desk)
        cells = {
            (top + row, left + column): character
            for row, line in enumerate(self._copied)
            for column, character in enumerate(line)
            if top + row < draft.rows and left + column < draft.columns
        }
        desk.draw(tuple(runs(list(cells), cells.__getitem__)))

    def resize(self, name: str, count: int, desk: Desk, *, at_end: bool = False) -> None:
        """Add a row or column before the cursor or ``at_end``, or remove one."""
        draft, (row, column) = _map_of(desk), _here(desk)
        self._corner = self._jump_from = None
        last, here = (draft.rows, row) if name == "rows" else (draft.columns, column)
        if count > 0 and not at_end:
            rows, columns = draft.rows + count * (name == "rows"), draft.columns + count * (name == "columns")
            self._added = (rows, columns), row * columns + column
        desk.draw((Edit(name, (), f"{count:+d}@{last if at_end else here}"),))

    def _rectangle(self, desk: Desk) -> tuple[range, range]:
        place = desk.view.cursor_place or 0
        corner = place if self._corner is None else self._corner
        (top, left), (bottom, right) = _cell(desk, corner), _cell(desk, place)
        rows, columns = sorted((top, bottom)), sorted((left, right))
        return range(rows[0], rows[1] + 1), range(columns[0], columns[1] + 1)

    def _cells(self, desk: Desk) -> list[Cell]:
        rows, columns = self._rectangle(desk)
        return [(row, column) for row in rows for column in columns]


def _map_of(desk: Desk) -> GridDraft:
    draft = desk.draft
    assert isinstance(draft, GridDraft)
    return draft


def _drawing(desk: Desk) -> Grid:
    drawing = desk.snapshot.world.drawing
    assert isinstance(drawing, Grid)
    return drawing


def _cell(desk: Desk, place: int) -> Cell:
    """Return the draft's cell of a place, even if its line was removed."""
    row, column = divmod(place, _drawing(desk).columns)
    return min(row, _map_of(desk).rows - 1), min(column, _map_of(desk).columns - 1)


def _here(desk: Desk) -> Cell:
    return _cell(desk, desk.view.cursor_place or 0)


def _wind(draft: GridDraft, name: str, line: int) -> float:
    wind = draft.rules.get(name)
    strength = wind[line] if isinstance(wind, list) and line < len(wind) else 0
    return float(strength) if isinstance(strength, int) else 0.0
