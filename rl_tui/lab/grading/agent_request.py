"""From an agent's file and a scenario to what its process is told."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.lab.experiments.training import Goal
from rl_tui.lab.own_agents.loading import AgentName, AgentPlace, runs_when_imported, the_agent
from rl_tui.lab.programs.child.source import read_script
from rl_tui.lab.programs.program_process import ProgramRequest
from rl_tui.lab.run.recipe import Recipe
from rl_tui.worlds.files.shipped import shipped_folder

GIVEN: Final = ("alpha", "gamma", "epsilon", "epsilon_decay", "epsilon_min", "initial_q")
"""The hyper-parameters that an agent can be given."""


def place_of_agent(agent: AgentName) -> AgentPlace:
    """Return where in its file ``agent`` is.

    Raises UserError where there is none, or there are several, or the file learns as soon as it is imported.
    """
    tree = read_script(agent.path).tree
    place = the_agent(tree, agent.path, agent.name)
    if runs_when_imported(tree):
        name = shown(agent.path.name)
        raise UserError(
            f"{name} makes an environment and learns in it as soon as it is imported: put its loop below "
            'if __name__ == "__main__":, or watch it as it is with rl-tui watch'
        )
    return place


def agent_request(
    agent: AgentName, recipe: Recipe, given: Mapping[str, object], goal: Goal, memory: int | None = None
) -> ProgramRequest:
    """Return the request for ``agent`` to learn in the scenario and with the seed of ``recipe``.

    ``given`` are the hyper-parameters that a person gave, by name; those that no agent takes are left out.
    Raises UserError where one is no number.
    """
    numbers: dict[str, float] = {}
    for name in GIVEN:
        value = given.get(name)
        if isinstance(value, str):
            raise UserError(f"--{name.replace('_', '-')} is {shown(value)}; an agent is given a number")
        if isinstance(value, (int, float)):
            numbers[name] = float(value)
    return ProgramRequest(
        agent.path,
        seed=recipe.seed,
        steps=goal.steps,
        agent=agent.name,
        scenario=_scenario_name(recipe),
        episodes=goal.episodes,
        hyperparameters=numbers,
        defaults=_defaults(recipe.hyperparameters),
        memory=memory,
    )


def _defaults(values: Hyperparameters) -> dict[str, float]:
    """Return what holds where neither a person nor the agent says anything.

    Agents understand a decay in several ways; none decays to an ε that is where it starts.
    """
    epsilon = values.epsilon
    usual = Hyperparameters()
    return {
        "alpha": float(usual.alpha if isinstance(values.alpha, str) else values.alpha),
        "gamma": values.gamma,
        "epsilon": epsilon,
        "epsilon_decay": values.epsilon_decay,
        "epsilon_min": values.epsilon_min if values.epsilon_decay else epsilon,
        "initial_q": values.initial_q,
    }


def _scenario_name(recipe: Recipe) -> str:
    """Return by what the scenario is found in another process: its id where it is shipped, else its file."""
    source = recipe.scenario.source
    return recipe.scenario.id if source.parent == shipped_folder() else str(source)
