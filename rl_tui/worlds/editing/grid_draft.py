"""The draft of a map: cells, rewards, rules, rows and columns."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.common.limits import LONGEST_SIDE, MOST_CELLS, MOST_CHARACTERS
from rl_tui.common.streams import streams
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.edit import (
    Edit,
    lines_added,
    named,
    number_in,
    place_in,
    places_in,
    plain_value,
    rule_value,
)
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.grid.map import BUILT_IN, FLOOR, CellMap, LegendEntry, is_character, lines_of
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.sections.schema import parsed

if TYPE_CHECKING:
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.space import IntArray
    from rl_tui.worlds.world import World

# Characters for cells with their own reward. A digit equal to the reward comes first
_MINTED: Final = "abcdefghijklmnopqrstuwxyzABCDEFIJKLMNOPQRTUVWXYZ0123456789"
_NOT_RULES: Final = ("map", "random", "legend", "wind", "wind_rows")
RULES: Final = tuple(name for name in GridSection.model_fields if name not in _NOT_RULES)
"""Settings for the whole map, named like the keys of the file."""


@dataclass(frozen=True, eq=False)
class GridDraft(Draft):
    """Rows of characters, and the rest of the table.

    Lines keep their `row_ids` and `column_ids` even when they move; a new line takes `next_id`. Characters
    invented for single rewards, `minted`, disappear with their last cell.
    """

    kind = "grid"
    section_class = GridSection
    lines: tuple[str, ...]
    rules: Mapping[str, Any]
    row_ids: tuple[int, ...]
    column_ids: tuple[int, ...]
    next_id: int
    minted: frozenset[str] = frozenset()

    @property
    def table(self) -> dict[str, Any]:
        """The table for a file."""
        return {"map": "\n".join(self.lines) + "\n", **self.rules}

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.row_ids)

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.column_ids)

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.rows * self.columns

    @property
    def legend(self) -> Mapping[str, LegendEntry]:
        """Meaning of each valid character."""
        own = {key: parsed(LegendEntry, raw)[0] for key, raw in self._raw_legend.items()}
        return {**BUILT_IN, **{key: entry for key, entry in own.items() if entry is not None}}

    @property
    def _raw_legend(self) -> Mapping[str, Any]:
        legend = self.rules.get("legend")
        return legend if isinstance(legend, Mapping) else {}

    def edited(self, edit: Edit) -> GridDraft:
        """Return the draft after `edit`."""
        if edit.name in RULES:
            return replace(self, rules={**self.rules, edit.name: rule_value(edit)})
        make = _EDITS.get(edit.name)
        if make is None:
            known = (*_EDITS, *RULES)
            what = f"a map has nothing called {shown(edit.name)}{near(edit.name, known)}"
            raise UserError(f"{what}; choose one of {', '.join(known)}")
        return make(self, edit)

    def state_keys(self, world: World) -> IntArray:
        """Return an identity of row and column for each state, [S]."""
        import numpy as np

        assert isinstance(world.drawing, Grid)
        cells = np.array(world.drawing.cell_of_state, dtype=np.int64)
        rows, columns = np.divmod(cells, self.columns)
        row_ids, column_ids = np.array(self.row_ids), np.array(self.column_ids)
        keys: IntArray = row_ids[rows] * 2**31 + column_ids[columns]
        return keys

    def cells_in(self, edit: Edit) -> tuple[range, range]:
        """Return the rows and columns that `edit` names."""
        return places_in(edit, ("row", self.rows), ("column", self.columns))


def grid_draft(scenario: Scenario, seed: int) -> GridDraft:
    """Return the draft of a ``[grid]`` scenario, with a map drawn from `seed`."""
    section = scenario.section
    assert isinstance(section, GridSection)
    rules = dict(tables_in(scenario.text)["grid"])
    text = rules.pop("map", None)
    rules.pop("random", None)
    lines = lines_of(text) if text is not None else drawn_lines(section.cells(streams(seed).world))
    return draft_of_lines(lines, rules)


def draft_of_lines(lines: list[str], rules: Mapping[str, Any]) -> GridDraft:
    """Return a new draft of rows of characters and other rules."""
    rows, columns = len(lines), len(lines[0])
    return GridDraft(tuple(lines), dict(rules), tuple(range(rows)), tuple(range(columns)), max(rows, columns))


def drawn_lines(cells: CellMap) -> list[str]:
    """Return a map as lines of characters."""
    return ["".join(cells.characters[code] for code in row) for row in cells.codes.tolist()]


def _set_cells(draft: GridDraft, edit: Edit) -> GridDraft:
    if not is_character(edit.value):
        raise UserError(f"{shown(edit.value)} is not a character of a map")
    rows, columns = draft.cells_in(edit)
    painted = edit.value * len(columns)
    return _with_cells(draft, rows, columns, lambda _: painted)


def _with_cells(draft: GridDraft, rows: range, columns: range, other: Callable[[str], str]) -> GridDraft:
    lines = list(draft.lines)
    for row in rows:
        line = lines[row]
        new = other(line[columns.start : columns.stop])
        lines[row] = line[: columns.start] + new + line[columns.stop :]
    return _tidied(replace(draft, lines=tuple(lines)))


def _tidied(draft: GridDraft) -> GridDraft:
    gone = {each for each in draft.minted if not any(each in line for line in draft.lines)}
    if not gone:
        return draft
    legend = {key: raw for key, raw in draft._raw_legend.items() if key not in gone}
    return replace(draft, rules={**draft.rules, "legend": legend}, minted=draft.minted - gone)


def _set_reward(draft: GridDraft, edit: Edit) -> GridDraft:
    rows, columns = draft.cells_in(edit)
    reward = number_in(edit)
    known = draft.legend
    present = set[str]().union(*(set(draft.lines[row][columns.start : columns.stop]) for row in rows))
    paying = dict[int, str]()
    for character in sorted(present):
        entry = known.get(character)
        if entry is None or entry.is_wall:
            raise UserError(f"{shown(character)} has no reward: it cannot be entered")
        draft, paying[ord(character)] = _character_paying(draft, character, entry, reward)
    return _with_cells(draft, rows, columns, lambda cells: cells.translate(paying))


def _character_paying(
    draft: GridDraft, character: str, entry: LegendEntry, reward: float
) -> tuple[GridDraft, str]:
    if entry.pays == reward:
        return draft, character
    wanted = entry.model_copy(update={"reward": reward})
    plain = wanted.model_copy(update={"reward": None})
    for known, other in draft.legend.items():
        if other == wanted or (other == plain and other.pays == reward):
            return draft, known
    taken = {*draft.legend, *draft._raw_legend, *"".join(draft.lines)}
    digit = str(int(reward)) if reward in range(1, 10) else ""
    free = next((each for each in (digit, *_MINTED) if each and each not in taken), None)
    if free is None or len(draft.legend) >= MOST_CHARACTERS:
        raise UserError("no character is left for a cell with a new reward; use a reward that the map has")
    raw = wanted.model_dump(mode="json", exclude_defaults=True)
    legend = {**draft._raw_legend, free: raw}
    return replace(draft, rules={**draft.rules, "legend": legend}, minted=draft.minted | {free}), free


def _define(draft: GridDraft, edit: Edit) -> GridDraft:
    (character,) = edit.at if len(edit.at) == 1 else ("",)
    if not is_character(character):
        raise UserError(f"{named(edit)}: expected one character")
    legend = dict(draft._raw_legend)
    if edit.value in ("", "null"):
        legend.pop(character, None)
    else:
        entry = plain_value(edit)
        if not isinstance(entry, Mapping):
            raise UserError(f'{shown(edit.value)}: expected a table such as {{"kind":"goal"}}')
        legend[character] = entry
    return replace(draft, rules={**draft.rules, "legend": legend}, minted=draft.minted - {character})


def _blow(draft: GridDraft, edit: Edit) -> GridDraft:
    what, count = ("column", draft.columns) if edit.name == "wind" else ("row", draft.rows)
    value = plain_value(edit)
    if not edit.at:
        if not isinstance(value, list) or len(value) not in (0, count):
            expected = f"a list of numbers, one for each {what} ({count:,})"
            raise UserError(f"{edit.name} is {shown(edit.value)}; expected {expected}")
        return replace(draft, rules={**draft.rules, edit.name: value})
    wind = list(draft.rules.get(edit.name) or [0] * count)
    for each in place_in(edit, what, count):
        wind[each] = value
    rules = {**draft.rules, edit.name: wind}
    if not any(wind):
        del rules[edit.name]
    return replace(draft, rules=rules)


def _resize(draft: GridDraft, edit: Edit) -> GridDraft:
    is_rows = edit.name == "rows"
    ids = draft.row_ids if is_rows else draft.column_ids
    count, at = lines_added(edit, len(ids))
    across = draft.columns if is_rows else draft.rows
    side = len(ids) + count
    if not 1 <= side <= LONGEST_SIDE or side * across > MOST_CELLS:
        raise UserError(f"a map has 1 to {LONGEST_SIDE:,} {edit.name}, and at most {MOST_CELLS:,} cells")
    new_ids = tuple(range(draft.next_id, draft.next_id + max(count, 0)))
    kept = ids[:at] + new_ids + ids[at + max(-count, 0) :]
    wind_name = "wind_rows" if is_rows else "wind"
    rules = dict(draft.rules)
    if rules.get(wind_name):
        wind = list(rules[wind_name])
        rules[wind_name] = [*wind[:at], *([0] * max(count, 0)), *wind[at + max(-count, 0) :]]
    if is_rows:
        new = (FLOOR * across,) * max(count, 0)
        lines = draft.lines[:at] + new + draft.lines[at + max(-count, 0) :]
        changed = replace(draft, lines=lines, row_ids=kept)
    else:
        cut = at + max(-count, 0)
        lines = tuple(line[:at] + FLOOR * max(count, 0) + line[cut:] for line in draft.lines)
        changed = replace(draft, lines=lines, column_ids=kept)
    return _tidied(replace(changed, rules=rules, next_id=draft.next_id + len(new_ids)))


_EDITS: Final[Mapping[str, Callable[[GridDraft, Edit], GridDraft]]] = {
    "cell": _set_cells,
    "reward": _set_reward,
    "legend": _define,
    "wind": _blow,
    "wind_rows": _blow,
    "rows": _resize,
    "columns": _resize,
}
