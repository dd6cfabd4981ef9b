"""The option ``--agent``: somebody's own agent in place of one of ours."""

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
    help="your own agent learns: a class or function in a file, which runs with all your rights",
)


def request_of(
    agent: AgentName, start: Recipe | StoredSession, given: Mapping[str, object]
) -> ProgramRequest:
    """Return the request for ``agent`` to learn as ``start`` says, for as long as a person watches.

    ``given`` are the hyper-parameters that a person gave. Raises UserError where there is no such agent,
    UsageError beside a session.
    """
    from rl_tui.commands.line.screen import refuse_where_served
    from rl_tui.programs.grading.agent_training import agent_request, place_of_agent
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.training.seeded_runs import Goal

    refuse_where_served()
    if not isinstance(start, Recipe):
        raise click.UsageError("--agent needs a scenario, not a session", click.get_current_context())
    place_of_agent(agent)  # what is wrong with it is said before the screen is taken
    warn_of_agent(given)
    return agent_request(agent, start, given, Goal())


def warn_of_agent(given: Mapping[str, object]) -> None:
    """Say on stderr which of the options ``given`` no agent of somebody's own is given."""
    from rl_tui.programs.grading.agent_training import GIVEN

    for name in given:
        if name not in GIVEN:
            click.echo(f"--{name.replace('_', '-')} has no effect: your own agent decides that", err=True)
