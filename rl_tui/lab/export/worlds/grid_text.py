"""A map of characters as the text of a script: the map itself and how one moves on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.export.literals import literal, table
from rl_tui.lab.export.template import fill
from rl_tui.lab.export.worlds import grid_pieces as pieces
from rl_tui.lab.export.worlds.text import (
    ARRAY,
    ARROWS_ON_MAP,
    ENVIRONMENT,
    FIELDS,
    RAGGED,
    WorldText,
    arrow,
    between,
    limited,
)
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.grid.legend import BUILT_IN, LegendEntry
from rl_tui.worlds.grid.map import draw_map, lines_of, read_map
from rl_tui.worlds.grid.moves import MOVES, STEPS, slips_of

if TYPE_CHECKING:
    from numpy.random import Generator

    from rl_tui.worlds.grid.section import GridSection

MOST_ROWS: Final = 60
MOST_COLUMNS: Final = 90


def grid_text(section: GridSection, generator: Generator) -> WorldText:
    """Return the text of the map of ``section``; ``generator`` is the world's stream, from its beginning.

    Raises UserError where the map is too large to be read.
    """
    return _Text(section, generator).text()


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


class _Text:
    """The pieces of one grid; each is empty where the grid has no such rule."""

    def __init__(self, section: GridSection, generator: Generator) -> None:
        _check_size(section)
        legend = {**BUILT_IN, **section.legend}
        if section.random is not None:
            cells = draw_map(section.random, legend, section.moves, generator)
        else:
            cells = read_map(section.map, legend)
        self.section = section
        self.rows = ["".join(cells.characters[code] for code in row) for row in cells.codes]
        there = set("".join(self.rows))
        self.legend: Mapping[str, LegendEntry] = {each: legend[each] for each in sorted(there)}
        self.moves = MOVES[section.moves]
        self.slips = slips_of(section.noise, section.slippery)
        self.gusts = section.gusts and (any(section.wind) or any(section.wind_rows))
        self.bumps = section.bump_reward != 0.0
        self.walls = self._characters(lambda entry: entry.is_wall)
        self.ends = self._characters(lambda entry: not entry.is_wall and entry.ends)
        self.exits = self._characters(lambda entry: entry.exit)
        self.back = self._characters(lambda entry: entry.back)
        self.starts = self._characters(lambda entry: entry.kind is CellKind.START)
        self.jumps = {each: entry.jump for each, entry in self.legend.items() if entry.jump is not None}
        self.only = {each: list(entry.only) for each, entry in self.legend.items() if entry.only is not None}
        self.pays = {
            each: float(entry.pays) for each, entry in self.legend.items() if not entry.is_wall and entry.pays
        }

    def text(self) -> WorldText:
        """Return the whole."""
        shown = self.walls + self.ends + self.exits
        return WorldText(
            setup=f"{self._setup()}\n\n\n{self._environment()}",
            new_table=self._new_table(),
            report=ARROWS_ON_MAP,
            report_pieces={"shown": literal(shown), "between": between(self._arrows())},
            starts="STARTS",
            truncates=self.section.time_limit > 0,
            remarks=("The map was drawn for this seed.",) if self.section.random else (),
        )

    def _arrows(self) -> list[str]:
        return [arrow(STEPS[name], name) for name in self.moves]

    def _characters(self, quality: Callable[[LegendEntry], bool]) -> str:
        return "".join(each for each, entry in self.legend.items() if quality(entry))

    def _environment(self) -> str:
        one_start = sum(row.count(each) for row in self.rows for each in self.starts) == 1
        return fill(
            ENVIRONMENT,
            {
                "states": "ROWS * COLUMNS",
                "actions": "len(NAMES)",
                "start": "STARTS[0]" if one_start else "int(self.np_random.choice(STARTS))",
                "fields": FIELDS,
                "noise": "",
                "environment": limited(self.section.time_limit),
            },
        )

    def _new_table(self) -> str:
        if not self.exits:
            return fill(ARRAY, {"states": "ROWS * COLUMNS", "actions": "len(NAMES)"})
        actions = "1 if at(s) in EXITS else len(NAMES)"
        return fill(RAGGED, {"actions_of_state": actions, "state": "s", "states": "range(ROWS * COLUMNS)"})

    def _setup(self) -> str:
        moves = {name: STEPS[name] for name in self.moves}
        return fill(
            pieces.SETUP,
            {
                "map": "\n".join(["MAP = [", *(f"    {literal(row)}," for row in self.rows), "]"]),
                "cells": "\n".join(self._cells()),
                "rules": "\n".join(self._rules()),
                "moves": table(moves, "MOVES = "),
                "arrows": literal(self._arrows()),
                "starts": literal(self.starts),
                "no_wall": " and MAP[row][column] not in WALLS" if self.walls else "",
                "land": self._land(),
                "arrive": self._arrive(),
                "outcomes": self._outcomes(),
            },
        )

    def _cells(self) -> list[str]:
        """Return the constants that say what the letters of the map stand for."""
        when = "leaving" if self.section.rewards == "leaving" else "entering"
        lines = [
            (self.walls, f"WALLS = {literal(self.walls)}"),
            (self.ends, f"ENDS = {literal(self.ends)}  # entering one of these ends the episode"),
            (self.exits, f"EXITS = {literal(self.exits)}  # here the only action is to exit, which ends it"),
            (self.jumps, f"JUMPS = {literal(self.jumps)}  # whatever is done here leads there"),
            (self.back, f"BACK = {literal(self.back)}  # whoever enters is put back to the start"),
            (self.only, f"ONLY = {literal(self.only)}  # other moves do nothing here"),
            (self.pays, f"REWARD = {literal(self.pays)}  # what {when} a cell pays; others pay nothing"),
        ]
        return [line for is_there, line in lines if is_there]

    def _rules(self) -> list[str]:
        section = self.section
        turns = [(slip.turn, slip.probability) for slip in self.slips]
        lines = [
            (section.step_reward, f"STEP_REWARD = {section.step_reward!r}  # of every step"),
            (self.bumps, f"BUMP_REWARD = {section.bump_reward!r}  # of a step that something stops"),
            (len(turns) > 1, f"{pieces.ABOUT_TURNS}\nTURNS = {literal(turns)}"),
            (any(section.wind), f"WIND = {literal(section.wind)}  # of each column, upwards"),
            (
                any(section.wind_rows),
                f"WIND_ROWS = {literal(section.wind_rows)}  # of each row, to the right",
            ),
        ]
        return [line for is_there, line in lines if is_there]

    def _land(self) -> str:
        wind, wind_rows = any(self.section.wind), any(self.section.wind_rows)
        gust, side_gust = (pieces.GUST, pieces.SIDE_GUST) if self.gusts else ("", "")
        return fill(
            pieces.LAND,
            {
                "gusts": ", gust, side_gust" if self.gusts else "",
                "only": pieces.ONLY if self.only else "",
                "wind": fill(pieces.WIND, {"gust": gust}) if wind else "",
                "wind_rows": fill(pieces.WIND_ROWS, {"gust": side_gust}) if wind_rows else "",
                "bumped": pieces.BUMPED if self.bumps else "",
                "blow": pieces.BLOW if wind else "",
                "blow_rows": pieces.BLOW_ROWS if wind_rows else "",
                "and_bumped": ", bumped" if self.bumps else "",
            },
        )

    def _arrive(self) -> str:
        return fill(
            pieces.ARRIVE,
            {
                "bumped": ", bumped" if self.bumps else "",
                "reward": self._reward(),
                "bump": pieces.BUMP if self.bumps else "",
                "back": pieces.BACK if self.back else "",
                "next_state": "next_state" if self.back else "entered",
                "ends": "at(entered) in ENDS" if self.ends else "False",
            },
        )

    def _reward(self) -> str:
        cell = "state" if self.section.rewards == "leaving" else "entered"
        paid = [f"REWARD.get(at({cell}), 0.0)"] if self.pays else []
        if paid and cell == "entered" and self.exits:
            paid = [f"(0.0 if at(entered) in EXITS else {paid[0]})"]
        step = ["STEP_REWARD"] if self.section.step_reward else []
        return " + ".join([*paid, *step]) or "0.0"

    def _outcomes(self) -> str:
        """Return the function that lists what a move may turn out to be."""
        turns = len(self.slips) > 1
        star = "*" if self.bumps else ""
        name = "NAMES[(action + turn) % len(NAMES)]" if turns else "NAMES[action]"
        land = f"{star}land(state, {name})"
        possible = f"return [arrive(p, state, {land}) for turn, p in TURNS]"
        if self.gusts:
            possible = fill(
                pieces.GUSTS,
                {
                    "up": f"{pieces.SHAKEN} if WIND[state % COLUMNS] else [0]"
                    if any(self.section.wind)
                    else "[0]",
                    "side": f"{pieces.SHAKEN} if WIND_ROWS[state // COLUMNS] else [0]"
                    if any(self.section.wind_rows)
                    else "[0]",
                    "p": "p * share" if turns else "share",
                    "land": f"{star}land(state, {name}, gust, side_gust)",
                    "turns": "for turn, p in TURNS" if turns else "",
                },
            )
        elif not turns:
            possible = f"return [arrive(1.0, state, {land})]"
        reward = "REWARD.get(at(state), 0.0)" if self.pays else "0.0"
        return fill(
            pieces.OUTCOMES,
            {
                "exit": fill(pieces.EXIT, {"reward": reward}) if self.exits else "",
                "jump": fill(pieces.JUMP, {"no_bump": ", False" if self.bumps else ""}) if self.jumps else "",
                "possible": possible,
            },
        )
