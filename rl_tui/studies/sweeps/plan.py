"""The plan of a sweep: which settings vary, and how."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, product
from math import prod
from pathlib import Path
from typing import Any, Final

from rl_tui.agents.catalogue import POLICY_BY_ID, parameters_of
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.common.limits import MOST_SWEEP_CELLS, MOST_SWEEP_EPISODES, MOST_SWEEP_ROWS, MOST_SWEEP_RUNS
from rl_tui.common.words import counted
from rl_tui.runs.library import episodes_of, recipe_for
from rl_tui.runs.recipe import Recipe, changed_parameter
from rl_tui.runs.training.seeded_runs import Goal
from rl_tui.studies.sweeps.cell import Cell, SkippedCell
from rl_tui.studies.sweeps.cells.content import WorldContent, Worlds, plain_text
from rl_tui.studies.sweeps.cells.order import Axis, coarse_first
from rl_tui.studies.sweeps.cells.variation import (
    ALGORITHM,
    SCENARIO,
    Value,
    Variation,
    read_variation,
    written,
)
from rl_tui.worlds.editing.edit import PREFIX
from rl_tui.worlds.files.scenario import Scenario, scenario_of

# The plan


LARGEST_SEED: Final = 9 * 10**18
"""Largest integer of a database and of a kernel."""
_MOST_TRIED: Final = 2_000
_MOST_RECIPES: Final = 64


@dataclass(frozen=True)
class Shard:
    """One of several `parts` of a plan, `number` from 1."""

    number: int
    parts: int


WHOLE: Final = Shard(1, 1)


@dataclass(frozen=True)
class SweepPlan:
    """A grid of settings, or `random` points in it, all with the same seeds."""

    scenario: Scenario
    variations: tuple[Variation, ...]
    overrides: Mapping[str, object] = field(default_factory=dict)
    episodes: int | None = None
    """Episodes of each run, or None for the scenario's default."""
    runs: int = 10
    """Number of seeds of each cell."""
    first_seed: int = 0
    """First seed, common to all cells."""
    random: int | None = None
    random_seed: int = 0
    worlds: Worlds = field(default_factory=Worlds, compare=False, repr=False)
    """Cache of the cells' worlds."""
    _recipes: dict[tuple[object, ...], Recipe] = field(
        default_factory=dict, init=False, compare=False, repr=False
    )

    @property
    def seeds(self) -> range:
        """Seeds of each cell."""
        return range(self.first_seed, self.first_seed + self.runs)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the varying settings."""
        return tuple(each.name for each in self.variations)

    @property
    def count(self) -> int:
        """Number of cells, including those that cannot work."""
        return prod(each.count for each in self.variations) if self.random is None else self.random

    def cell(self, index: int) -> Cell | SkippedCell:
        """Return cell `index`, from 0. The last setting varies fastest."""
        return self.cell_of(index, self.settings(index))

    def cell_of(self, index: int, settings: Mapping[str, Value]) -> Cell | SkippedCell:
        """Return the cell of `settings`, even outside the plan."""
        world = {name: value for name, value in world_settings(settings).items() if name != SCENARIO}
        try:
            content = self.worlds.of(self._scenario(settings), world, self.first_seed)
            recipe = self._recipe(content, settings)
            check_compatible(content.example.space, recipe.algorithm, recipe.hyperparameters)
        except UserError as reason:
            return SkippedCell(index, settings, str(reason))
        return Cell(
            index, settings, recipe, Goal(episodes=self.episodes or episodes_of(content.scenario)), content
        )

    def settings(self, index: int) -> dict[str, Value]:
        """Return the settings of cell `index` by name."""
        if not 0 <= index < self.count:
            raise IndexError(index)
        if self.random is not None:
            return self._drawn(index)
        chosen = []
        for each in reversed(self.variations):
            index, place = divmod(index, each.count)
            chosen.append((each.name, each.value(place)))
        return dict(reversed(chosen))

    def order(self, shard: Shard = WHOLE) -> Iterator[int]:
        """Yield each cell of `shard`, a coarse lattice first, random points as drawn."""
        every = (
            coarse_first([Axis(each.count, each.spread is not None) for each in self.variations])
            if self.random is None
            else iter(range(self.random))
        )
        return (index for place, index in enumerate(every) if place % shard.parts == shard.number - 1)

    def size_of(self, shard: Shard) -> int:
        """Return the number of cells in `shard`."""
        return len(range(shard.number - 1, self.count, shard.parts))

    def check(self) -> None:
        """Raise UserError if a value works in no cell, or for too many cells."""
        names = self.names
        for name in names:
            if names.count(name) > 1:
                raise UserError(f"--vary {name} is given twice: give all of its values at once")
        for each in self.variations:
            if each.count == 0 and self.random is None:
                raise UserError(
                    f"--vary {each.text}: the number of values is missing; "
                    f"expected {each.text}:COUNT, or --random N"
                )
        if self.first_seed + 2 * self.runs > LARGEST_SEED:
            raise UserError(
                f"--seed {self.first_seed} is too large here; expected less than {LARGEST_SEED:.0e}"
            )
        if self.count > MOST_SWEEP_CELLS:
            raise UserError(
                f"{self.count:,} cells are more than the {MOST_SWEEP_CELLS:,} allowed; "
                "vary less, or use --random N"
            )
        for each in self.variations:
            for value in _telling(each):
                self._check_value(each, value)

    def without_effect(self) -> list[str]:
        """Return the settings that no algorithm or policy uses."""
        choices = [each for each in self.variations if each.name in (ALGORITHM, SCENARIO, "policy")]
        used = {"ties"}  # they decide the greedy policy, whatever the agent's policy is
        for chosen in islice(product(*(each.listed for each in choices)), _MOST_TRIED):
            first = {each.name: _telling(each)[0] for each in self.variations}
            cell = self.cell_of(
                0, first | {each.name: value for each, value in zip(choices, chosen, strict=True)}
            )
            if isinstance(cell, Cell):
                used.update(parameters_of(cell.recipe.algorithm, cell.recipe.hyperparameters.policy))
        return [name for name in (*self.names, *self.overrides) if name in PARAMETERS and name not in used]

    def _check_value(self, variation: Variation, value: Value) -> None:
        others = [each for each in self.variations if each is not variation and _decides(each)]
        fault = ""
        for number, chosen in enumerate(product(*(_telling(each) for each in others))):
            settings = {each.name: _telling(each)[0] for each in self.variations}
            settings |= {each.name: picked for each, picked in zip(others, chosen, strict=True)}
            cell = self.cell_of(0, settings | {variation.name: value})
            if isinstance(cell, Cell) or number == _MOST_TRIED:
                return
            fault = fault or cell.reason
        raise UserError(f"--vary {variation.name}={written(value)}: {fault}")

    def _scenario(self, settings: Mapping[str, Value]) -> Scenario | str:
        return str(settings[SCENARIO]) if SCENARIO in settings else self.scenario

    def _recipe(self, content: WorldContent, settings: Mapping[str, Value]) -> Recipe:
        common = {name: value for name, value in settings.items() if name in (ALGORITHM, "policy")}
        policy = POLICY_BY_ID.get(str(common.get("policy", self.overrides.get("policy"))))
        if "alpha" in settings and (policy is None or policy.needs_step_size):
            common["alpha"] = settings["alpha"]  # a given alpha decides the kind of step size
        place = content.scenario, *common.items()
        known = self._recipes.get(place)
        if known is None:
            known = recipe_for(content.scenario, {**self.overrides, **common}, self.first_seed)
            if len(self._recipes) == _MOST_RECIPES:
                self._recipes.clear()
            self._recipes[place] = known
        values = known.hyperparameters
        for name, value in settings.items():
            if name in PARAMETERS and name not in common:
                values = changed_parameter(values, name, value)
        return replace(known, hyperparameters=values)

    def _drawn(self, index: int) -> dict[str, Value]:
        from numpy.random import PCG64, Generator, SeedSequence

        generator = Generator(PCG64(SeedSequence((self.random_seed, index))))
        return {each.name: each.drawn(float(generator.random())) for each in self.variations}


def world_settings(settings: Mapping[str, Value]) -> dict[str, Value]:
    """Return the settings that change the world."""
    return {name: value for name, value in settings.items() if name == SCENARIO or name.startswith(PREFIX)}


def _decides(variation: Variation) -> bool:
    """Return True if a value may decide whether others work. A number never does."""
    return variation.spread is None or variation.name.startswith(PREFIX)


def _telling(variation: Variation) -> Sequence[Value]:
    """Return values that show whether all can work."""
    spread = variation.spread
    if spread is None:
        return variation.listed
    return spread.ends


# The plan as text


_LONGEST_FAULT: Final = 200


def written_plan(plan: SweepPlan) -> str:
    """Format `plan`, world and defaults as JSON, equal for equal plans."""
    return json.dumps(
        {
            "scenario": plan.scenario.id,
            "text": plain_text(plan.scenario),
            "vary": [each.text for each in plan.variations],
            "settings": dict(plan.overrides),
            "episodes": plan.episodes,
            "runs": plan.runs,
            "first_seed": plan.first_seed,
            "random": plan.random,
            "random_seed": plan.random_seed,
        },
        sort_keys=True,
    )


def read_plan(text: str) -> SweepPlan:
    """Parse a plan. Raises UserError."""
    try:
        said: dict[str, Any] = json.loads(text)
        plan = SweepPlan(
            scenario_of(said["text"], Path(f"{said['scenario']}.toml"), ask_environment=False),
            tuple(map(read_variation, said["vary"])),
            _settings(said["settings"]),
            _whole(said, "episodes", 1, MOST_SWEEP_EPISODES, optional=True),
            _whole(said, "runs", 1, MOST_SWEEP_RUNS) or 0,
            _whole(said, "first_seed", 0, LARGEST_SEED) or 0,
            _whole(said, "random", 1, MOST_SWEEP_CELLS, optional=True),
            _whole(said, "random_seed", 0, LARGEST_SEED) or 0,
        )
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as fault:
        raise UserError(f"not a sweep plan ({one_line(str(fault), _LONGEST_FAULT)})") from fault
    if plan.count * plan.runs > MOST_SWEEP_ROWS:
        raise UserError(
            f"this sweep has {plan.count:,} cells of {counted(plan.runs, 'run')}; "
            f"at most {MOST_SWEEP_ROWS:,} runs fit into a chart: plot a smaller sweep"
        )
    return plan


def _settings(said: object) -> dict[str, object]:
    if not isinstance(said, dict) or not all(isinstance(each, str | int | float) for each in said.values()):
        raise ValueError("settings must be words or numbers")
    return said


def _whole(said: dict[str, Any], name: str, least: int, most: int, *, optional: bool = False) -> int | None:
    value = said[name]
    if value is None and optional:
        return None
    if type(value) is not int or not least <= value <= most:
        raise ValueError(f"{name} is {shown(value)}; expected a whole number from {least} to {most:,}")
    return value
