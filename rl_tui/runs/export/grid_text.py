"""A map of characters as the text of a script: the map itself and how one moves on it.

A table of all outcomes is up to thirty times as long, and a reader cannot redraw its map.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.runs.export.literals import literal, table
from rl_tui.runs.export.template import TEXTS, WorldText, arrow, between, environment, fill, sections
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.grid.map import LegendEntry, lines_of
from rl_tui.worlds.grid.moves import MOVES, STEPS

if TYPE_CHECKING:
    from numpy.random import Generator

    from rl_tui.worlds.grid.section import GridSection

MOST_ROWS: Final = 60
MOST_COLUMNS: Final = 90


def grid_text(section: GridSection, generator: Generator) -> WorldText:
    """Return the text of the map of ``section``; ``generator`` is the world's stream, from its beginning.

    Raises UserError where the map is too large to be read.
    """
    _check_size(section)
    cells = section.cells(generator)
    rows = ["".join(cells.characters[code] for code in row) for row in cells.codes]
    meaning = dict(zip(cells.characters, cells.entries, strict=True))
    there = {each: meaning[each] for each in sorted(set("".join(rows)))}
    starts = _characters(there, lambda entry: entry.kind is CellKind.START)
    moves = {name: STEPS[name] for name in MOVES[section.moves]}
    arrows = [arrow(step, name) for name, step in moves.items()]
    rules = _rules(section, there)
    flags = {name for name, value in rules.items() if value}
    if section.gusts and flags & {"wind", "wind_rows"}:
        flags.add("gusts")
    pieces = {
        **{name: literal(value) for name, value in rules.items()},
        "map": "\n".join(["MAP = [", *(f"    {literal(row)}," for row in rows), "]"]),
        "moves": table(moves, "MOVES = "),
        "arrows": literal(arrows),
        "starts": literal(starts),
        "when": section.rewards,
        "reward": _reward(section, flags),
        "next_state": "next_state" if "back" in flags else "entered",
        "is_end": "at(entered) in ENDS" if "ends" in flags else "False",
        "land": _landing(flags),
    }
    states, actions = "ROWS * COLUMNS", "len(NAMES)"
    one_start = sum(row.count(each) for row in rows for each in starts) == 1
    start = "STARTS[0]" if one_start else "int(self.np_random.choice(STARTS))"
    world = environment(states, actions, start, time_limit=section.time_limit)
    if "exits" in flags:
        sizes = {"state": "s", "states": f"range({states})"}
        sizes["actions_of_state"] = f"1 if at(s) in EXITS else {actions}"
    else:
        sizes = {"states": states, "actions": actions}
    shown = rules["walls"] + rules["ends"] + rules["exits"]
    return WorldText(
        setup=f"{fill(sections(f'{__package__}.grid', flags)['setup'], pieces)}\n\n\n{world}",
        new_table=fill(TEXTS["ragged" if "exits" in flags else "array"], sizes),
        report=TEXTS["arrows on a map"],
        report_pieces={"shown": literal(shown), "between": between(arrows)},
        starts="STARTS",
        truncates=section.time_limit > 0,
        remarks=("The map was drawn for this seed.",) if section.random else (),
    )


def _check_size(section: GridSection) -> None:
    if section.random is not None:
        rows, columns = section.random.rows, section.random.columns
    else:
        lines = lines_of(section.map)
        rows, columns = len(lines), len(lines[0])
    if rows > MOST_ROWS or columns > MOST_COLUMNS:
        raise UserError(
            f"this map has {rows:,} × {columns:,} cells, too many for a script that one can read: at most "
            f"{MOST_ROWS} × {MOST_COLUMNS}"
        )


def _characters(there: Mapping[str, LegendEntry], quality: Callable[[LegendEntry], bool]) -> str:
    return "".join(each for each, entry in there.items() if quality(entry))


def _rules(section: GridSection, there: Mapping[str, LegendEntry]) -> dict[str, Any]:
    """Return the rules that a grid may have, as the constants of the script; empty or 0 where it has not."""
    turns = [(slip.turn, slip.probability) for slip in section.slips]
    paying = {each: entry for each, entry in there.items() if not entry.is_wall and entry.pays}
    return {
        "walls": _characters(there, lambda entry: entry.is_wall),
        "ends": _characters(there, lambda entry: not entry.is_wall and entry.ends),
        "exits": _characters(there, lambda entry: entry.exit),
        "jumps": {each: entry.jump for each, entry in there.items() if entry.jump is not None},
        "back": _characters(there, lambda entry: entry.back),
        "only": {each: list(entry.only) for each, entry in there.items() if entry.only is not None},
        "pays": {each: float(entry.pays) for each, entry in paying.items()},
        "step_reward": section.step_reward,
        "bump_reward": section.bump_reward,
        "turns": turns if len(turns) > 1 else [],
        "wind": section.wind if any(section.wind) else [],
        "wind_rows": section.wind_rows if any(section.wind_rows) else [],
    }


def _reward(section: GridSection, flags: set[str]) -> str:
    """Return the expression of the reward of a step."""
    cell = "state" if section.rewards == "leaving" else "entered"
    paid = f"REWARD.get(at({cell}), 0.0)" if "pays" in flags else ""
    if paid and cell == "entered" and "exits" in flags:
        paid = f"(0.0 if at(entered) in EXITS else {paid})"
    step = "STEP_REWARD" if "step_reward" in flags else ""
    return " + ".join(filter(None, (paid, step))) or "0.0"


def _landing(flags: set[str]) -> str:
    """Return the expression of where a move leads, and whether something stopped it if that counts."""
    name = "NAMES[(action + turn) % len(NAMES)]" if "turns" in flags else "NAMES[action]"
    gusts = ", gust, side_gust" if "gusts" in flags else ""
    return f"{'*' if 'bump_reward' in flags else ''}land(state, {name}{gusts})"
