"""Exact answers from Python: ``rl_tui.solve``, ``rl_tui.evaluate`` and ``rl_tui.scenarios``.

Their settings, which ``rl_tui.train`` shares, are given by keyword.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, TypedDict

from rl_tui.commands.python.results import (
    EvaluateResult,
    ScenarioInfo,
    ScenarioTable,
    SolveResult,
    TrainResult,
)
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.worlds.gym.advice import advice_kept

if TYPE_CHECKING:
    import numpy.typing as npt

    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.training.seeded_runs import Goal


# Settings by keyword


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
    from rl_tui.runs.library import recipe_named, without_effect

    overrides = {name.removesuffix("_"): _plain(value) for name, value in settings.items()}
    if algorithm is not None:
        overrides["algorithm"] = algorithm
    recipe = recipe_named(str(scenario), overrides, whole(seed, "seed", 0, None))
    return recipe, tuple(without_effect(recipe, overrides))


def goal_of(recipe: Recipe, episodes: int | None, steps: int | None) -> Goal:
    """Return when training ends: after so many episodes or steps, else after the scenario's episodes.

    Raises UserError where both are given, or one is out of its range.
    """
    from rl_tui.runs.library import episodes_of
    from rl_tui.runs.training.seeded_runs import Goal

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


# The functions


_WORDS: Final = (PolicyKind.UNIFORM, PolicyKind.OPTIMAL, PolicyKind.GREEDY)
_SUFFIX: Final = ".json"


@advice_kept()
def scenarios() -> ScenarioTable:
    """Return the scenarios there are, in teaching order, then the user's own; broken files are left out.

    The list prints as a table, a row for each.
    """
    from rl_tui.runs.library import listing, read_catalogue

    found = ScenarioTable()
    for scenario in read_catalogue().scenarios:
        try:
            row = listing(scenario)
        except UserError:
            continue  # it cannot be built here
        found.append(ScenarioInfo(**row))
    return found


@advice_kept()
def solve(scenario: str | Path, *, gamma: float | None = None, seed: int = 0) -> SolveResult:
    """Return the optimal values and policy, exact to 1e-9.

    ``gamma``, from 0 to 1, is the scenario's where it is not given. ``seed`` counts only where the world
    depends on it: the arms of a bandit, a random map. Raises rl_tui.Error where the world has no table, or
    gamma = 1 leaves no answer.
    """
    from rl_tui.agents.exact.policy_figures import uniform_over
    from rl_tui.agents.exact.solve import solve as solve_exactly
    from rl_tui.commands.python.arrays import by_state
    from rl_tui.runs.figures import solution_figures
    from rl_tui.runs.recipe import begin
    from rl_tui.runs.training.evaluating import table_of

    recipe, _ = recipe_of(scenario, None, {} if gamma is None else {"gamma": gamma}, seed)
    mdp = table_of(recipe, begin(recipe))
    solution = solve_exactly(mdp, recipe.hyperparameters.gamma)
    figures = solution_figures(recipe, mdp, solution)
    return SolveResult(
        scenario=recipe.scenario.id,
        gamma=solution.gamma,
        states=tuple(mdp.state_names),
        actions=mdp.action_names,
        v=solution.v,
        q=by_state(mdp, solution.q),
        policy=by_state(mdp, uniform_over(mdp, solution.greedy), 0.0),
        value_at_start=solution.value_at_start,
        expected_return=figures["expected_return"],
        best_expected_return=figures["best_expected_return"],
        figures=figures,
    )


@advice_kept()
def evaluate(
    scenario: str | Path,
    policy: str | Path | TrainResult | npt.ArrayLike,
    *,
    epsilon: float = 0.0,
    gamma: float | None = None,
    algorithm: str | None = None,
    alpha: float | str | None = None,
    episodes: int | None = None,
    steps: int | None = None,
    seed: int = 0,
) -> EvaluateResult:
    """Return what a policy is worth in each state, exactly, and how long its episodes last.

    ``policy`` is "uniform", "optimal", "greedy" (of what is learned with ``algorithm``, ``alpha``,
    ``episodes`` or ``steps`` and ``seed``, all else being the scenario's), the path of a JSON file, what
    :func:`rl_tui.train` returned, or an array: an action in each state, [S] whole numbers, or probabilities,
    [S, A]. ``epsilon``, from 0 to 1, of the time a random action is taken instead. ``gamma`` is the
    scenario's where it is not given. Raises rl_tui.Error where the world has no table, or something is not
    known or out of its range.
    """
    from rl_tui.commands.python.arrays import by_state, choices_in, numbers
    from rl_tui.runs.recipe import begin
    from rl_tui.runs.training.evaluating import evaluation_of, policy_named, policy_of, table_of

    training = {"algorithm": algorithm, "alpha": alpha, "episodes": episodes, "steps": steps}
    name = _name_of(policy, [each for each, value in training.items() if value is not None])
    settings = {key: value for key, value in {"gamma": gamma, "alpha": alpha}.items() if value is not None}
    recipe, _ = recipe_of(scenario, algorithm, settings, seed)
    mixed = float(checked("epsilon", epsilon))
    beginning = begin(recipe)
    mdp = table_of(recipe, beginning)
    if isinstance(policy, str | Path):
        followed = policy_named(name, recipe, beginning, goal_of(recipe, episodes, steps))
    else:
        array = policy.policy if isinstance(policy, TrainResult) else policy
        followed = policy_of(mdp, choices_in(mdp, array))
    chances, figures = evaluation_of(recipe, name, followed, mixed)
    return EvaluateResult(
        scenario=recipe.scenario.id,
        gamma=recipe.hyperparameters.gamma,
        policy_name=name,
        epsilon=mixed,
        states=tuple(mdp.state_names),
        actions=mdp.action_names,
        policy=by_state(mdp, chances),
        v=numbers(figures["V"].values()),
        value_at_start=figures["value_at_start"],
        expected_return=figures["expected_return"],
        steps=figures["steps"],
        ends=figures["ends"],
        figures=figures,
    )


def _name_of(policy: object, training: Sequence[str]) -> str:
    """Return what the policy is called. Raises UserError for an unknown name, and ``training`` of no use."""
    if isinstance(policy, TrainResult):
        name = "trained"
    elif isinstance(policy, str | Path):
        name = str(policy)
        if name not in _WORDS and not name.endswith(_SUFFIX):
            expected = f"{', '.join(_WORDS)}, a file FILE{_SUFFIX}, or an array"
            raise UserError(f"policy is {shown(name)}; expected {expected}{near(name, _WORDS)}")
    else:
        name = "array"
    if training and name != PolicyKind.GREEDY:
        raise UserError(f'{training[0]} needs the policy "{PolicyKind.GREEDY}": no other policy is learned')
    return name
