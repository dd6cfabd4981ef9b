"""What to say of an option that a command does not have."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches

import click


def unknown_option(fault: click.NoSuchOption, program: click.Group) -> str:
    """Return that there is none, and which commands of ``program`` have it or else which one is near."""
    option, context = fault.option_name, fault.ctx
    said = f"there is no option {option}"
    if context is None:
        return said
    owners = [
        name for name, command in _commands(program, context.find_root()) if option in _options(command)
    ]
    if owners:
        return f"{said} here; it is one of {', '.join(owners)}"
    # without the dashes, which all of them have in common
    names = {each.lstrip("-"): each for each in _options(context.command) if each.startswith("--")}
    near = get_close_matches(option.lstrip("-"), names, n=1)
    return f"{said}; did you mean {names[near[0]]}?" if near else said


def _commands(program: click.Group, context: click.Context) -> Iterator[tuple[str, click.Command]]:
    yield context.info_name or "", program
    for name in program.list_commands(context):
        command = program.get_command(context, name)
        if command is not None:
            yield f"{context.info_name} {name}", command


def _options(command: click.Command) -> list[str]:
    return [name for option in command.params for name in (*option.opts, *option.secondary_opts)]
