"""The ``[grid]`` table of a scenario file: a map and its rules.

Contradictions are found in the raw table, to report them together with errors in single values.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import Field

from rl_tui.common.findings import Finding, shown
from rl_tui.common.limits import (
    LONGEST_SIDE,
    LONGEST_TIME_LIMIT,
    MOST_CELLS,
    MOST_CHARACTERS,
    MOST_OUTCOMES,
    STRONGEST_WIND,
)
from rl_tui.common.words import counted
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.grid.map import (
    BUILT_IN,
    FLOOR,
    GOAL,
    HOLE,
    START,
    WAY_CHARACTERS,
    CellMap,
    Character,
    LegendEntry,
    RandomMap,
    draw_map,
    entry_findings,
    first_place,
    is_character,
    lines_of,
    read_map,
)
from rl_tui.worlds.grid.moves import COMPASS, MOVES, Slip, slips_of
from rl_tui.worlds.sections.schema import (
    Expect,
    Number,
    TruthValue,
    WorldSection,
    is_table,
    number,
    one_of,
    parsed,
    sized,
    whole_number,
)
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator


# Contradictions between entries


_MOST_TOLD: Final = 20


@dataclass(frozen=True, slots=True)
class _Shape:
    rows: int
    columns: int
    counts: Mapping[str, int]


def grid_findings(raw: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield contradictions in a raw ``[grid]`` table, located inside it."""
    legend = _legend(raw.get("legend"))
    moves = raw.get("moves", "four")
    known_moves = MOVES[moves] if isinstance(moves, str) and moves in MOVES else None
    yield from _slip_findings(raw, known_moves)
    yield from _legend_findings(raw.get("legend"), legend, known_moves)
    if "map" in raw and "random" in raw:
        yield Finding(("random",), "map and random are both set; keep one of them")
        return
    if "map" not in raw and "random" not in raw:
        yield Finding(("map",), "nothing", "a map of characters, or random")
        return
    key = "map" if "map" in raw else "random"
    if key == "map":
        if not isinstance(raw["map"], str):
            return  # a formal error, reported already; nothing more can be checked
        findings = list(_form_findings(raw["map"]))
        if findings:
            yield from findings
            return
    shape = _shape(raw, key)
    if shape is None:
        return
    yield from _size_findings(key, shape, raw, known_moves)
    yield from _wind_findings(raw, shape)
    yield from _meeting_findings(key, shape, raw, legend)


def _legend(raw: object) -> dict[str, LegendEntry | None]:
    legend: dict[str, LegendEntry | None] = dict(BUILT_IN)
    if isinstance(raw, dict) and len(raw) <= MOST_CHARACTERS:
        legend |= {key: parsed(LegendEntry, entry)[0] for key, entry in raw.items() if is_character(key)}
    return legend


def _slip_findings(raw: Mapping[str, Any], moves: Sequence[str] | None) -> Iterator[Finding]:
    noisy, slippery = raw.get("noise") not in (None, 0), raw.get("slippery") is True
    if noisy and slippery:
        yield Finding(("slippery",), "noise and slippery are both set; keep one of them")
    for key, given in (("noise", noisy), ("slippery", slippery)):
        if given and moves not in (None, *COMPASS):
            known = shown(raw["moves"])
            yield Finding(
                (key,),
                f'{key} does not work with moves = {known}; use moves = "four", or leave out {key}',
            )
    if raw.get("gusts") is True and not _winds(raw):
        yield Finding(("gusts",), "gusts need wind; add wind or wind_rows, or leave out gusts")


def _winds(raw: Mapping[str, Any]) -> int:
    return sum(isinstance(wind, list) and any(wind) for wind in (raw.get("wind"), raw.get("wind_rows")))


def _legend_findings(
    raw: object, legend: Mapping[str, LegendEntry | None], moves: Sequence[str] | None
) -> Iterator[Finding]:
    for character, entry in raw.items() if isinstance(raw, dict) else ():
        known = legend.get(character)
        if known is not None:
            for finding in entry_findings(known, entry, moves):
                yield finding.inside("legend", character)


