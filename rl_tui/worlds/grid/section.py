"""The ``[grid]`` table: a map drawn in characters, and how one moves on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import Field

from rl_tui.common.findings import Finding
from rl_tui.common.limits import LONGEST_SIDE, LONGEST_TIME_LIMIT, MOST_CHARACTERS, STRONGEST_WIND
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.grid.faults import grid_findings
from rl_tui.worlds.grid.legend import BUILT_IN, Character, LegendEntry
from rl_tui.worlds.grid.map import CellMap, RandomMap, draw_map, lines_of, read_map
from rl_tui.worlds.grid.moves import MOVES, Slip, slips_of
from rl_tui.worlds.sections.schema import Expect, Number, TruthValue, is_table, number, sized, whole_number
from rl_tui.worlds.sections.world_section import WorldSection
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator

REWARDS: Final = ("entering", "leaving")
_IS_LEGEND: Final = sized(dict, MOST_CHARACTERS)


Wind = Annotated[
    list[Annotated[int, whole_number(-STRONGEST_WIND, STRONGEST_WIND)]],
    Expect(f"a list of at most {LONGEST_SIDE:,} whole numbers", sized(list, LONGEST_SIDE)),
]


class GridSection(WorldSection):
    """The whole table: a ``map``, or one to be drawn at ``random``, and the rules.

    ``rewards`` says whether a cell pays on entering or on leaving it; a move that is stopped enters its own
    cell again. ``step_reward`` is added to every step but "exit", ``bump_reward`` to steps that a wall or the
    edge stops. ``wind`` blows up in a column, ``wind_rows`` to the right in a row, as many cells as they say.
    """

    map: Annotated[
        str, Expect("a map of characters, a line for each row", lambda value: isinstance(value, str))
    ] = ""
    random: Annotated[RandomMap | None, Expect("a table, { rows = …, columns = …, holes = … }", is_table)] = (
        None
    )
    moves: Annotated[str, Expect(f"one of {', '.join(MOVES)}", lambda value: value in tuple(MOVES))] = "four"
    rewards: Annotated[str, Expect(" or ".join(REWARDS), lambda value: value in REWARDS)] = "entering"
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
        """Yield what does not fit together: map, legend and rules."""
        return grid_findings(raw)

    @property
    def drawn_from_seed(self) -> bool:
        """Whether the map is drawn."""
        return self.random is not None

    @property
    def slips(self) -> tuple[Slip, ...]:
        """What may happen when a move is meant."""
        return slips_of(self.noise, self.slippery)

    def sketch(self) -> Grid:
        """Return a grid of the map's size, with its wind."""
        lines = lines_of(self.map)
        drawn = self.random
        rows, columns = (len(lines), len(lines[0])) if drawn is None else (drawn.rows, drawn.columns)
        return Grid(rows, columns, (), (), (), wind=tuple(self.wind) if any(self.wind) else ())

    def build(self, generator: Generator) -> World:
        """Return the world; a random map is the first draws from ``generator``.

        Raises WorldRefusedError where none with a way to the goal is found.
        """
        from rl_tui.worlds.grid.states import GridStates, grid_drawing
        from rl_tui.worlds.grid.table import grid_table

        states = GridStates(self.cells(generator))
        mdp = grid_table(states, self)
        return World(mdp, grid_drawing(states, mdp.action_names, self.wind))

    def cells(self, generator: Generator) -> CellMap:
        """Return the map, drawn from ``generator`` where it is random, as :meth:`build` does."""
        legend = {**BUILT_IN, **self.legend}
        if self.random is not None:
            return draw_map(self.random, legend, self.moves, generator)
        return read_map(self.map, legend)
