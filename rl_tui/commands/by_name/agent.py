"""``rl-tui agent``: start writing your own agent."""

from __future__ import annotations

import shlex
from pathlib import Path

import click

from rl_tui.commands.line.output import complain
from rl_tui.programs.own_agents.binding import Style


@click.group("agent")
def command() -> None:
    """Begin an agent of your own."""


@command.command("new")
@click.argument("file", metavar="FILE.py")
@click.option(
    "--style",
    type=click.Choice([style.value for style in Style]),
    default=Style.GYMNASIUM.value,
    show_default=True,
    help="the shape that you were taught",
)
def new(file: str, style: str) -> None:
    """Write an agent whose update is left out, into a new file.

    It runs as it is, and learns nothing until you write the line that is missing.
    """
    from rl_tui.programs.own_agents.binding import write_skeleton

    write_skeleton(Path(file), Style(style))
    name = shlex.quote(file)
    complain(f"{file} is written; its update is the line that is missing")
    click.echo(f"rl-tui play frozenlake --agent {name}")
    click.echo(f"rl-tui grade {name} --scenario frozenlake")
