"""Grid worlds drawn without an app."""

from __future__ import annotations

import numpy as np
from rich.style import Style
from sample_worlds import lake_world
from samples import lake, look
from snapshots import changed
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.number_form import SteadyForms
from rl_tui.screen.kit.numbers_in_common import all_v
from rl_tui.screen.kit.value_scale import SteadyScale
from rl_tui.screen.panels.grid.action_values import draw_grid
from rl_tui.screen.panels.grid.cells import CellArtist
from rl_tui.screen.panels.grid.form import CellForm
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.grid.map import GridMap, MapPart
from rl_tui.screen.panels.grid.marks import lead_steps
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.mdp.space import FloatArray


def q_of(snapshot: Snapshot, values: dict[tuple[int, int], float]) -> FloatArray:
    """Zero except at (state, position of the pair in it)."""
    q = np.zeros(snapshot.world.space.pairs)
    for (state, place), value in values.items():
        q[int(snapshot.world.space.first_pair[state]) + place] = value
    return q


def visited(snapshot: Snapshot, *states: int) -> Snapshot:
    visits = snapshot.agent.visits.copy()
    for state in states:
        visits[snapshot.world.space.pairs_of(state).start] = 1
    return changed(snapshot, visits=visits)


def picture(snapshot: Snapshot, width: int, height: int, *, ascii: bool = False) -> list[str]:  # noqa: A002
    view = GridView(snapshot.world, look(ascii))
    return [strip.text for strip in view.picture(snapshot, width, height)]


def whole(snapshot: Snapshot) -> MapPart:
    grid = snapshot.world.drawing
    assert isinstance(grid, Grid)
    return MapPart(0, 0, grid.rows, grid.columns)


def small(snapshot: Snapshot, height: int = 4, width: int = 20) -> list[str]:
    grid = snapshot.world.drawing
    assert isinstance(grid, Grid)
    grid_map = GridMap(snapshot.world.space, grid)
    artist = CellArtist(look(), CellForm(5, 1))
    part = whole(snapshot)
    form = SteadyForms().form("", all_v(snapshot), artist.form.digits, most=2)
    scale = SteadyScale().of(snapshot)
    cells = grid_map.contents(part, snapshot)
    strips = draw_grid(cells, artist, form, scale, lead_steps(scale), part, width, height)
    return [strip.text for strip in strips]


def style_at(strip: Strip, column: int) -> Style | None:
    return next(iter(strip.crop(column, column + 1))).style


def large_lake(side: int = 40) -> Snapshot:
    rows = ("S" + "F" * (side - 1), *("F" * side for _ in range(side - 2)), "F" * (side - 1) + "G")
    world = lake_world(slippery=False, rows=rows)
    mdp = world.space
    return changed(
        lake(step=0), world=world, q=np.zeros(mdp.pairs), visits=np.zeros(mdp.pairs, dtype=np.int64)
    )


def paying() -> Snapshot:
    """A corridor: leaving the second cell costs 1, and leaving the last pays 1 and returns to the start."""
    legend = {
        "g": {"kind": "goal", "reward": 1.0, "terminal": False, "jump": "S"},
        "-": {"kind": "floor", "reward": -1.0},
    }
    table = {"map": "S-..g\n.....\n", "moves": "four", "rewards": "leaving", "legend": legend}
    world = GridSection.model_validate({**table, "time_limit": 9}).build(np.random.default_rng(0))
    space = world.space
    return changed(
        lake(step=0), world=world, state=0, q=np.zeros(space.pairs), visits=np.zeros(space.pairs, np.int64)
    )


def one_way() -> Snapshot:
    world = GridSection.model_validate({"map": "S>..G\n.....\n"}).build(np.random.default_rng(0))
    space = world.space
    return changed(
        lake(step=0), world=world, state=0, q=np.zeros(space.pairs), visits=np.zeros(space.pairs, np.int64)
    )