def _form_findings(text: str) -> Iterator[Finding]:
    lines = lines_of(text)
    if not any(lines):
        yield Finding(("map",), "the map is empty; write one line of characters for each row")
        return
    odd = [index for index, line in enumerate(lines) if len(line) != len(lines[0])]
    if odd:
        more = f" ({counted(len(odd) - 1, 'more line')} of another length)" if len(odd) > 1 else ""
        found = f"line {odd[0] + 1} has {counted(len(lines[odd[0]]), 'character')}"
        yield Finding(("map",), f"{found}, line 1 has {len(lines[0])}{more}; make all equally long")


def _shape(raw: Mapping[str, Any], key: str) -> _Shape | None:
    if key == "map":
        lines = lines_of(raw["map"])
        return _Shape(len(lines), len(lines[0]), Counter("".join(lines)))
    wanted, _ = parsed(RandomMap, raw["random"])
    if wanted is None:
        return None
    # the exact numbers are unknown, but there are several holes and free cells
    counts = {START: 1, GOAL: 1, FLOOR: 2, HOLE: 2}
    return _Shape(wanted.rows, wanted.columns, counts)


def _size_findings(
    key: str, shape: _Shape, raw: Mapping[str, Any], moves: Sequence[str] | None
) -> Iterator[Finding]:
    rows, columns = shape.rows, shape.columns
    size = f"{rows:,} × {columns:,} cells"
    if rows * columns > MOST_CELLS or max(rows, columns) > LONGEST_SIDE:
        expected = f"at most {MOST_CELLS:,} cells and {LONGEST_SIDE:,} on a side"
        yield Finding((key,), size, expected)
        return
    if key == "random" and rows * columns < 2:
        yield Finding((key,), size, "2 cells or more, for a start and a goal")
    ways = 3 if raw.get("slippery") is True or raw.get("noise") not in (None, 0) else 1
    if raw.get("gusts") is True:
        ways *= 3 ** _winds(raw)
    outcomes = rows * columns * len(moves or ()) * ways
    if outcomes > MOST_OUTCOMES:
        yield Finding((key,), f"{size} with {outcomes:,} outcomes", f"at most {MOST_OUTCOMES:,} outcomes")


def _wind_findings(raw: Mapping[str, Any], shape: _Shape) -> Iterator[Finding]:
    for key, what, count in (("wind", "column", shape.columns), ("wind_rows", "row", shape.rows)):
        wind = raw.get(key)
        if isinstance(wind, list) and 0 < len(wind) <= LONGEST_SIDE and len(wind) != count:
            yield Finding((key,), counted(len(wind), "number"), f"one for each {what} ({count:,})")


def _meeting_findings(
    key: str, shape: _Shape, raw: Mapping[str, Any], legend: Mapping[str, LegendEntry | None]
) -> Iterator[Finding]:
    unknown = sorted(character for character in shape.counts if character not in legend)
    lines = lines_of(raw["map"]) if unknown else []
    for character in unknown[:_MOST_TOLD]:
        found = f"{shown(character)} in {first_place(lines, character)} is not in the legend"
        yield Finding((key,), f"{found}; add it to [grid.legend]")
    if len(shape.counts) > MOST_CHARACTERS:
        yield Finding((key,), f"{len(shape.counts)} different characters", f"at most {MOST_CHARACTERS}")
    on_map = {each: entry for each in shape.counts if (entry := legend.get(each)) is not None}
    starts = sum(shape.counts[each] for each, entry in on_map.items() if entry.kind is CellKind.START)
    if not unknown and None not in (legend[each] for each in shape.counts) and not starts:
        yield Finding((key,), 'the map has no start; add a cell of the kind "start", such as S')
    leaving = raw.get("rewards") == "leaving"
    for character, entry in sorted(on_map.items()):
        where = ("legend", character)
        if key == "random" and entry.is_wall and character in WAY_CHARACTERS:
            found = "walls would block the path to the goal of a random map; choose another kind"
            yield Finding((*where, "kind"), found)
        if entry.jump is not None:
            yield from _jump_findings((*where, "jump"), entry.jump, shape, legend)
        if entry.back and starts > 1:
            found = f"back = true leads to the start, but the map has {starts}; keep one start"
            yield Finding((*where, "back"), found)
        if leaving and (entry.ends or entry.back) and entry.pays and not entry.is_wall:
            own = raw.get("legend")
            place = where if isinstance(own, dict) and character in own else (key,)
            found = (
                f"the agent never leaves cell {shown(character)}, so it never gets the reward {entry.pays:g}"
            )
            yield Finding(place, f'{found}; use exit = true, reward = 0, or rewards = "entering"')


