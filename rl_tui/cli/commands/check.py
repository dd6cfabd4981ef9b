"""``rl-tui check``: validate scenario files."""

from __future__ import annotations

import click

from rl_tui.cli.options.run import allow_module_option


@click.command("check")
@click.argument("files", metavar="FILE.toml ...", nargs=-1, required=True)
@allow_module_option
@click.pass_context
def command(context: click.Context, files: tuple[str, ...]) -> None:
    """Report every fault of scenario files.

    Each is a line of its own on stderr, with its place in the file; what is listed there is counted from 0.
    Files without a fault are named on stdout, even where there is a warning on stderr.
    """
    from rl_tui.common.findings import printable
    from rl_tui.lab.experiments.endless import endless_warning
    from rl_tui.lab.run.library import checked

    faulty = False
    for file in files:
        name = printable(file)
        scenario, faults = checked(file)
        for fault in faults:
            click.echo(printable(str(fault)), err=True)
        if scenario is not None and not faults:
            click.echo(f"{name}: ok")
            warning = endless_warning(scenario)
            if warning:
                click.echo(f"{name}: warning: {warning}", err=True)
        faulty = faulty or bool(faults)
    if faulty:
        context.exit(1)
