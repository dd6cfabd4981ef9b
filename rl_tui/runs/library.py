"""From a scenario to the recipe of a run."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.errors import Fault, ScenarioError, UserError, first_of
from rl_tui.common.findings import Finding, near, place, shown
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.runs.recipe import Recipe, begin, changed_parameter
from rl_tui.worlds.files import catalogue
from rl_tui.worlds.files.scenario import Scenario, read_scenario, scenario_of
from rl_tui.worlds.sections.schema import unknown_key

DEFAULT_ALGORITHM: Final = "q-learning"
DEFAULT_EPISODES: Final = 1_000
MOST_EPISODES: Final = 10**15
_KEYS: Final = ("algorithm", "episodes", *PARAMETERS)
_ALGORITHMS: Final = f"one of {', '.join(BY_ID)}"


def read_catalogue() -> catalogue.Catalogue:
    """Read every scenario file. One with wrong defaults counts as broken."""
    sound, broken = [], []
    found = catalogue.read_catalogue()
    for scenario in found.scenarios:
        try:
            _check_defaults(scenario)
        except ScenarioError as error:
            broken.append(error)
        else:
            sound.append(scenario)
    return catalogue.Catalogue(sound, [*found.broken, *broken])


def find(name_or_path: str) -> Scenario:
    """Return the scenario with this id or file. Raises ScenarioError with all errors, or UserError."""
    text = ""
    try:
        scenario = catalogue.find(name_or_path)
        text = scenario.text
        _check_defaults(scenario)
    except ScenarioError as error:
        # the first errors hide others: neither the environment nor all tables were checked
        file, text = error.faults[0].file, error.text or text
        everything = _checked(file, lambda: scenario_of(text, Path(file)))[1] if text else ()
        raise ScenarioError(everything if len(everything) > len(error.faults) else error.faults) from error
    return scenario


def checked(path: str | Path) -> tuple[Scenario | None, list[Fault]]:
    """Return the scenario in a file (None if its world is wrong) and the first 100 errors."""
    return _checked(str(path), lambda: read_scenario(path))


def _checked(file: str, read: Callable[[], Scenario]) -> tuple[Scenario | None, list[Fault]]:
    try:
        scenario = read()
        return scenario, list(first_of(_default_faults(file, scenario.defaults)))
    except ScenarioError as error:
        world_faults, raw = list(error.faults), error.tables
    defaults = raw.get("defaults")
    faults = first_of(_default_faults(file, defaults)) if isinstance(defaults, dict) else ()
    tables = list(raw)

    def table_of(fault: Fault) -> int:
        name = fault.place.split(".")[0].split("[")[0]
        return tables.index(name) if name in tables else len(tables)

    return None, list(first_of(sorted([*world_faults, *faults], key=table_of)))


def reread(scenario: Scenario) -> Scenario | None:
    """Return the scenario now in the file of `scenario`, or None if unchanged. Raises ScenarioError."""
    path = scenario.source
    if not scenario.text or not os.path.isfile(path):  # isfile never raises
        return None
    with suppress(UnreadableError):
        if read_text(path) == scenario.text:
            return None
    found, faults = checked(path)
    if found is None or faults:
        raise ScenarioError(faults)
    return found


def recipe_with(scenario: Scenario, recipe: Recipe) -> Recipe:
    """Return `recipe` for a newer `scenario`, keeping seed and changed settings. Raises UserError."""
    before = recipe_for(recipe.scenario)
    kept: dict[str, object] = {
        name: recipe.hyperparameters.value(name)
        for name in PARAMETERS
        if recipe.hyperparameters.value(name) != before.hyperparameters.value(name)
    }
    if recipe.algorithm != before.algorithm:
        kept["algorithm"] = recipe.algorithm
    return recipe_for(scenario, kept, recipe.seed)


def recipe_for(scenario: Scenario, overrides: Mapping[str, object] | None = None, seed: int = 0) -> Recipe:
    """Return the recipe for `scenario`. Raises ScenarioError (defaults) or UserError (`overrides`)."""
    _check_defaults(scenario)
    return _recipe(scenario, overrides or {}, seed)


def recipe_named(name_or_path: str, overrides: Mapping[str, object] | None = None, seed: int = 0) -> Recipe:
    """Find a scenario and return its recipe."""
    return _recipe(find(name_or_path), overrides or {}, seed)


def _recipe(scenario: Scenario, overrides: Mapping[str, object], seed: int) -> Recipe:
    chosen = {**scenario.defaults, **overrides}
    chosen.pop("episodes", None)
    algorithm = chosen.pop("algorithm", DEFAULT_ALGORITHM)
    if not isinstance(algorithm, str) or algorithm not in BY_ID:
        raise UserError(
            f"algorithm is {shown(algorithm)}; expected {_ALGORITHMS}{near(str(algorithm), BY_ID)}"
        )
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise UserError(f"seed is {shown(seed)}; expected a whole number, 0 or more")
    hyperparameters = Hyperparameters()
    for name, value in chosen.items():
        if name not in PARAMETERS:
            raise UserError(f"there is no setting {shown(name)}{near(name, PARAMETERS)}")
        hyperparameters = changed_parameter(hyperparameters, name, value)
    if POLICY_BY_ID[hyperparameters.policy].needs_step_size and "alpha" not in overrides:
        # a bandit's default, the sample average, is not a step size; a number stays
        hyperparameters = hyperparameters.without_average()
    return Recipe(scenario, algorithm, hyperparameters, seed)


def without_effect(recipe: Recipe, overrides: Mapping[str, object]) -> list[str]:
    """Return the `overrides` that `recipe` ignores."""
    used = parameters_of(recipe.algorithm, recipe.hyperparameters.policy)
    return [name for name in overrides if name in PARAMETERS and name not in used]


def episodes_of(scenario: Scenario) -> int:
    """Return the default number of training episodes."""
    return int(scenario.defaults.get("episodes", DEFAULT_EPISODES))


def listing(scenario: Scenario) -> dict[str, Any]:
    """Return the row of `scenario` in `list --json`. Raises UserError if its world cannot be built."""
    recipe = recipe_for(scenario)
    mdp = begin(recipe).world.space
    return {
        "id": scenario.id,
        "title": scenario.title,
        "kind": scenario.kind,
        "states": mdp.states,
        "actions": len(mdp.action_names),
        "pairs": mdp.pairs,
        "time_limit": mdp.time_limit,
        "defaults": {
            "algorithm": recipe.algorithm,
            "episodes": episodes_of(scenario),
            **recipe.hyperparameters.as_dict(),
        },
    }


def _check_defaults(scenario: Scenario) -> None:
    faults = first_of(_default_faults(str(scenario.source), scenario.defaults))
    if faults:
        raise ScenarioError(faults)


def _default_faults(file: str, defaults: Mapping[str, Any]) -> Iterator[Fault]:
    for key, value in defaults.items():
        finding = _default_finding(key, value)
        if finding is not None:
            yield Fault(file, place(finding.inside("defaults").location), finding.found, finding.expected)


def _default_finding(key: str, value: object) -> Finding | None:
    if key not in _KEYS:
        return unknown_key((key,), _KEYS)
    if key == "algorithm":
        known = isinstance(value, str) and value in BY_ID
        return None if known else Finding((key,), shown(value), f"{_ALGORITHMS}{near(str(value), BY_ID)}")
    if key == "episodes":
        whole = isinstance(value, int) and not isinstance(value, bool)
        if whole and 1 <= value <= MOST_EPISODES:  # type: ignore[operator]
            return None
        return Finding((key,), shown(value), "a whole number, 1 or more")
    parameter = PARAMETERS[key]
    return None if parameter.accepts(value) else Finding((key,), shown(value), parameter.expected)
