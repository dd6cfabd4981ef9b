"""``rl-tui solve``: optimal values and policy by dynamic programming."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.commands.line.output import columns, number, print_json
from rl_tui.commands.options.run import (
    allow_module_option,
    json_option,
    parameter_option,
    scenario_argument,
    seed_option,
)
from rl_tui.common.words import counted

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World

_GREEDY_IS_NOT_ENOUGH: Final = """\
At γ = 1, a greedy policy for Q* may circle forever and never earn what Q* promises. So the policy
contains only those optimal actions that lead to a terminal state. Left out: {}."""


@click.command("solve")
@scenario_argument
@parameter_option("gamma", "  [default: the scenario's]")
@click.option("--flips", is_flag=True, help="also print the exact γ at which optimal actions change")
@seed_option
@allow_module_option
@json_option
def command(scenario: str, gamma: float | None, flips: bool, seed: int, as_json: bool) -> None:
    """Print the optimal values and policy, exact to 1e-9.

    The seed matters only if the world is random, such as the arms of a bandit or a random map.
    """
    from rl_tui.agents.exact.solve import solve
    from rl_tui.common.errors import UserError
    from rl_tui.runs.exact_answers import NO_TABLE
    from rl_tui.runs.figures import MOST_STATES, solution_figures
    from rl_tui.runs.library import recipe_named
    from rl_tui.runs.recipe import begin

    recipe = recipe_named(scenario, {} if gamma is None else {"gamma": gamma}, seed)
    world = begin(recipe).world
    mdp = world.mdp
    if mdp is None:
        raise UserError(f"{recipe.scenario.id} has no exact values: {NO_TABLE}")
    if mdp.states > MOST_STATES:
        click.echo(f"{mdp.states:,} states: the exact values may take many minutes", err=True)
    solution = solve(mdp, recipe.hyperparameters.gamma)
    answer = solution_figures(recipe, mdp, solution)
    changes = _with_flips(world, mdp, answer) if flips else None
    if as_json:
        print_json(answer)
        return
    left_out = int((solution.best & ~solution.greedy).sum())
    click.echo(_report(recipe.scenario.title, world, answer, left_out))
    if changes is not None:
        click.echo(f"\n{changes}")


def _with_flips(world: World, mdp: TabularMDP, answer: dict[str, Any]) -> str:
    from rl_tui.agents.exact.flips import flips
    from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
    from rl_tui.commands.reports.flip_points import flips_document, flips_report

    try:
        found = flips(mdp)
    except NoExactAnswer as refusal:
        answer["flips"], answer["flips_refused"] = None, str(refusal)
        return str(refusal)
    answer["flips"] = flips_document(mdp, found)
    return flips_report(world, found)


def _report(title: str, world: World, answer: dict[str, Any], left_out: int) -> str:
    # `left_out` counts actions that are optimal by Q* but may never end
    from rl_tui.commands.reports.policy_map import as_shown, policy_map
    from rl_tui.screen.draw.action_order import shown_order
    from rl_tui.worlds.drawing import Grid

    order, policy = shown_order(world), as_shown(world, answer["policy"])
    head = ("state", "V", *(f"Q {answer['actions'][action]}" for action in order), "policy")
    rows = [
        (
            state,
            number(answer["v"][index], ".5f"),
            *("" if (q := answer["q"][index][action]) is None else number(q, ".5f") for action in order),
            ", ".join(policy[index]),
        )
        for index, state in enumerate(answer["states"])
    ]
    limit = world.space.time_limit
    within = f", within {counted(limit, 'step')}" if limit else ""
    any_policy = "of any policy that knows the time left" if limit else "of any policy that ends"
    summary = [
        ("value at the start", number(answer["value_at_start"], ".5f"), f"discounted, γ {answer['gamma']:g}"),
        (
            "expected return",
            number(answer["expected_return"], ".5f"),
            f"undiscounted{within}, of this policy",
        ),
        (
            "best return",
            number(answer["best_expected_return"], ".5f"),
            f"likewise, the largest {any_policy}",
        ),
    ]
    rounds = counted(answer["iterations"], "round")
    parts = [f"{title}: exact, by policy iteration ({rounds} of evaluation and improvement)", ""]
    parts += [columns([head, *rows], right=range(1, len(head) - 1)), ""]
    if isinstance(world.drawing, Grid):
        parts += [policy_map(world, policy), ""]
    parts.append(columns(summary))
    if left_out:
        parts += ["", _GREEDY_IS_NOT_ENOUGH.format(counted(left_out, "action"))]
    return "\n".join(parts)
