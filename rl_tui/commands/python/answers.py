"""Exact answers from Python: ``rl_tui.solve``, ``rl_tui.evaluate`` and ``rl_tui.scenarios``.

The keyword settings of ``rl_tui.train`` are here too.
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
    """Hyperparameters as keyword arguments of :func:`rl_tui.train`, which explains each one.

    ``lambda_`` is λ, because ``lambda`` is a Python keyword.
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
    """Return the recipe of a run, and the names of the settings without effect.

    None is the scenario's algorithm.

    Raises:
        UserError: A scenario, algorithm or parameter is unknown, or a value is out of range.
    """
    from rl_tui.runs.library import recipe_named, without_effect

    overrides = {name.removesuffix("_"): _plain(value) for name, value in settings.items()}
    if algorithm is not None:
        overrides["algorithm"] = algorithm
    recipe = recipe_named(str(scenario), overrides, whole(seed, "seed", 0, None))
    return recipe, tuple(without_effect(recipe, overrides))


def goal_of(recipe: Recipe, episodes: int | None, steps: int | None) -> Goal:
    """Return the end of training, by default the scenario's episodes.

    Raises:
        UserError: Both are given, or one is out of range.
    """
    from rl_tui.runs.library import episodes_of
    from rl_tui.runs.training.seeded_runs import Goal

    if episodes is not None and steps is not None:
        raise UserError("give episodes or steps, not both")
    if steps is not None:
        return Goal(steps=whole(steps, "steps", 1, MOST))
    return Goal(episodes=episodes_of(recipe.scenario) if episodes is None else whole(episodes, "episodes"))


def whole(value: object, name: str, least: int = 1, most: int | None = MOST) -> int:
    """Return `value` as a Python integer; NumPy integers are accepted.

    Raises:
        UserError: `value` is not a whole number in this range.
    """
    number = _plain(value)
    if isinstance(number, int) and not isinstance(number, bool) and least <= number <= (most or number):
        return number
    upto = f"{least:,} or more" if most is None else f"from {least:,} to {most:,}"
    raise UserError(f"{name} is {shown(number)}; expected a whole number, {upto}")


def checked(name: str, value: object) -> float:
    """Return a number for the hyperparameter `name`, or raise UserError."""
    from rl_tui.agents.hyperparameters import PARAMETERS

    number = _plain(value)
    if not PARAMETERS[name].accepts(number) or not isinstance(number, int | float):
        raise UserError(f"{name} is {shown(number)}; expected {PARAMETERS[name].expected}")
    return number


def _plain(value: object) -> object:
    # A NumPy scalar becomes a Python number
    item = getattr(value, "item", None)
    return item() if item is not None and getattr(value, "ndim", None) == 0 else value


# The functions


_WORDS: Final = (PolicyKind.UNIFORM, PolicyKind.OPTIMAL, PolicyKind.GREEDY)
_SUFFIX: Final = ".json"


@advice_kept()
def scenarios() -> ScenarioTable:
    """Return all scenarios: the shipped ones in teaching order, then the user's own.

    Scenarios that cannot be read or built are left out.

    Returns:
        A list of :class:`~rl_tui.commands.python.results.ScenarioInfo`. It prints as a table.
    """
    from rl_tui.runs.library import listing, read_catalogue

    found = ScenarioTable()
    for scenario in read_catalogue().scenarios:
        try:
            row = listing(scenario)
        except UserError:
            continue  # cannot be built on this machine
        found.append(ScenarioInfo(**row))
    return found


@advice_kept()
def solve(scenario: str | Path, *, gamma: float | None = None, seed: int = 0) -> SolveResult:
    """Compute the optimal values and policy of a scenario, exact to 1e-9.

    Args:
        scenario: Scenario id, path of a scenario file, or ``gym:ENV_ID``.
        gamma: Discount γ from 0 to 1; None: the scenario's.
        seed: Seed of the world, 0 or more. It matters only if the world is random, such as the arms of a
            bandit.

    Returns:
        Values, Q and policy as arrays; see :class:`~rl_tui.commands.python.results.SolveResult`.

    Raises:
        rl_tui.Error: The world has no transition table, or γ = 1 leaves no finite answer.
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
    """Compute the exact value of a policy in each state, and the length of its episodes.

    Args:
        scenario: Scenario id, path of a scenario file, or ``gym:ENV_ID``.
        policy: One of these: ``"uniform"`` (random), ``"optimal"``, ``"greedy"`` (trained first), the path of
            a JSON file, the result of :func:`rl_tui.train`, or an array. An array holds one action per state,
            whole numbers [S], or probabilities [S, A].
        epsilon: Probability, 0 to 1, that a random action replaces the policy's.
        gamma: Discount γ from 0 to 1; None: the scenario's.
        algorithm: Only for ``"greedy"``: algorithm to train with; None: the scenario's.
        alpha: Only for ``"greedy"``: step size in (0, 1], or ``"sample-average"``.
        episodes: Only for ``"greedy"``: episodes of training; None: the scenario's number.
        steps: Only for ``"greedy"``: steps of training instead of episodes.
        seed: Seed of the world and of the training, 0 or more.

    Returns:
        Values and figures; see :class:`~rl_tui.commands.python.results.EvaluateResult`.

    Raises:
        rl_tui.Error: The world has no transition table, or an argument is unknown or out of range.
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
    # Raises UserError for unknown names, and for arguments that do not apply
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
        raise UserError(
            f'{training[0]} works only with the policy "{PolicyKind.GREEDY}": others need no training'
        )
    return name
