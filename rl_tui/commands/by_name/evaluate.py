"""``rl-tui evaluate``: the exact value of any policy."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import nullcontext
from typing import Final

import click

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.commands.line.output import finish_compiling, print_json, progress, with_compiling
from rl_tui.commands.options.run import (
    ParameterValue,
    Whole,
    algorithm_option,
    allow_module_option,
    json_option,
    parameter_option,
    scenario_argument,
    seed_option,
    warn_of_no_effect,
)
from rl_tui.common.findings import near, shown
from rl_tui.runs.answers.policy_kind import PolicyKind

MOST: Final = 10**15
WORDS: Final = (PolicyKind.UNIFORM, PolicyKind.OPTIMAL, PolicyKind.GREEDY)
SUFFIX: Final = ".json"
CHOICES: Final = f"{', '.join(WORDS)} or FILE{SUFFIX}"
_FOR_GREEDY: Final = f"  [{PolicyKind.GREEDY} only]"


@click.command("evaluate")
@scenario_argument
@click.option(
    "--policy",
    "name",
    metavar="|".join((*WORDS, f"FILE{SUFFIX}")),
    help="random, optimal, greedy (an agent is trained first), or a file: "
    '{"STATE": "ACTION"} or {"STATE": {"ACTION": CHANCE}}',
)
@click.option(
    "--epsilon",
    "mixed",
    type=ParameterValue(PARAMETERS["epsilon"]),
    default=0.0,
    show_default=True,
    help="probability that a random action replaces the action of the policy",
)
@parameter_option("gamma", "  [default: the scenario's]")
@algorithm_option("trained_by", _FOR_GREEDY)
@parameter_option("alpha", _FOR_GREEDY)
@click.option("--episodes", type=Whole(1, MOST), help=f"number of episodes to train{_FOR_GREEDY}")
@click.option(
    "--steps", type=Whole(1, MOST), help=f"number of steps to train, instead of episodes{_FOR_GREEDY}"
)
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
    """Print the exact value of a policy in each state.

    The report also has the return and length of an episode. If several actions are optimal, the optimal
    policy takes each equally often. In states that a policy file does not mention, actions are random. An
    agent is trained with the scenario's ε. --epsilon applies only after training. An example:

    rl-tui evaluate cliff --policy optimal --epsilon 0.1
    """
    if name is None:
        raise click.UsageError(f"--policy is missing; expected {CHOICES}", click.get_current_context())
    training = {"algorithm": trained_by, "alpha": alpha, "episodes": episodes, "steps": steps}
    _check(name, {option: value for option, value in training.items() if value is not None})
    from rl_tui.runs.figures import MOST_STATES
    from rl_tui.runs.library import episodes_of, recipe_named
    from rl_tui.runs.recipe import begin
    from rl_tui.runs.training.evaluating import evaluation_of, policy_named, table_of
    from rl_tui.runs.training.seeded_runs import Goal, no_progress

    settings: dict[str, object] = {"algorithm": trained_by, "alpha": alpha, "gamma": gamma}
    overrides = {setting: value for setting, value in settings.items() if value is not None}
    recipe = recipe_named(scenario, overrides, seed)
    if alpha is not None:
        warn_of_no_effect(recipe, {"alpha": alpha})
    beginning = begin(recipe)
    states = table_of(recipe, beginning).states
    if name == PolicyKind.OPTIMAL and states > MOST_STATES:
        click.echo(f"{states:,} states: the exact values may take many minutes", err=True)
    goal = Goal(steps=steps) if steps is not None else Goal(episodes=episodes or episodes_of(recipe.scenario))
    with progress(recipe.scenario.id) if name == PolicyKind.GREEDY else nullcontext() as bar:
        on_progress = no_progress if bar is None else with_compiling(bar)
        found = policy_named(name, recipe, beginning, goal, on_progress)
    policy, answer = evaluation_of(recipe, name, found, mixed)
    if as_json:
        print_json(answer)
    else:
        from rl_tui.commands.reports.evaluation import evaluation

        click.echo(evaluation(recipe.scenario.title, beginning.world, policy, answer))
    if name == PolicyKind.GREEDY:
        finish_compiling()


def _check(name: str, training: Mapping[str, object]) -> None:
    context = click.get_current_context()
    if name not in WORDS and not name.endswith(SUFFIX) and not os.path.exists(name):
        said = f"--policy is {shown(name)}; expected {CHOICES}{near(name, WORDS)}"
        raise click.UsageError(said, context)
    if training and name != PolicyKind.GREEDY:
        option = f"--{next(iter(training))}"
        raise click.UsageError(
            f"{option} works only with --policy {PolicyKind.GREEDY}: other policies need no training", context
        )
    if "episodes" in training and "steps" in training:
        raise click.UsageError("give --episodes or --steps, not both", context)
