"""Tools to edit a map: brushes, rewards, rectangles, and whole rows or columns."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

from rl_tui.screen.dialogs.form import Prompt
from rl_tui.screen.panels.draw_panel import ToolCell, WorldNumber
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
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.world import World

# The tools, one row each


PICK, ARROW_KEY, MARK, JUMP, PASTE = "comma", "A", "m", "J", "p"
SLIPPERY, LEAVING, MOVES = "slippery", "on leaving", "moves"

MAP_TOOLS: Final = (
    *(
        Tool(
            each.key,
            "V" if each.key == "V" else each.character,
            each.word,
            each.sentence,
            partial(lambda brush, box, desk: box.take(brush, desk), each),
            rank,
            click=partial(lambda brush, box, desk: box.choose(brush, desk), each),
            name=each.name,
        )
        for rank, each in enumerate(BRUSHES)
    ),
    Tool(
        JUMP,
        "J",
        "jump",
        "Let a jump begin here; enter, or a click, says where it leads.",
        lambda box, desk: box.begin_jump(desk),
        20,
    ),
    Tool(
        ARROW_KEY,
        "A",
        "arrow",
        "Let a click move the cursor only, and a drag mark a rectangle.",
        lambda box, desk: box.point(desk),
    ),
    Tool(
        PICK,
        ",",
        "pick up",
        "Take what is under the cursor for the brush.",
        lambda box, desk: box.pick_up(desk),
    ),
    Tool(
        "enter",
        "enter",
        "paint",
        "Paint with the brush.",
        lambda box, desk: box.enter(desk),
        9,
        in_panel=False,
    ),
    Tool("equals_sign", "=", "reward", "Type what the cell pays.", lambda box, desk: box.ask_reward(desk), 6),
    Tool("plus", "+", "pays +1", "Let the cell pay 1 more.", lambda box, desk: box.pay(1.0, desk), 16),
    Tool("minus", "−", "pays −1", "Let the cell pay 1 less.", lambda box, desk: box.pay(-1.0, desk), 17),
    Tool(
        MARK,
        "m",
        "mark",
        "Begin a rectangle at the cursor, or drop it.",
        lambda box, desk: box.mark(desk),
        18,
    ),
    Tool("y", "y", "copy", "Copy the rectangle.", lambda box, desk: box.copy(desk)),
    Tool(PASTE, "p", "paste", "Put down what was copied.", lambda box, desk: box.paste(desk)),
    Tool(
        "F",
        "F",
        "fill",
        "Fill the rectangle, or the region around the cursor.",
        lambda box, desk: box.fill(desk),
        19,
    ),
    Tool("i", "i", "row +", "Add a row here.", lambda box, desk: box.resize("rows", 1, desk), 12),
    Tool("u", "u", "row −", "Take this row away.", lambda box, desk: box.resize("rows", -1, desk), 13),
    Tool(
        "R",
        "R",
        "row last",
        "Add a row at the bottom.",
        lambda box, desk: box.resize("rows", 1, desk, at_end=True),
    ),
    Tool("I", "I", "column +", "Add a column here.", lambda box, desk: box.resize("columns", 1, desk), 14),
    Tool(
        "U", "U", "column −", "Take this column away.", lambda box, desk: box.resize("columns", -1, desk), 15
    ),
    Tool(
        "N",
        "N",
        "col last",
        "Add a column at the right.",
        lambda box, desk: box.resize("columns", 1, desk, at_end=True),
    ),
    Tool(
        "",
        "",
        SLIPPERY,
        "Let each of three moves be as likely, as on Gymnasium's ice, or not.",
        lambda _, desk: next_word(desk, "slippery"),
    ),
    Tool(
        "",
        "",
        LEAVING,
        "Let cells pay on leaving them, or on entering.",
        lambda _, desk: next_word(desk, "rewards"),
    ),
    Tool(
        "",
        "",
        MOVES,
        "Choose the next kind of moves: four, clockwise, king, king+stay.",
        lambda _, desk: next_word(desk, "moves"),
    ),
    Tool(
        "o",
        "o",
        "rules",
        "The rules of the map: noise, slip, living reward, wind, time limit.",
        ask_rules,
        7,
    ),
)


# What they do


ARROW: Final = Brush(ARROW_KEY, "", "arrow")
"""In place of a brush: a click moves the cursor only."""
_WALL_PAYS: Final = "a wall pays nothing: nobody enters it"
_NOTHING_COPIED: Final = "nothing is copied yet: m marks a corner, y copies up to the cursor"


class MapTools(Toolbox):
    """Draws on a map. It remembers the brush, a corner, what was copied, and where a jump begins."""

    tools = MAP_TOOLS

    def __init__(self) -> None:
        self._brush = BRUSHES[1]
        self._corner: int | None = None
        self._copied: tuple[str, ...] = ()
        self._jump_from: int | None = None
        self._added: tuple[tuple[int, int], int] | None = None  # the size of the map with it, and its cell

    # What is shown

    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return what stands under the cursor, and what it pays."""
        if self._jump_from is not None:
            return "enter: the jump leads to here · esc: no jump", "enter: jump to here"
        row, column = _here(desk)
        character = _map_of(desk).lines[row][column]
        entry = _map_of(desk).legend.get(character)
        reward = "" if entry is None or entry.is_wall else f" pays {number_text(entry.pays)}"
        where, what = f"row {row}, column {column}", f"{character} {called(entry)}{reward}"
        rows, columns = self._rectangle(desk)
        size = f"{len(rows)} × {len(columns)} cells · " if self._corner is not None else ""
        return f"{size}{where}: {what}", f"{size}{what}", what

    @property
    def in_hand(self) -> str:
        """The brush in force."""
        return "" if self._jump_from is not None else f"brush {self._brush_shown}"

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return what a click or a drag does with the brush."""
        if self._jump_from is not None:
            return ("click where the jump leads",)
        if self._brush is ARROW:
            return "click: cursor · drag: rectangle · wheel: reward", "click: cursor · drag: rectangle"
        brush = self._brush_shown
        with_keys = f"enter, shift+arrow, click, drag: {brush}"
        return f"{with_keys} · wheel: reward", with_keys, f"click or drag: {brush}"

    @property
    def _brush_shown(self) -> str:
        return f"{self._brush.character} {self._brush.word}".strip()

    def cell(self, tool: Tool, desk: Desk) -> ToolCell:
        """Return how the panel shows ``tool``: the brush in force stands out, and what is switched on."""
        word, moves = tool.word, str(rule_of(desk.draft, "moves"))
        if tool.id == MOVES:
            word = f"{moves} moves" if moves == "four" else moves
        is_on = {
            MARK: self._corner is not None,
            JUMP: self._jump_from is not None,
            SLIPPERY: rule_of(desk.draft, "slippery") is True,
            LEAVING: rule_of(desk.draft, "rewards") == "leaving",
        }.get(tool.id, bool(tool.key) and tool.key == self._brush.key)
        refused = _NOTHING_COPIED if tool.id == PASTE and not self._copied else ""
        return ToolCell(tool.id, tool.shown, word, is_on=is_on, refused=refused)

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return the numbers of the map, what the cell pays, and the wind where it is."""
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

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set one of them. Raises ValueError, in words, where it cannot be that."""
        draft, (row, column) = _map_of(desk), _here(desk)
        if name == PAYS.name:
            if not pays(draft, *self._rectangle(desk)):
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

    # The pointer, and keys that move

    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Paint the brush at ``places``; the arrow marks them, and a jump that was begun ends there."""
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
        """Let a cell pay so much more."""
        self._pay_more(desk, [_cell(desk, place)], amount)

    def go_along(self, desk: Desk, step: tuple[int, int]) -> None:
        """Paint under the cursor and where it moves; the arrow marks a rectangle on the way."""
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
        """Return the cell of the row or column that was added before the cursor, once it is there."""
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
        """Take a brush, and paint with it what is picked."""
        self._brush = brush
        self._fill_rectangle(desk)

    def choose(self, brush: Brush, desk: Desk) -> None:
        """Take a brush that was clicked; only a rectangle is painted at once."""
        self._brush = brush
        if self._corner is not None:
            self._fill_rectangle(desk)

    def point(self, desk: Desk) -> None:
        """Let a click move the cursor only."""
        self._brush = ARROW

    def pick_up(self, desk: Desk) -> None:
        """Take what is under the cursor for the brush."""
        row, column = _here(desk)
        character = _map_of(desk).lines[row][column]
        self._brush = Brush(PICK, character, called(_map_of(desk).legend.get(character)))

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
        """Paint the rectangle, or else the whole region of cells like the one under the cursor."""
        if self._corner is not None:
            self._fill_rectangle(desk)
        elif self._brush is not ARROW:
            draft = _map_of(desk)
            desk.draw(painted(draft, self._brush, region(draft, _here(desk))))

    def _fill_rectangle(self, desk: Desk) -> None:
        if self._brush is ARROW:
            desk.tell("the arrow paints nothing: take a brush")
            return
        draft, cells = _map_of(desk), self._cells(desk)
        rows, columns = self._rectangle(desk)
        self._corner = None
        filled = Edit("cell", (span(rows), span(columns)), character_of(draft, self._brush))
        desk.draw((*before_painting(draft, self._brush, cells), filled))

    # Jumps, rewards, rectangles, lines

    def begin_jump(self, desk: Desk) -> None:
        """Let a jump begin under the cursor."""
        self._jump_from = desk.view.cursor_place
        desk.tell("move to where the jump leads, then enter; or click there")

    def cancel(self) -> bool:
        """Forget a jump or a rectangle that was begun; return whether there was one."""
        had = self._jump_from is not None or self._corner is not None
        self._jump_from = self._corner = None
        return had

    def ask_reward(self, desk: Desk) -> None:
        """Type what the cells that are picked pay."""
        draft, (rows, columns) = _map_of(desk), self._rectangle(desk)
        if not pays(draft, rows, columns):
            desk.tell(_WALL_PAYS)
            return
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
        """Let what is picked pay so much more."""
        self._pay_more(desk, self._cells(desk), amount)

    def _pay_more(self, desk: Desk, cells: Sequence[Cell], amount: float) -> None:
        edits = paying_more(_map_of(desk), cells, amount)
        if edits:
            desk.draw(edits)
        else:
            desk.tell(_WALL_PAYS)

    def mark(self, desk: Desk) -> None:
        """Begin a rectangle under the cursor, or drop the one there is."""
        self._corner = desk.view.cursor_place if self._corner is None else None

    def copy(self, desk: Desk) -> None:
        """Copy what is picked."""
        rows, columns = self._rectangle(desk)
        lines = _map_of(desk).lines
        self._copied = tuple(lines[row][columns.start : columns.stop] for row in rows)
        self._corner = None
        desk.tell(f"copied {len(rows)} × {len(columns)} cells: p puts them down")

    def paste(self, desk: Desk) -> None:
        """Put down what was copied, its upper left corner under the cursor, as far as the map goes."""
        if not self._copied:
            desk.tell(_NOTHING_COPIED)
            return
        draft, (top, left) = _map_of(desk), _here(desk)
        cells = {
            (top + row, left + column): character
            for row, line in enumerate(self._copied)
            for column, character in enumerate(line)
            if top + row < draft.rows and left + column < draft.columns
        }
        desk.draw(tuple(runs(list(cells), cells.__getitem__)))

    def resize(self, name: str, count: int, desk: Desk, *, at_end: bool = False) -> None:
        """Add a row or a column before the cursor, or ``at_end``, or take away the one it is in."""
        if desk.snapshot.editor.unfinished:
            desk.tell("finish the map first: lines are added and taken where it is whole")
            return
        draft, (row, column) = _map_of(desk), _here(desk)
        self._corner = self._jump_from = None
        last, here = (draft.rows, row) if name == "rows" else (draft.columns, column)
        if count > 0 and not at_end:
            rows, columns = draft.rows + count * (name == "rows"), draft.columns + count * (name == "columns")
            self._added = (rows, columns), row * columns + column
        desk.draw((Edit(name, (), f"{count:+d}@{last if at_end else here}"),))

    def _rectangle(self, desk: Desk) -> tuple[range, range]:
        """Return the rows and columns from the corner to the cursor; without a corner those of one cell."""
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
    """Return row and column of a place of the picture; a line that is being taken away has the next ones."""
    row, column = divmod(place, _drawing(desk).columns)
    return min(row, _map_of(desk).rows - 1), min(column, _map_of(desk).columns - 1)


def _here(desk: Desk) -> Cell:
    return _cell(desk, desk.view.cursor_place or 0)


def _wind(draft: GridDraft, name: str, line: int) -> float:
    wind = draft.rules.get(name)
    strength = wind[line] if isinstance(wind, list) and line < len(wind) else 0
    return float(strength) if isinstance(strength, int) else 0.0
