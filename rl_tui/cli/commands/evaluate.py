"""``rl-tui evaluate``: what any policy is worth, exactly."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import click

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.cli.options.numbers import ParameterValue, Whole
from rl_tui.cli.options.run import (
    algorithm_option,
    allow_module_option,
    json_option,
    parameter_option,
    scenario_argument,
    seed_option,
    warn_of_no_effect,
)
from rl_tui.cli.output import print_json
from rl_tui.cli.progress import finish_compiling, progress, with_compiling
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lab.answers.policy_kind import PolicyKind

if TYPE_CHECKING:
    from rl_tui.lab.run.recipe import Beginning, Recipe
    from rl_tui.worlds.mdp.space import FloatArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

MOST: Final = 10**15
WORDS: Final = (PolicyKind.UNIFORM, PolicyKind.OPTIMAL, PolicyKind.GREEDY)
SUFFIX: Final = ".json"
CHOICES: Final = f"{', '.join(WORDS)} or FILE{SUFFIX}"
_FOR_GREEDY: Final = f"  [{PolicyKind.GREEDY} only]"


class _Policy(NamedTuple):
    """A policy, [P], and the world as it is when it is followed.

    ``not_given`` says in how many states a file leaves open what is done; None without a file.
    """

    mdp: TabularMDP
    chances: FloatArray
    not_given: int | None = None


@click.command("evaluate")
@scenario_argument
@click.option(
    "--policy",
    "name",
    metavar="|".join((*WORDS, f"FILE{SUFFIX}")),
    help="any action, the best as rl-tui solve has it, the greedy one of what rl-tui train learns, or what a "
    'file says: {"STATE": "ACTION"} or {"STATE": {"ACTION": CHANCE}}',
)
@click.option(
    "--epsilon",
    "mixed",
    type=ParameterValue(PARAMETERS["epsilon"]),
    default=0.0,
    show_default=True,
    help="take a random action so much of the time, which may be the policy's own",
)
@parameter_option("gamma", "  [default: the scenario's]")
@algorithm_option("trained_by", _FOR_GREEDY)
@parameter_option("alpha", _FOR_GREEDY)
@click.option("--episodes", type=Whole(1, MOST), help=f"train so many episodes{_FOR_GREEDY}")
@click.option("--steps", type=Whole(1, MOST), help=f"train so many steps instead{_FOR_GREEDY}")
@seed_option
@allow_module_option
@json_option
def command(
    scenario: str,
    name: str | None,
    mixed: float,
    gamma: float | None,
    trained_by: str | None,
    alpha: float | str | None,
    episodes: int | None,
    steps: int | None,
    seed: int,
    as_json: bool,
) -> None:
    """Print what a policy is worth in each state, exactly, and how long its episodes last.

    Among equally good actions the best policy picks evenly; so does a file where it says nothing of a state.
    An agent is trained with the scenario's own ε, and --epsilon counts for what it has learned. An example:

    rl-tui evaluate cliff --policy optimal --epsilon 0.1
    """
    if name is None:
        raise click.UsageError(f"--policy is missing; expected {CHOICES}", click.get_current_context())
    training = {"algorithm": trained_by, "alpha": alpha, "episodes": episodes, "steps": steps}
    _check(name, {option: value for option, value in training.items() if value is not None})
    from rl_tui.agents.exact.policies import softened
    from rl_tui.agents.exact.policy_figures import figures
    from rl_tui.lab.run.figures import finite
    from rl_tui.lab.run.library import recipe_named
    from rl_tui.lab.run.recipe import begin

    settings: dict[str, object] = {"algorithm": trained_by, "alpha": alpha, "gamma": gamma}
    overrides = {setting: value for setting, value in settings.items() if value is not None}
    recipe = recipe_named(scenario, overrides, seed)
    if alpha is not None:
        warn_of_no_effect(recipe, {"alpha": alpha})
    beginning = begin(recipe)
    found = _find(name, recipe, beginning, episodes, steps)
    policy = softened(found.mdp, found.chances, mixed)
    of_policy = figures(found.mdp, policy, recipe.hyperparameters.gamma)
    v = [None] * found.mdp.states if of_policy.v is None else finite(of_policy.v.tolist())
    answer: dict[str, Any] = {
        "scenario": recipe.scenario.id,
        "gamma": recipe.hyperparameters.gamma,
        "policy": name,
        "epsilon": mixed,
        "value_at_start": of_policy.value_at_start,
        "expected_return": of_policy.expected_return,
        "steps": of_policy.steps,
        "V": dict(zip(found.mdp.state_names, v, strict=True)),
        "ends": of_policy.ends,
        "not_given": found.not_given,
    }
    if as_json:
        print_json(answer)
    else:
        from rl_tui.cli.reports.evaluation import evaluation

        click.echo(evaluation(recipe.scenario.title, beginning.world, policy, answer))
    if name == PolicyKind.GREEDY:
        finish_compiling()


def _check(name: str, training: Mapping[str, object]) -> None:
    """Raise UsageError where there is no policy of that ``name``, or options of a ``training`` do not fit."""
    context = click.get_current_context()
    if name not in WORDS and not name.endswith(SUFFIX) and not os.path.exists(name):
        said = f"--policy is {shown(name)}; expected {CHOICES}{near(name, WORDS)}"
        raise click.UsageError(said, context)
    if training and name != PolicyKind.GREEDY:
        option = f"--{next(iter(training))}"
        raise click.UsageError(
            f"{option} needs --policy {PolicyKind.GREEDY}: no other policy is learned", context
        )
    if "episodes" in training and "steps" in training:
        raise click.UsageError("--episodes and --steps exclude each other", context)


def _find(
    name: str, recipe: Recipe, beginning: Beginning, episodes: int | None, steps: int | None
) -> _Policy:
    """Return the policy of that ``name`` in the world of ``recipe``, or the one in the file of that name.

    Raises UserError where there is none, or the world has no table.
    """
    from rl_tui.agents.exact.policies import policy_of_choices, uniform_policy
    from rl_tui.lab.run.exact_answers import NO_TABLE

    mdp = beginning.world.mdp
    if mdp is None:
        raise UserError(f"{recipe.scenario.id} has no exact answer: {NO_TABLE}")
    if name == PolicyKind.UNIFORM:
        return _Policy(mdp, uniform_policy(mdp))
    if name == PolicyKind.OPTIMAL:
        return _Policy(mdp, _optimal(mdp, recipe.hyperparameters.gamma))
    if name == PolicyKind.GREEDY:
        return _learned(recipe, beginning, episodes, steps)
    from rl_tui.lab.run.policy_file import read_policy

    choices = read_policy(name, mdp)
    live = sum(bool(mdp.pairs_of(state)) for state in range(mdp.states))
    return _Policy(mdp, policy_of_choices(mdp, choices), live - len(choices))


def _optimal(mdp: TabularMDP, gamma: float) -> FloatArray:
    """Return the policy, [P], that picks evenly among the best pairs, as ``rl-tui solve`` prints it."""
    from rl_tui.agents.exact.policies import uniform_over
    from rl_tui.agents.exact.solve import solve
    from rl_tui.lab.run.figures import MOST_STATES

    if mdp.states > MOST_STATES:
        click.echo(f"{mdp.states:,} states: the exact answer may take many minutes", err=True)
    return uniform_over(mdp, solve(mdp, gamma).greedy)


def _learned(recipe: Recipe, beginning: Beginning, episodes: int | None, steps: int | None) -> _Policy:
    """Return the greedy policy of what ``rl-tui train`` learns, in the world as it is then."""
    from rl_tui.agents.exact.policies import greedy_policy
    from rl_tui.lab.experiments.training import Goal, train
    from rl_tui.lab.run.library import episodes_of
    from rl_tui.lab.run.run import Run

    goal = Goal(steps=steps) if steps is not None else Goal(episodes=episodes or episodes_of(recipe.scenario))
    run = Run(recipe, beginning, evaluate=False)
    with progress(recipe.scenario.id) as on_progress:
        train(run, goal, with_compiling(on_progress))
    mdp = run.learner.mdp
    assert mdp is not None  # it has the table that the world has
    return _Policy(mdp, greedy_policy(mdp, run.learner.q, run.learner.hyperparameters.ties))
