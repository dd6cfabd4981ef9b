"""The tools for maps: brushes, rewards, rectangles, rows and columns."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import groupby
from typing import Final, NamedTuple

from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.screens.playground.actions.modes.editing.rules import ask_rules
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Hand, Tool, Toolbox
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.editing.edit import Edit, as_json
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.grid.legend import LegendEntry
from rl_tui.worlds.grid.map import FLOOR, START

_FREE: Final = "abcdefghijklmnopqrstuwxyz"


class Brush(NamedTuple):
    """What a key paints: a ``character`` of the map, and what it means where no legend says it."""

    key: str
    character: str
    word: str
    entry: LegendEntry | None = None


BRUSHES: Final = (
    Brush("full_stop", FLOOR, "floor"),
    Brush("number_sign", "#", "wall"),
    Brush("H", "H", "hole"),
    Brush("G", "G", "goal"),
    Brush("S", START, "start"),
    Brush("C", "C", "cliff", LegendEntry(kind=CellKind.CLIFF, back=True, reward=-100.0)),
    Brush("X", "X", "exit", LegendEntry(kind=CellKind.GOAL, exit=True)),
    Brush("less_than_sign", "<", "only left"),
    Brush("greater_than_sign", ">", "only right"),
    Brush("circumflex_accent", "^", "only up"),
    Brush("V", "v", "only down"),
)


class MapTools(Toolbox):
    """Draws on a map. It remembers the brush, a corner, what was copied, and where a jump begins."""

    def __init__(self) -> None:
        self._brush = BRUSHES[1]
        self._corner: int | None = None
        self._copied: tuple[str, ...] = ()
        self._jump_from: int | None = None

    def about(self, hand: Hand) -> tuple[str, ...]:
        """Return what stands under the cursor, and what it pays."""
        if self._jump_from is not None:
            return "enter: the jump leads to here · esc: no jump", "enter: jump to here"
        place, draft = hand.view.cursor_place, _map_of(hand)
        if place is None or place >= draft.rows * draft.columns:
            return ()
        row, column = divmod(place, draft.columns)
        character = draft.lines[row][column]
        entry = draft.legend.get(character)
        pays = "" if entry is None or entry.is_wall else f" pays {entry.pays:g}"
        where, what = f"row {row}, column {column}", f"{character} {_called(entry)}{pays}"
        rows, columns = self._rectangle(hand)
        size = f"{len(rows)} × {len(columns)} cells · " if self._corner is not None else ""
        brush = f"brush {self._brush.character} {self._brush.word}"
        return f"{size}{where}: {what} · {brush}", f"{size}{what} · {brush}", f"{size}{what}", what

    def picked(self, hand: Hand) -> frozenset[int]:
        """Return the cells of the rectangle."""
        if self._corner is None:
            return frozenset()
        rows, columns = self._rectangle(hand)
        width = _map_of(hand).columns
        return frozenset(row * width + column for row in rows for column in columns)

    def paint(self, hand: Hand, places: Sequence[int]) -> None:
        """Paint the brush at ``places``."""
        draft = _map_of(hand)
        hand.view.put_cursor(places[-1])
        cells = [divmod(place, draft.columns) for place in dict.fromkeys(places)]
        hand.draw((*_brush_edits(draft, self._brush, cells), *_runs(cells, lambda _: self._character(draft))))

    def turn(self, hand: Hand, place: int, amount: float) -> None:
        """Let a cell pay so much more."""
        self._pay_more(hand, [place], amount)

    def take(self, brush: Brush, hand: Hand) -> None:
        """Take a brush, and paint with it what is picked."""
        self._brush = brush
        self._fill_rectangle(hand)

    def enter(self, hand: Hand) -> None:
        """Paint with the brush, or end a jump."""
        if self._jump_from is None:
            self._fill_rectangle(hand)
            return
        draft, source, place = _map_of(hand), self._jump_from, hand.view.cursor_place
        self._jump_from = None
        if place is None or place == source:
            hand.tell("a jump leads to another cell")
            return
        hand.draw(_jump(draft, source, place))

    def begin_jump(self, hand: Hand) -> None:
        """Let a jump begin under the cursor."""
        self._jump_from = hand.view.cursor_place
        hand.tell("move to where the jump leads, then enter")

    def cancel(self) -> bool:
        """Forget a jump or a rectangle that was begun; return whether there was one."""
        had = self._jump_from is not None or self._corner is not None
        self._jump_from = self._corner = None
        return had

    def ask_reward(self, hand: Hand) -> None:
        """Type what the cells that are picked pay."""
        draft, cells = _map_of(hand), self._cells(hand)
        row, column = cells[0]
        entry = draft.legend.get(draft.lines[row][column])
        pays = 0.0 if entry is None else entry.pays
        rows, columns = self._rectangle(hand)
        at = (_range(rows), _range(columns))
        hint = "What is paid on entering, or on leaving, as the map's rules say."
        hand.ask(
            Prompt("Reward of the cell", hint, f"{pays:g}", _number),
            lambda value: hand.draw((Edit("reward", at, repr(value)),)),
        )

    def pay(self, amount: float, hand: Hand) -> None:
        """Let what is picked pay so much more."""
        width = _map_of(hand).columns
        self._pay_more(hand, [row * width + column for row, column in self._cells(hand)], amount)

    def mark(self, hand: Hand) -> None:
        """Begin a rectangle under the cursor, or drop the one there is."""
        self._corner = hand.view.cursor_place if self._corner is None else None

    def copy(self, hand: Hand) -> None:
        """Copy what is picked."""
        rows, columns = self._rectangle(hand)
        lines = _map_of(hand).lines
        self._copied = tuple(lines[row][columns.start : columns.stop] for row in rows)
        self._corner = None
        hand.tell(f"copied {len(rows)} × {len(columns)} cells: p puts them down")

    def paste(self, hand: Hand) -> None:
        """Put down what was copied, its upper left corner under the cursor, as far as the map goes."""
        place, draft = hand.view.cursor_place, _map_of(hand)
        if not self._copied or place is None:
            hand.tell("nothing is copied yet: m marks a corner, y copies up to the cursor")
            return
        top, left = divmod(place, draft.columns)
        cells = {
            (top + row, left + column): character
            for row, line in enumerate(self._copied)
            for column, character in enumerate(line)
            if top + row < draft.rows and left + column < draft.columns
        }
        hand.draw(tuple(_runs(list(cells), cells.__getitem__)))

    def fill(self, hand: Hand) -> None:
        """Paint the rectangle, or else the whole region of cells like the one under the cursor."""
        place, draft = hand.view.cursor_place, _map_of(hand)
        if self._corner is not None or place is None:
            self._fill_rectangle(hand)
            return
        cells = _region(draft, divmod(place, draft.columns))
        hand.draw((*_brush_edits(draft, self._brush, cells), *_runs(cells, lambda _: self._character(draft))))

    def resize(self, name: str, count: int, hand: Hand) -> None:
        """Add a row or a column before the cursor, or take away the one it is in."""
        place, draft = hand.view.cursor_place, _map_of(hand)
        if hand.snapshot.editor.unfinished:
            hand.tell("finish the map first: lines are added and taken where it is whole")
            return
        row, column = divmod(place or 0, draft.columns)
        self._corner = None
        hand.draw((Edit(name, (), f"{count:+d}@{row if name == 'rows' else column}"),))

    def _pay_more(self, hand: Hand, places: Sequence[int], amount: float) -> None:
        draft = _map_of(hand)
        cells = [divmod(place, draft.columns) for place in places]
        edits = []
        for character, group in groupby(
            sorted(cells, key=lambda cell: draft.lines[cell[0]][cell[1]]),
            key=lambda cell: draft.lines[cell[0]][cell[1]],
        ):
            entry = draft.legend.get(character)
            if entry is not None and not entry.is_wall:
                pays = repr(round(entry.pays + amount, 10))
                edits += [Edit("reward", _at(cell), pays) for cell in group]
        if edits:
            hand.draw(edits)
        else:
            hand.tell("a wall pays nothing: nobody enters it")

    def _fill_rectangle(self, hand: Hand) -> None:
        draft, cells = _map_of(hand), self._cells(hand)
        rows, columns = self._rectangle(hand)
        self._corner = None
        at = (_range(rows), _range(columns))
        hand.draw((*_brush_edits(draft, self._brush, cells), Edit("cell", at, self._character(draft))))

    def _character(self, draft: GridDraft) -> str:
        return _character_of(draft, self._brush)

    def _rectangle(self, hand: Hand) -> tuple[range, range]:
        """Return the rows and columns from the corner to the cursor; without a corner those of one cell."""
        width = _map_of(hand).columns
        place = hand.view.cursor_place or 0
        corner = place if self._corner is None else self._corner
        (top, left), (bottom, right) = divmod(corner, width), divmod(place, width)
        rows, columns = sorted((top, bottom)), sorted((left, right))
        return range(rows[0], rows[1] + 1), range(columns[0], columns[1] + 1)

    def _cells(self, hand: Hand) -> list[tuple[int, int]]:
        rows, columns = self._rectangle(hand)
        return [(row, column) for row in rows for column in columns]

    tools = (
        *(
            Tool(
                each.key,
                each.character if each.key != "V" else "V",
                each.word,
                f"Paint {each.word}.",
                partial(lambda brush, box, hand: box.take(brush, hand), each),
                rank,
            )
            for rank, each in enumerate(BRUSHES)
        ),
        Tool("J", "J", "jump", "Let a jump begin here; enter says where it leads.", begin_jump, 20),
        Tool("enter", "enter", "paint", "Paint with the brush.", enter, 9),
        Tool("equals_sign", "=", "reward", "Type what the cell pays.", ask_reward, 6),
        Tool(
            "plus", "+", "+1", "Let the cell pay 1 more.", partial(lambda box, hand: box.pay(1.0, hand)), 16
        ),
        Tool(
            "minus", "−", "−1", "Let the cell pay 1 less.", partial(lambda box, hand: box.pay(-1.0, hand)), 17
        ),
        Tool("m", "m", "mark", "Begin a rectangle at the cursor, or drop it.", mark, 18),
        Tool("y", "y", "copy", "Copy the rectangle.", copy),
        Tool("p", "p", "paste", "Put down what was copied.", paste),
        Tool("F", "F", "fill", "Fill the rectangle, or the region around the cursor.", fill, 19),
        Tool("i", "i", "row +", "Add a row here.", lambda box, hand: box.resize("rows", 1, hand), 12),
        Tool("u", "u", "row −", "Take this row away.", lambda box, hand: box.resize("rows", -1, hand), 13),
        Tool(
            "I", "I", "column +", "Add a column here.", lambda box, hand: box.resize("columns", 1, hand), 14
        ),
        Tool(
            "U",
            "U",
            "column −",
            "Take this column away.",
            lambda box, hand: box.resize("columns", -1, hand),
            15,
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


def _map_of(hand: Hand) -> GridDraft:
    draft = hand.draft
    assert isinstance(draft, GridDraft)
    return draft


def _called(entry: LegendEntry | None) -> str:
    if entry is None:
        return "unknown"
    if entry.jump is not None:
        return f"jumps to {entry.jump}"
    if entry.only:
        return f"only {' or '.join(entry.only)}"
    return "exit" if entry.exit else str(entry.kind)


def _character_of(draft: GridDraft, brush: Brush) -> str:
    """Return what ``brush`` paints: a character that means that already, else its own."""
    if brush.entry is None:
        return brush.character
    same = (
        character
        for character, entry in draft.legend.items()
        if (entry.kind, entry.exit, entry.back) == (brush.entry.kind, brush.entry.exit, brush.entry.back)
    )
    return next(same, brush.character)


def _brush_edits(draft: GridDraft, brush: Brush, cells: Sequence[tuple[int, int]]) -> Iterator[Edit]:
    """Yield what has to be done before ``brush`` paints: a legend for its character, the start moved away."""
    if brush.entry is not None and _character_of(draft, brush) not in draft.legend:
        raw = brush.entry.model_dump(mode="json", exclude_defaults=True)
        yield Edit("legend", (brush.character,), as_json(raw))
    if brush.character == START:
        starts = {each for each, entry in draft.legend.items() if entry.kind is CellKind.START}
        for row, line in enumerate(draft.lines):
            for column, character in enumerate(line):
                if character in starts and (row, column) not in cells:
                    yield Edit("cell", _at((row, column)), FLOOR)


def _jump(draft: GridDraft, source: int, target: int) -> tuple[Edit, ...]:
    """Return the edits by which every action in the cell ``source`` leads to ``target``."""
    taken = {*draft.legend, *"".join(draft.lines)}
    free = [each for each in _FREE if each not in taken]
    (row, column), to = divmod(source, draft.columns), divmod(target, draft.columns)
    there = draft.lines[to[0]][to[1]]
    edits, landing = list[Edit](), there
    if sum(line.count(there) for line in draft.lines) != 1:
        landing = free.pop()
        entry = draft.legend[there].model_dump(mode="json", exclude_defaults=True)
        edits += [Edit("legend", (landing,), as_json(entry)), Edit("cell", _at(to), landing)]
    jumper = free.pop()
    edits.append(Edit("legend", (jumper,), as_json({"kind": "floor", "jump": landing})))
    return (*edits, Edit("cell", _at((row, column)), jumper))


def _region(draft: GridDraft, start: tuple[int, int]) -> list[tuple[int, int]]:
    """Return the cells of the same character that hang together with ``start``."""
    lines, found, left = draft.lines, {start}, [start]
    wanted = lines[start[0]][start[1]]
    while left:
        row, column = left.pop()
        for cell in ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)):
            inside = 0 <= cell[0] < draft.rows and 0 <= cell[1] < draft.columns
            if inside and cell not in found and lines[cell[0]][cell[1]] == wanted:
                found.add(cell)
                left.append(cell)
    return sorted(found)


def _runs(cells: Sequence[tuple[int, int]], character: Callable[[tuple[int, int]], str]) -> Iterator[Edit]:
    """Yield the edits that paint ``cells``, one for each stretch of the same character in a row."""
    ordered = sorted(set(cells))
    for (row, _, painted), group in groupby(
        enumerate(ordered), key=lambda each: (each[1][0], each[1][1] - each[0], character(each[1]))
    ):
        columns = [column for _, (_, column) in group]
        yield Edit("cell", (str(row), _range(range(columns[0], columns[-1] + 1))), painted)


def _at(cell: tuple[int, int]) -> tuple[str, str]:
    return str(cell[0]), str(cell[1])


def _range(lines: range) -> str:
    return str(lines.start) if len(lines) == 1 else f"{lines.start}:{lines.stop}"


def _number(text: str) -> float:
    try:
        return float(text.replace("−", "-"))
    except ValueError:
        raise ValueError("expected a number, such as -1 or 0.5") from None
