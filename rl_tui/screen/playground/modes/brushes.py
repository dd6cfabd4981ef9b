"""Edits of maps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import groupby
from typing import Final, NamedTuple

from rl_tui.screen.panels.draw_panel import Sign
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.editing.edit import Edit, as_json
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.grid.map import FLOOR, START, LegendEntry

Cell = tuple[int, int]
"""Row and column."""
_FREE: Final = "abcdefghijklmnopqrstuwxyz"


def _one_way(place: int, glyphs: Glyphs) -> str:
    return glyphs.one_way[place]


class Brush(NamedTuple):
    """A ``character`` to paint, and its ``entry`` in a legend."""

    key: str
    character: str
    label: str
    sentence: str = ""
    sign: Sign | None = None
    entry: LegendEntry | None = None


BRUSHES: Final = (
    Brush(
        "full_stop",
        FLOOR,
        "floor",
        "Paint floor: a free cell.",
        Sign(CellKind.FLOOR, lambda glyphs: glyphs.untried),
    ),
    Brush("number_sign", "#", "wall", "Paint a wall.", Sign(CellKind.WALL, lambda glyphs: glyphs.wall * 3)),
    Brush("S", START, "start", "Let episodes start here.", Sign(CellKind.START, lambda _: START)),
    Brush(
        "G",
        "G",
        "goal",
        "Paint a goal: pays 1, the episode ends.",
        Sign(CellKind.GOAL, lambda glyphs: glyphs.goal),
    ),
    Brush(
        "H",
        "H",
        "hole",
        "Paint a hole: the episode ends in it.",
        Sign(CellKind.HOLE, lambda glyphs: glyphs.hole),
    ),
    Brush(
        "C",
        "C",
        "cliff",
        "Paint a cliff: costs 100, back to start.",
        Sign(CellKind.CLIFF, lambda glyphs: glyphs.cliff * 3),
        LegendEntry(kind=CellKind.CLIFF, back=True, reward=-100.0),
    ),
    Brush(
        "X",
        "X",
        "exit",
        "Paint an exit: leaving pays 1, the episode ends.",
        Sign(CellKind.GOAL, lambda _: "1"),
        LegendEntry(kind=CellKind.GOAL, exit=True),
    ),
    *(
        Brush(
            key,
            character,
            f"one-way {way}",
            f"Paint a cell that only leads {way}.",
            Sign(CellKind.FLOOR, partial(_one_way, place)),
        )
        for place, (key, character, way) in enumerate(
            (
                ("less_than_sign", "<", "left"),
                ("greater_than_sign", ">", "right"),
                ("circumflex_accent", "^", "up"),
                ("V", "v", "down"),
            )
        )
    ),
)


def painted(draft: GridDraft, brush: Brush, cells: Sequence[Cell]) -> tuple[Edit, ...]:
    """Paint ``brush`` on ``cells``."""
    character = character_of(draft, brush)
    return (*before_painting(draft, brush, cells), *runs(cells, lambda _: character))


def character_of(draft: GridDraft, brush: Brush) -> str:
    """Return the brush's character in this map."""
    if brush.entry is None:
        return brush.character
    same = (
        character
        for character, entry in draft.legend.items()
        if (entry.kind, entry.exit, entry.back) == (brush.entry.kind, brush.entry.exit, brush.entry.back)
    )
    return next(same, brush.character)


def before_painting(draft: GridDraft, brush: Brush, cells: Sequence[Cell]) -> Iterator[Edit]:
    """Yield edits needed first: add a legend entry, remove the old start."""
    legend, character = draft.legend, character_of(draft, brush)
    if brush.entry is not None and character not in legend:
        raw = brush.entry.model_dump(mode="json", exclude_defaults=True)
        yield Edit("legend", (character,), as_json(raw))
    starts = {each for each, entry in legend.items() if entry.kind is CellKind.START}
    if character in starts:
        inside = frozenset(cells)
        for row, line in enumerate(draft.lines):
            for column, there in enumerate(line):
                if there in starts and (row, column) not in inside:
                    yield Edit("cell", at(row, column), FLOOR)


def called(entry: LegendEntry | None) -> str:
    """Name a cell with that legend ``entry``."""
    if entry is None:
        return "unknown"
    if entry.jump is not None:
        return f"{entry.kind}, jumps to {entry.jump}"
    if entry.only:
        return f"only {' or '.join(entry.only)}"
    return "exit" if entry.exit else str(entry.kind)


def jump(draft: GridDraft, source: Cell, target: Cell) -> tuple[Edit, ...]:
    """Make every action in ``source`` lead to ``target``. Raises ValueError if there can be no jump."""
    if source == target:
        raise ValueError("a jump leads to another cell")
    legend = draft.legend
    from_, there = (draft.lines[row][column] for row, column in (source, target))
    if from_ not in legend or there not in legend or legend[from_].is_wall or legend[there].is_wall:
        raise ValueError("a jump leads from one cell to another, not from a wall")
    taken = {*legend, *"".join(draft.lines)}
    free = [each for each in _FREE if each not in taken]
    if len(free) < 2:
        raise ValueError("no character is left for a jump")
    edits, landing = list[Edit](), there
    if sum(line.count(there) for line in draft.lines) != 1:
        landing = free.pop()
        entry = legend[there].model_dump(mode="json", exclude_defaults=True)
        edits += [Edit("legend", (landing,), as_json(entry)), Edit("cell", at(*target), landing)]
    leaping = legend[from_]
    kept: dict[str, object] = {"kind": str(leaping.kind), "jump": landing}
    if leaping.reward is not None:
        kept["reward"] = leaping.reward
    if leaping.kind in (CellKind.GOAL, CellKind.HOLE):
        kept["terminal"] = False
    jumper = free.pop()
    edits.append(Edit("legend", (jumper,), as_json(kept)))
    return (*edits, Edit("cell", at(*source), jumper))


def region(draft: GridDraft, start: Cell) -> list[Cell]:
    """Return the connected equal cells."""
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


def paying_more(draft: GridDraft, cells: Sequence[Cell], amount: float) -> list[Edit]:
    """Raise the reward of ``cells``, except walls."""
    legend, pay = draft.legend, dict[Cell, str]()
    for row, column in cells:
        entry = legend.get(draft.lines[row][column])
        if entry is not None and not entry.is_wall:
            pay[row, column] = repr(round(entry.pays + amount, 10))
    return list(runs(list(pay), pay.__getitem__, "reward"))


def pays(draft: GridDraft, rows: range, columns: range) -> bool:
    """Return whether any cell can have a reward."""
    there = {character for row in rows for character in draft.lines[row][columns.start : columns.stop]}
    return any(entry is not None and not entry.is_wall for entry in map(draft.legend.get, there))


def runs(cells: Sequence[Cell], value: Callable[[Cell], str], name: str = "cell") -> Iterator[Edit]:
    """Yield one edit per stretch of equal values."""
    ordered = sorted(set(cells))
    for (row, _, what), group in groupby(
        enumerate(ordered), key=lambda each: (each[1][0], each[1][1] - each[0], value(each[1]))
    ):
        columns = [column for _, (_, column) in group]
        yield Edit(name, (str(row), span(range(columns[0], columns[-1] + 1))), what)


def at(row: int, column: int) -> tuple[str, str]:
    """Write one cell's place in an edit."""
    return str(row), str(column)


def span(lines: range) -> str:
    """Write a range of rows or columns."""
    return str(lines.start) if len(lines) == 1 else f"{lines.start}:{lines.stop}"
