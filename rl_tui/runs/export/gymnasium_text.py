"""An environment of Gymnasium as the text of a script."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import closing
from keyword import iskeyword
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.runs.export.literals import listed, literal
from rl_tui.runs.export.template import TEXTS, WorldText, arrow, between, fill, sections
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.gym.registered import made, time_limit_of
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from gymnasium import Env

    from rl_tui.worlds.gym.bins import BinsSection

_TEXTS: Final = sections(f"{__package__}.gymnasium")
_LETTERS: Final = {
    CellKind.START: "S",
    CellKind.FLOOR: ".",
    CellKind.GOAL: "G",
    CellKind.HOLE: "H",
    CellKind.WALL: "#",
    CellKind.CLIFF: "C",
}
_NATURALS: Final = "A dealt 21 (a natural) is the same state here as any other 21 with a usable ace."
_LOOKUP_IMPORT: Final = "from collections import defaultdict"


def gymnasium_text(section: GymnasiumSection, world: World) -> WorldText:
    """Return the text of the environment of ``section``, of which ``world`` was made.

    Raises UserError where its observations or actions are of a kind that a short script cannot number.
    """
    with closing(made(section.id, section.kwargs)) as environment:
        has_table = world.mdp is not None and hasattr(environment.unwrapped, "P")
        if int(environment.action_space.start) != 0:
            raise UserError(f"no script for {section.id}: its actions do not count from 0")
        make = _make(section)
        truncates = time_limit_of(environment) > 0
        if has_table:
            return _tabular(world, make, truncates)
        setup, imports = _observed(section, environment, make)
    names = listed(map(literal, world.space.action_names), before="NAMES = ")
    return WorldText(
        setup=f"{setup}\n{names}",
        new_table=fill(TEXTS["lookup"], {"actions": "len(NAMES)"}),
        report=TEXTS["state by state"],
        report_pieces={"states": "sorted(Q)"},
        truncates=truncates,
        imports=(*imports, _LOOKUP_IMPORT),
        remarks=(_NATURALS,) if world.mdp is not None else (),
    )


def _make(section: GymnasiumSection) -> str:
    """Return the expression that makes the environment."""
    plain = {key: value for key, value in section.kwargs.items() if key.isidentifier() and not iskeyword(key)}
    others = {key: value for key, value in section.kwargs.items() if key not in plain}
    given = [f"{key}={literal(value)}" for key, value in plain.items()]
    rest = [f"**{literal(others)}"] if others else []
    return listed([literal(section.id), *given, *rest], "(", ")", "gym.make")


def _tabular(world: World, make: str, truncates: bool) -> WorldText:
    setup = [f"env = {make}"]
    grid = world.drawing
    report, pieces = TEXTS["state by state"], {"states": "range(len(Q))"}
    if isinstance(grid, Grid) and grid.cell_of_state == tuple(range(len(grid.kinds))):
        arrows = list(map(arrow, grid.directions, world.space.action_names))
        setup += _map(grid, world.space.action_names, arrows)
        report, pieces = TEXTS["arrows on a map"], {"shown": '"HGC#"', "between": between(arrows)}
    else:
        setup.append(listed(map(literal, world.space.action_names), before="NAMES = "))
    sizes = {"states": "env.observation_space.n", "actions": "env.action_space.n"}
    return WorldText(
        setup="\n".join(setup),
        new_table=fill(TEXTS["array"], sizes),
        report=report,
        report_pieces=pieces,
        model=_TEXTS["model"],
        starts="np.flatnonzero(env.unwrapped.initial_state_distrib).tolist()",
        truncates=truncates,
    )


def _map(grid: Grid, action_names: Sequence[str], arrows: Sequence[str]) -> list[str]:
    """Return the lines that say how the policy is drawn."""
    letters = "".join(_LETTERS[kind] for kind in grid.kinds)
    rows = [letters[first : first + grid.columns] for first in range(0, len(letters), grid.columns)]
    return [
        f"# The actions 0, 1, ...: {', '.join(action_names)}",
        listed(map(literal, arrows), before="ARROWS = "),
        "MAP = [  # only to draw the policy",
        *(f"    {literal(row)}," for row in rows),
        "]",
    ]


def _observed(
    section: GymnasiumSection, environment: Env[Any, Any], make: str
) -> tuple[str, tuple[str, ...]]:
    """Return the text that makes an environment whose observations are states, and what it imports."""
    from gymnasium import spaces

    space = environment.observation_space
    if section.bins is not None and isinstance(space, spaces.Box):
        edges = listed(_edges(section.bins, space), before="EDGES = ")
        return fill(_TEXTS["bins"], {"edges": edges, "made": make}), ("from bisect import bisect",)
    if isinstance(space, spaces.MultiDiscrete | spaces.MultiBinary):
        return fill(_TEXTS["numbers"], {"made": make}), ()
    flat = isinstance(space, spaces.Tuple) and all(isinstance(each, spaces.Discrete) for each in space.spaces)
    if flat or isinstance(space, spaces.Discrete):
        return f"env = {make}", ()
    raise UserError(f"no script for {section.id}: its observations are {type(space).__name__}, made of parts")


def _edges(bins: BinsSection, space: Any) -> list[str]:
    """Return the expression of the inner edges of each dimension."""
    if bins.edges is not None:
        return [literal([float(edge) for edge in inner]) for inner in bins.edges]
    low, high = bins.low or space.low.ravel().tolist(), bins.high or space.high.ravel().tolist()
    return [
        "[]" if count == 1 else f"np.linspace({least:.8g}, {most:.8g}, {count + 1})[1:-1]"
        for least, most, count in zip(low, high, bins.count or (), strict=True)
        if not (count > 1 and math.isinf(least))
    ]
