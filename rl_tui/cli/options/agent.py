"""The option ``--agent``: somebody's own agent in place of one of ours."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import click

if TYPE_CHECKING:
    from rl_tui.lab.own_agents.loading import AgentName


def _agent_name(_: click.Context, __: click.Parameter, text: str | None) -> AgentName | None:
    from rl_tui.lab.own_agents.loading import AgentName

    return None if text is None else AgentName.read(text)


agent_option: Final = click.option(
    "--agent",
    metavar="FILE.py[:NAME]",
    callback=_agent_name,
    help="your own agent learns: a class or function in a file, which runs with all your rights",
)


def warn_of_agent(given: Mapping[str, object]) -> None:
    """Say on stderr which of the options ``given`` no agent of somebody's own is given."""
    from rl_tui.lab.grading.agent_request import GIVEN

    for name in given:
        if name not in GIVEN:
            click.echo(f"--{name.replace('_', '-')} has no effect: your own agent decides that", err=True)
