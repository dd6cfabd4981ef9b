"""What an atlas is asked for: the surroundings of a run's settings, as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

from rl_tui.agents.catalogue import BY_ID, algorithm_row
from rl_tui.agents.compatibility import is_bandit
from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import in_kiosk
from rl_tui.lab.atlas.axes import axes_of
from rl_tui.lab.atlas.cells import CellGrid
from rl_tui.lab.atlas.figures import Atlas
from rl_tui.lab.run.library import MOST_EPISODES, episodes_of
from rl_tui.lab.run.recipe import Recipe, changed_parameter
from rl_tui.lab.sweeps.cells.order import Axis, coarse_first
from rl_tui.lab.sweeps.plan import WHOLE, Shard, SweepPlan
from rl_tui.lab.sweeps.variation import Variation
from rl_tui.worlds.world import World

WORK: Final = "rl_tui.lab.atlas.work:work"
"""What works it out in a process of its own: it needs much that this one need not load."""
RUNS: Final = 10
"""Seeds of each cell: the fewest of which a mean has an interval, and cells can be compared."""
MOST_PAIRS: Final = 20_000
"""A world with more states and actions would take minutes, most of it for exact figures."""


@dataclass(frozen=True)
class SurroundingsPlan(SweepPlan):
    """A plan whose values are a coarse lattice first, listed as they are, and begin with one cell."""

    in_force: int = 0
    """The number of the cell that comes first."""

    def order(self, shard: Shard = WHOLE) -> Iterator[int]:
        """Yield the number of each cell of ``shard`` once: that in force, then the coarse lattice first."""
        coarse = coarse_first([Axis(each.count, spread=True) for each in self.variations])
        every = (self.in_force, *(index for index in coarse if index != self.in_force))
        return (index for place, index in enumerate(every) if place % shard.parts == shard.number - 1)


@dataclass(frozen=True)
class AtlasRequest:
    """The surroundings of ``recipe``: all combinations of ``variations``, everything else as it is."""

    recipe: Recipe
    """The run with the settings in force; its seed is the first of each cell."""
    variations: tuple[Variation, ...]
    """Rows, then columns; columns alone where one setting is all there is."""
    episodes: int
    """How many episodes each run is to have, where there is time for as many."""
    runs: int
    """Seeds of each cell."""
    is_awaited: bool
    """Whether all else waits for it, so that it need not let others go first."""

    @cached_property
    def cells(self) -> CellGrid:
        """Where its cells stand."""
        return CellGrid(self.variations)

    @cached_property
    def in_force(self) -> int:
        """The number of the cell whose settings are those of ``recipe``."""
        values = self.recipe.hyperparameters
        places = []
        for each in self.variations:
            now = values.value(each.name)
            places.append(next(place for place in range(each.count) if each.value(place) == now))
        return self.cells.index(places)

    @property
    def nothing_yet(self) -> Atlas:
        """What is known before the first run."""
        return Atlas(planned=self.cells.count * self.runs)

    @property
    def seeds(self) -> range:
        """The seeds of each cell."""
        return range(self.recipe.seed, self.recipe.seed + self.runs)

    def plan(self, episodes: int) -> SurroundingsPlan:
        """Return the plan of all cells, each run of so many ``episodes``."""
        settings = self.recipe.hyperparameters.as_dict()
        return SurroundingsPlan(
            self.recipe.scenario,
            self.variations,
            {"algorithm": self.recipe.algorithm, **settings},
            episodes=episodes,
            runs=self.runs,
            first_seed=self.recipe.seed,
            in_force=self.in_force,
        )

    def recipe_of(self, index: int, seed: int) -> Recipe:
        """Return how the run of cell ``index`` under ``seed`` starts."""
        values = self.recipe.hyperparameters
        for name, value in self.cells.settings(index).items():
            values = changed_parameter(values, name, value)
        return replace(self.recipe, hyperparameters=values, seed=seed)


def surroundings(recipe: Recipe, world: World, *, is_edited: bool, is_awaited: bool) -> AtlasRequest:
    """Return the request of an atlas around the settings of ``recipe``, whose runs are in ``world``.

    ``is_edited`` says that somebody has changed that world since. Raises UserError, in one line, where there
    is nothing to map.
    """
    if in_kiosk():
        raise UserError("settings are not mapped in a kiosk")
    if recipe.algorithm not in BY_ID:
        raise UserError("your program decides how it learns: there are no settings here to map")
    row = algorithm_row(recipe.algorithm)
    if row.planner:
        raise UserError(f"{row.name} knows the world: no setting changes what it finds, so there is no map")
    if world.mdp is None:
        raise UserError("an environment that is stepped for real is too slow to be mapped; try rl-tui sweep")
    if is_edited:
        raise UserError("the world was drawn on: save it (C, then w), open it, and map that")
    if world.space.pairs > MOST_PAIRS:
        raise UserError(
            f"worlds of more than {MOST_PAIRS:,} pairs of state and action are not mapped; try rl-tui sweep"
        )
    variations = axes_of(recipe, is_bandit=is_bandit(world.space))
    if not variations:
        raise UserError("no number decides how this agent learns: choose another algorithm or policy")
    usual = min(episodes_of(recipe.scenario), world.budget or MOST_EPISODES)
    return AtlasRequest(recipe, variations, usual, RUNS, is_awaited)
