"""The request for a settings map: values around those of a run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

from rl_tui.agents.catalogue import BY_ID, algorithm_row, parameters_of
from rl_tui.agents.compatibility import is_bandit
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, Parameter, why_idle
from rl_tui.common.kiosk import in_kiosk
from rl_tui.runs.library import MOST_EPISODES, episodes_of
from rl_tui.runs.recipe import Recipe, changed_parameter
from rl_tui.studies.atlas.cells import CellGrid
from rl_tui.studies.atlas.figures import Atlas
from rl_tui.studies.sweeps.cells.order import Axis, coarse_first
from rl_tui.studies.sweeps.cells.variation import Variation
from rl_tui.studies.sweeps.plan import WHOLE, Shard, SweepPlan
from rl_tui.worlds.world import World

# Which settings vary, and their values


MOST_COLUMNS: Final = 11
MOST_ROWS: Final = 7
_STEPS: Final = (1.0, 2.0, 2.5, 5.0, 10.0)
_HALF_DECADES: Final = 3  # on either side of the current value
_DOUBLINGS: Final = 3
_DIGITS: Final = 2
_REACH: Final = 5.0  # upper end as a multiple of the current value, for linear sliders


def axes_of(recipe: Recipe, *, is_bandit: bool) -> tuple[Variation, ...]:
    """Choose columns, and perhaps rows, for the algorithm of `recipe`.

    Columns have the setting that most algorithms share, such as a step size, rows the one that fewest share,
    which characterizes the algorithm or policy.
    """
    values = recipe.hyperparameters
    names = _candidates(recipe.algorithm, values, is_bandit=is_bandit)
    if not names:
        return ()
    commonest = max(names, key=_spread)
    own = [name for name in names if name != commonest]
    columns = _variation(commonest, values, MOST_COLUMNS)
    if not own:
        return (columns,)
    return _variation(min(own, key=_rank), values, MOST_ROWS), columns


def _candidates(algorithm: str, values: Hyperparameters, *, is_bandit: bool) -> list[str]:
    planned = {name for row in BY_ID.values() if row.planner for name in row.parameters}
    return [
        name
        for name in parameters_of(algorithm, values.policy)
        if name not in planned
        and PARAMETERS[name].range is not None
        and not PARAMETERS[name].schedule
        and not (name == "alpha" and values.sample_average)
        and not why_idle(name, algorithm, values, is_bandit=is_bandit)
    ]


def _spread(name: str) -> int:
    return sum(name in row.parameters for row in BY_ID.values())


def _rank(name: str) -> tuple[bool, int, int]:
    """Return a sort key: rare parameters of the algorithm, then of the policy, then bounds of accuracy."""
    parameter = PARAMETERS[name]
    is_bound = parameter.slide is None and not parameter.whole
    return is_bound, _spread(name) or len(BY_ID), list(PARAMETERS).index(name)


def _variation(name: str, values: Hyperparameters, most: int) -> Variation:
    parameter, now = PARAMETERS[name], float(values.value(name))
    usual = Hyperparameters().value(name)
    around = values_around(parameter, now, float(usual) if not isinstance(usual, str) else 1.0, most)
    whole = [int(each) if parameter.whole else each for each in around]
    return Variation(name, tuple(whole))


def values_around(parameter: Parameter, now: float, usual: float, most: int) -> list[float]:
    """Choose about `most` ascending values of `parameter` around `now`, which is included.

    A linear slider gives equal distances from its low end to at most five times `now`, a logarithmic one
    equal ratios. Without a slider, whole numbers are doubled and halved, others multiplied by ten. From 0 the
    ratios start at `usual`.
    """
    slide = parameter.slide
    if slide is not None and not slide.logarithmic:
        reach = _REACH * (now - slide.low)
        high = min(slide.high, slide.low + reach) if reach > 0.0 else slide.high
        around: Iterable[float] = _even(slide.low, high, most - 1)
    else:
        base = now or usual or 1.0
        around = _in_ratios(parameter, base)
    allowed = {round(each) if parameter.whole else each for each in around}
    if parameter.range is not None and 0.0 in parameter.range and parameter.slide is None:
        allowed.add(0.0)
    sound = {float(each) for each in allowed if parameter.accepts(each)}
    return sorted(sound | {now})


def _even(low: float, high: float, most: int) -> list[float]:
    """Return numbers from `low` to `high` at equal, round distances, fewer than `most` of them apart."""
    width = high - low
    magnitude = 10.0 ** math.floor(math.log10(width / most))
    step = next(each * magnitude for each in _STEPS if width / (each * magnitude) < most + 1e-9)
    return [_rounded(low + number * step) for number in range(math.floor(width / step + 1e-9) + 1)]


def _in_ratios(parameter: Parameter, base: float) -> list[float]:
    if parameter.slide is not None:
        powers = range(-_HALF_DECADES, _HALF_DECADES + 1)
        low, high = parameter.slide.low, parameter.slide.high
        around = [_rounded(base * 10.0 ** (power / 2.0), _DIGITS) for power in powers]
        return [each for each in around if low <= each <= high]
    ratio = 2.0 if parameter.whole else 10.0
    return [_rounded(base * ratio**power) for power in range(-_DOUBLINGS, _DOUBLINGS + 1)]


def _rounded(number: float, digits: int = 12) -> float:
    return float(f"{number:.{digits}g}")


# The request


WORK: Final = "rl_tui.studies.atlas.work:work"
"""Runs in a process of its own, with imports that this process does not need."""
RUNS: Final = 10
"""Seeds of each cell: the fewest that give an interval and a comparison."""
MOST_PAIRS: Final = 20_000
"""Most pairs of a world. Larger ones would take minutes, mostly for exact results."""


@dataclass(frozen=True)
class SurroundingsPlan(SweepPlan):
    """A plan that begins with the current cell, then a coarse lattice."""

    in_force: int = 0
    """Number of the first cell."""

    def order(self, shard: Shard = WHOLE) -> Iterator[int]:
        """Yield each cell of `shard`, the current one first."""
        coarse = coarse_first([Axis(each.count, spread=True) for each in self.variations])
        every = (self.in_force, *(index for index in coarse if index != self.in_force))
        return (index for place, index in enumerate(every) if place % shard.parts == shard.number - 1)


@dataclass(frozen=True)
class AtlasRequest:
    """The request for the map around `recipe`."""

    recipe: Recipe
    """The run with its current settings. Its seed is the first of each cell."""
    variations: tuple[Variation, ...]
    """Rows and columns, or only columns."""
    episodes: int
    """Wanted episodes of each run, if time allows."""
    runs: int
    """Seeds of each cell."""
    is_awaited: bool
    """True if the caller waits, so that the work keeps a normal priority."""

    @cached_property
    def cells(self) -> CellGrid:
        """Numbers and positions of the cells."""
        return CellGrid(self.variations)

    @cached_property
    def in_force(self) -> int:
        """Number of the cell with the settings of `recipe`."""
        values = self.recipe.hyperparameters
        places = []
        for each in self.variations:
            now = values.value(each.name)
            places.append(next(place for place in range(each.count) if each.value(place) == now))
        return self.cells.index(places)

    @property
    def nothing_yet(self) -> Atlas:
        """The map before the first run."""
        return Atlas(planned=self.cells.count * self.runs)

    @property
    def seeds(self) -> range:
        """Seeds of each cell."""
        return range(self.recipe.seed, self.recipe.seed + self.runs)

    def plan(self, episodes: int) -> SurroundingsPlan:
        """Return the plan of all cells."""
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
        """Return the recipe of cell `index`."""
        values = self.recipe.hyperparameters
        for name, value in self.cells.settings(index).items():
            values = changed_parameter(values, name, value)
        return replace(self.recipe, hyperparameters=values, seed=seed)


def why_unmapped(recipe: Recipe, world: World, *, is_edited: bool) -> str:
    """Return why there is no map around `recipe`, or ""."""
    row = algorithm_row(recipe.algorithm)
    if in_kiosk():
        return "the settings map is not available in a kiosk"
    if row.planner:
        return f"{row.name} plans with the model, so no setting changes its result"
    if world.mdp is None:
        return "a simulated environment is too slow for a map; use rl-tui sweep"
    if is_edited:
        return "the world was edited: save it (w d, then w s), then open and map the saved file"
    if world.space.pairs > MOST_PAIRS:
        return f"worlds of more than {MOST_PAIRS:,} state–action pairs have no map; use rl-tui sweep"
    is_varied = bool(axes_of(recipe, is_bandit=is_bandit(world.space)))
    return "" if is_varied else "this agent has no numeric settings: choose another algorithm or policy"


def surroundings(recipe: Recipe, world: World, *, is_awaited: bool) -> AtlasRequest:
    """Return the request for a map, if `why_unmapped` returned ""."""
    variations = axes_of(recipe, is_bandit=is_bandit(world.space))
    usual = min(episodes_of(recipe.scenario), world.budget or MOST_EPISODES)
    return AtlasRequest(recipe, variations, usual, RUNS, is_awaited)
