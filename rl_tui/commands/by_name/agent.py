"""``rl-tui agent``: start writing your own agent."""

from __future__ import annotations

from pathlib import Path

import click

from rl_tui.commands.line.output import complain
from rl_tui.common.findings import command_line
from rl_tui.programs.own_agents.binding import Style


@click.group("agent")
def command() -> None:
    """Write your own agent."""


@command.command("new")
@click.argument("file", metavar="FILE.py")
@click.option(
    "--style",
    type=click.Choice([style.value for style in Style]),
    default=Style.GYMNASIUM.value,
    show_default=True,
    help="the style of the agent's code",
)
def new(file: str, style: str) -> None:
    """Write a new file with an agent that lacks its update.

    It runs immediately, but learns nothing until you write the missing line.
    """
    from rl_tui.programs.own_agents.binding import write_skeleton

    write_skeleton(Path(file), Style(style))
    name = command_line([file])
    complain(f"Wrote {file}. Add the missing line (the update), then watch and grade the agent:")
    click.echo(f"rl-tui play frozenlake --agent {name}")
    click.echo(f"rl-tui grade {name} --scenario frozenlake")
