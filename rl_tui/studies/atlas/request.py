"""The request for a settings map: settings around those of a run.

The map varies one or two settings that matter most for the algorithm, within 11 columns and 7 rows. The
current value is always one of those tried.
"""

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
_HALF_DECADES: Final = 3  # on either side of the value in force
_DOUBLINGS: Final = 3
_DIGITS: Final = 2
_REACH: Final = 5.0  # so many times the value in force, from 0 on, where a slider is linear


def axes_of(recipe: Recipe, *, is_bandit: bool) -> tuple[Variation, ...]:
    """Return the settings that matter most for what ``recipe`` learns by: rows, then columns; one or none.

    The value in force is one of the values of each, as it stands. Columns are the setting that most
    algorithms have (a step size); rows the one that fewest have, which is what makes this algorithm or this
    policy another one.
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
    """Return the numbers that decide how ``algorithm`` learns, in the order of the controls panel.

    What a planner has too is no way to learn, but part of the question: γ, and what estimates start from.
    """
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
    """Return how many algorithms have the parameter ``name`` themselves."""
    return sum(name in row.parameters for row in BY_ID.values())


def _rank(name: str) -> tuple[bool, int, int]:
    """Return a low number for what few algorithms have; the policy's own come behind the algorithm's.

    Bounds of accuracy, which have neither a slider nor whole numbers, come last.
    """
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
    """Return some ``most`` values of ``parameter``, ascending; ``now``, the one in force, is one of them.

    Where its slider is linear they lie at equal distances, from its low end to five times ``now`` at most;
    where it is logarithmic at equal ratios around ``now``. What has no slider is doubled and halved if it is
    whole, else taken ten times; from 0, where ratios lead nowhere, ``usual`` is what they start from.
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
    """Return numbers from ``low`` to ``high`` at equal, round distances, at most ``most`` of these."""
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


def why_unmapped(recipe: Recipe, world: World, *, is_edited: bool) -> str:
    """Return why there is no map around the settings of ``recipe``, whose runs are in ``world``, as a clause.

    It is empty where there is one. ``is_edited`` says that somebody has changed that world since.
    """
    row = algorithm_row(recipe.algorithm)
    if in_kiosk():
        return "settings are not mapped in a kiosk"
    if row.planner:
        return f"{row.name} knows the world: no setting changes what it finds, so there is no map"
    if world.mdp is None:
        return "an environment that is stepped for real is too slow to be mapped; try rl-tui sweep"
    if is_edited:
        return "the world was edited: save it (w d, then w s), open it, and map that"
    if world.space.pairs > MOST_PAIRS:
        return (
            f"worlds of more than {MOST_PAIRS:,} pairs of state and action are not mapped; try rl-tui sweep"
        )
    is_varied = bool(axes_of(recipe, is_bandit=is_bandit(world.space)))
    return "" if is_varied else "no number decides how this agent learns: choose another algorithm or policy"


def surroundings(recipe: Recipe, world: World, *, is_awaited: bool) -> AtlasRequest:
    """Return the request of an atlas around the settings of ``recipe``, whose runs are in ``world``.

    There is one: :func:`why_unmapped` says so.
    """
    variations = axes_of(recipe, is_bandit=is_bandit(world.space))
    usual = min(episodes_of(recipe.scenario), world.budget or MOST_EPISODES)
    return AtlasRequest(recipe, variations, usual, RUNS, is_awaited)
