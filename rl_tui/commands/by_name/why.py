"""``rl-tui why``: how long nothing is learned, and why."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from rl_tui.commands.line.output import columns, print_json
from rl_tui.commands.options.run import (
    SectionedCommand,
    allow_module_option,
    json_option,
    run_options,
    scenario_argument,
    seed_option,
)

if TYPE_CHECKING:
    from rl_tui.agents.exact.first_update import FirstUpdate, Wait
    from rl_tui.runs.recipe import Recipe


@click.command("why", cls=SectionedCommand)
@scenario_argument
@run_options
@seed_option
@allow_module_option
@json_option
def command(scenario: str, overrides: dict[str, object], seed: int, as_json: bool) -> None:
    """Print how long nothing is learned, why, and what would help.

    While all estimates are equal, each episode has the same chance to change one. This takes an outcome whose
    target, r + γ·Q or r at the end, differs from Q. The chance is computed from the transition table. The
    agent must be ε-greedy with a constant ε, and update one pair per step.
    """
    from rl_tui.agents.exact.first_update import first_update
    from rl_tui.common.errors import UserError
    from rl_tui.runs.exact_answers import NO_TABLE
    from rl_tui.runs.library import recipe_named
    from rl_tui.runs.recipe import begin

    recipe = recipe_named(scenario, overrides, seed)
    mdp = begin(recipe).world.mdp
    if mdp is None:
        raise UserError(f"{recipe.scenario.id} has no exact values: {NO_TABLE}")
    answer = first_update(mdp, recipe.algorithm, recipe.hyperparameters)
    if as_json:
        print_json(_document(recipe, answer))
    else:
        click.echo(_report(recipe, answer, mdp.time_limit))


def _document(recipe: Recipe, answer: FirstUpdate) -> dict[str, Any]:
    return {
        "scenario": recipe.scenario.id,
        "algorithm": recipe.algorithm,
        "hyperparameters": recipe.hyperparameters.as_dict(),
        "first_update": _figures(answer.wait),
        "cause": answer.cause,
        "distance": answer.distance,
        "remedies": [
            {"setting": remedy.setting, "value": remedy.value, **_figures(remedy.wait)}
            for remedy in answer.remedies
        ],
    }


def _figures(wait: Wait) -> dict[str, float | int | None]:
    return {
        "chance": wait.chance,
        "mean_episodes": wait.mean_episodes,
        "median_episodes": wait.median_episodes,
    }


def _report(recipe: Recipe, answer: FirstUpdate, time_limit: int) -> str:
    from rl_tui.runs.answers.first_update_words import (
        cause_in_words,
        episodes_in_words,
        number_in_words,
        setting_in_words,
        wait_in_words,
    )

    lines = [f"{recipe.scenario.title}: {wait_in_words(answer.wait)}"]
    cause = cause_in_words(answer, recipe.hyperparameters, time_limit)
    if cause:
        lines += ["", f"why: {cause}"]
    if answer.remedies:
        rows = [
            (
                setting_in_words(remedy.setting, remedy.value),
                number_in_words(remedy.wait.chance),
                episodes_in_words(remedy.wait.mean_episodes or 0),
                episodes_in_words(remedy.wait.median_episodes or 0),
            )
            for remedy in answer.remedies
        ]
        lines += ["", columns([("change", "chance", "episodes: mean", "median"), *rows], right=(1, 2, 3))]
    return "\n".join(lines)
