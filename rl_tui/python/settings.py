"""What may be said about the agent by keyword, and how it becomes a recipe."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, TypedDict

from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown

if TYPE_CHECKING:
    from rl_tui.lab.experiments.training import Goal
    from rl_tui.lab.run.recipe import Recipe

MOST: Final = 10**15
MOST_RUNS: Final = 100_000


class Settings(TypedDict, total=False):
    """The hyper-parameters by the names that ``rl-tui train --help`` lists, with their ranges.

    ``lambda_`` is λ: the name itself is a word of Python's. What is not given is as the scenario suggests.
    """

    alpha: float | Literal["sample-average"]
    step_size_schedule: str
    alpha_min: float
    alpha_decay: float
    gamma: float
    policy: str
    epsilon: float
    epsilon_schedule: str
    epsilon_min: float
    epsilon_decay: float
    temperature: float
    confidence: float
    baseline: str
    lambda_: float
    traces: str
    n: int
    planning_steps: int
    threshold: float
    accuracy: float
    initial_q: float
    ties: Literal["random", "first"]


def recipe_of(
    scenario: str | Path, algorithm: str | None, settings: Mapping[str, object], seed: int
) -> tuple[Recipe, tuple[str, ...]]:
    """Return how the run starts, and which settings neither algorithm nor policy use.

    Raises UserError where there is no such scenario, algorithm or hyper-parameter, with near names, or a
    value is out of its range.
    """
    from rl_tui.lab.run.library import recipe_named, without_effect

    overrides = {name.removesuffix("_"): _plain(value) for name, value in settings.items()}
    if algorithm is not None:
        overrides["algorithm"] = algorithm
    recipe = recipe_named(str(scenario), overrides, whole(seed, "seed", 0, None))
    return recipe, tuple(without_effect(recipe, overrides))


def goal_of(recipe: Recipe, episodes: int | None, steps: int | None) -> Goal:
    """Return when training ends: after so many episodes or steps, else after the scenario's episodes.

    Raises UserError where both are given, or one is out of its range.
    """
    from rl_tui.lab.experiments.training import Goal
    from rl_tui.lab.run.library import episodes_of

    if episodes is not None and steps is not None:
        raise UserError("episodes and steps exclude each other: leave one of them out")
    if steps is not None:
        return Goal(steps=whole(steps, "steps", 1, MOST))
    return Goal(episodes=episodes_of(recipe.scenario) if episodes is None else whole(episodes, "episodes"))


def whole(value: object, name: str, least: int = 1, most: int | None = MOST) -> int:
    """Return the whole number ``value``, also one of NumPy's. Raises UserError out of its range."""
    number = _plain(value)
    if isinstance(number, int) and not isinstance(number, bool) and least <= number <= (most or number):
        return number
    upto = f"{least:,} or more" if most is None else f"from {least:,} to {most:,}"
    raise UserError(f"{name} is {shown(number)}; expected a whole number, {upto}")


def checked(name: str, value: object) -> float:
    """Return a number that the hyper-parameter ``name`` may have. Raises UserError out of its range."""
    from rl_tui.agents.hyperparameters import PARAMETERS

    number = _plain(value)
    if not PARAMETERS[name].accepts(number) or not isinstance(number, int | float):
        raise UserError(f"{name} is {shown(number)}; expected {PARAMETERS[name].expected}")
    return number


def _plain(value: object) -> object:
    """Return a number of NumPy's as one of Python's, and anything else as it is."""
    item = getattr(value, "item", None)
    return item() if item is not None and getattr(value, "ndim", None) == 0 else value
