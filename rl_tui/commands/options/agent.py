"""The option ``--agent``: the user's own agent."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import click

if TYPE_CHECKING:
    from rl_tui.live.sessions.session import StoredSession
    from rl_tui.programs.own_agents.loading import AgentName
    from rl_tui.programs.watched.program_process import ProgramRequest
    from rl_tui.runs.recipe import Recipe


def _agent_name(_: click.Context, __: click.Parameter, text: str | None) -> AgentName | None:
    from rl_tui.programs.own_agents.loading import AgentName

    return None if text is None else AgentName.read(text)


agent_option: Final = click.option(
    "--agent",
    metavar="FILE.py[:NAME]",
    callback=_agent_name,
    help="train your own agent, a class or function in a file; it runs with all your rights",
)


def request_of(
    agent: AgentName, start: Recipe | StoredSession, given: Mapping[str, object]
) -> ProgramRequest:
    """Return the request to watch `agent` learn without end.

    Raises:
        UserError: There is no such agent.
        click.UsageError: `start` is a session.
    """
    from rl_tui.commands.line.screen import refuse_where_served
    from rl_tui.programs.grading.agent_training import agent_request, place_of_agent
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.training.seeded_runs import Goal

    refuse_where_served()
    if not isinstance(start, Recipe):
        raise click.UsageError("--agent needs a scenario, not a session", click.get_current_context())
    place_of_agent(agent)  # reports errors before the screen opens
    warn_of_agent(given)
    return agent_request(agent, start, given, Goal())


def warn_of_agent(given: Mapping[str, object]) -> None:
    """Warn about options that a user's own agent never receives."""
    from rl_tui.programs.grading.agent_training import GIVEN

    for name in given:
        if name not in GIVEN:
            click.echo(f"--{name.replace('_', '-')} has no effect: your own agent decides that", err=True)