def _jump_findings(
    where: tuple[str, ...], target: str, shape: _Shape, legend: Mapping[str, LegendEntry | None]
) -> Iterator[Finding]:
    count, entry = shape.counts.get(target, 0), legend.get(target)
    if count != 1:
        found = (
            f"{shown(target)} occurs {count:,} times on the map"
            if count
            else f"{shown(target)} is not on the map"
        )
        yield Finding(where, f"{found}; use a character that occurs once")
    elif entry is not None and entry.is_wall:
        yield Finding(where, f"{shown(target)} is a wall; use a cell that can be entered")


# The table


REWARDS: Final = ("entering", "leaving")
_IS_LEGEND: Final = sized(dict, MOST_CHARACTERS)


Wind = Annotated[
    list[Annotated[int, whole_number(-STRONGEST_WIND, STRONGEST_WIND)]],
    Expect(f"a list of at most {LONGEST_SIDE:,} whole numbers", sized(list, LONGEST_SIDE)),
]


class GridSection(WorldSection):
    """The ``[grid]`` table: a `map`, or one drawn at `random`, and the rules.

    Entering or leaving a cell pays, as `rewards` says. A stopped move enters its own cell again. Every step
    except "exit" gets `step_reward`, and stopped steps get `bump_reward`. The `wind` blows upwards per
    column. To the right it blows by `wind_rows`, per row. Both are in cells.
    """

    map: Annotated[
        str, Expect("a map of characters, a line for each row", lambda value: isinstance(value, str))
    ] = ""
    random: Annotated[RandomMap | None, Expect("a table, { rows = …, columns = …, holes = … }", is_table)] = (
        None
    )
    moves: Annotated[str, Expect(f"one of {', '.join(MOVES)}", lambda value: value in tuple(MOVES))] = "four"
    rewards: Annotated[str, one_of(REWARDS)] = "entering"
    step_reward: Number = 0.0
    bump_reward: Number = 0.0
    noise: Annotated[float, number(0, 1)] = 0.0
    slippery: TruthValue = False
    wind: Wind = Field(default_factory=list)
    wind_rows: Wind = Field(default_factory=list)
    gusts: TruthValue = False
    time_limit: Annotated[int, whole_number(0, LONGEST_TIME_LIMIT)] = 0
    legend: Annotated[
        dict[Character, LegendEntry],
        Expect(f"a table of characters and what they mean, at most {MOST_CHARACTERS}", _IS_LEGEND),
    ] = Field(default_factory=dict)

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield contradictions between map, legend and rules."""
        return grid_findings(raw)

    @property
    def drawn_from_seed(self) -> bool:
        """True if the map is random."""
        return self.random is not None

    @property
    def slips(self) -> tuple[Slip, ...]:
        """Possible slips of a move."""
        return slips_of(self.noise, self.slippery)

    def sketch(self) -> Grid:
        """Return a grid with size and wind only."""
        lines = lines_of(self.map)
        drawn = self.random
        rows, columns = (len(lines), len(lines[0])) if drawn is None else (drawn.rows, drawn.columns)
        return Grid(rows, columns, (), (), (), wind=tuple(self.wind) if any(self.wind) else ())

    def build(self, generator: Generator) -> World:
        """Build the world. A random map is the first draw from `generator`.

        Raises:
            WorldRefusedError: No random map with a way to the goal was found.
        """
        from rl_tui.worlds.grid.table import GridStates, grid_drawing, grid_table

        states = GridStates(self.cells(generator))
        mdp = grid_table(states, self)
        return World(mdp, grid_drawing(states, mdp.action_names, self.wind))

    def cells(self, generator: Generator) -> CellMap:
        """Return the map, drawn as in :meth:`build` if random."""
        legend = {**BUILT_IN, **self.legend}
        if self.random is not None:
            return draw_map(self.random, legend, self.moves, generator)
        return read_map(self.map, legend)
