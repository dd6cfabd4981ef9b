"""``rl-tui new``: write a new scenario file."""

from __future__ import annotations

import click

from rl_tui.commands.line.output import complain
from rl_tui.commands.options.run import Whole
from rl_tui.common.findings import command_line, shown


@click.command("new")
@click.argument("name", metavar="NAME")
@click.option(
    "--template",
    metavar="grid|mdp|bandit|lake|maze|ID",
    default="grid",
    show_default=True,
    help="start with a small blank world, a random lake or maze that can be solved, or a shipped scenario",
)
@click.option("--seed", type=Whole(0), default=0, show_default=True, help="seed of the random lake or maze")
@click.option("--rows", type=Whole(1), help="size of the lake or maze")
@click.option("--columns", type=Whole(1), help="size of the lake or maze")
def command(name: str, template: str, seed: int, rows: int | None, columns: int | None) -> None:
    """Write a new scenario, NAME.toml, into the current folder.

    Existing files are never overwritten. Next, edit the new world with rl-tui edit, and check it.
    """
    from rl_tui.common.errors import UserError
    from rl_tui.common.files import new_path, write_new
    from rl_tui.worlds.editing.templates import named, template_text
    from rl_tui.worlds.files.shipped import SUFFIX

    stem = name.removesuffix(SUFFIX)
    if not any(map(str.isalnum, stem)) or "/" in stem or "\\" in stem:
        raise UserError(f"{shown(name)}: expected a name such as my-maze, which becomes my-maze{SUFFIX}")
    path = new_path(f"{stem}{SUFFIX}")
    write_new(path, named(template_text(template, seed, rows, columns), stem))
    complain(f"Wrote {path}. Edit the world, then check it:")
    argument = command_line([f"./{path}" if stem.startswith("-") else str(path)])
    click.echo(f"rl-tui edit {argument}")
    click.echo(f"rl-tui check --deep {argument}")
