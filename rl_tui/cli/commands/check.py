"""``rl-tui check``: validate scenario and lesson files."""

from __future__ import annotations

from dataclasses import replace

import click

from rl_tui.cli.options.run import allow_module_option


@click.command("check")
@click.argument("files", metavar="FILE.toml ...", nargs=-1, required=True)
@click.option("--quick", is_flag=True, help="of lessons, leave out what takes many seeds")
@allow_module_option
@click.pass_context
def command(context: click.Context, files: tuple[str, ...], quick: bool) -> None:
    """Report every fault of scenario files, and of lesson files, which have pages.

    Each is a line of its own on stderr, with its place in the file; what is listed there is counted from 0.
    Of a lesson each number is worked out again, and each task has to pass what it accepts and to refuse what
    it rejects. Files without a fault are named on stdout, even where there is a warning on stderr.
    """
    from rl_tui.common.findings import printable
    from rl_tui.lab.course.check import is_lesson_file

    faulty = False
    for file in files:
        faults, warnings = _lesson(file, quick=quick) if is_lesson_file(file) else _scenario(file)
        name = printable(file)
        for fault in faults:
            click.echo(printable(fault), err=True)
        if not faults:
            click.echo(f"{name}: ok")
        for warning in warnings:
            click.echo(printable(warning), err=True)
        faulty = faulty or bool(faults)
    if faulty:
        context.exit(1)


def _scenario(file: str) -> tuple[list[str], list[str]]:
    """Return the faults of a scenario file, and what it is warned of."""
    from rl_tui.lab.experiments.endless import endless_warning
    from rl_tui.lab.run.library import checked

    scenario, faults = checked(file)
    warning = endless_warning(scenario) if scenario is not None and not faults else ""
    return [str(fault) for fault in faults], [f"{file}: warning: {warning}"] if warning else []


def _lesson(file: str, *, quick: bool) -> tuple[list[str], list[str]]:
    """Return the faults of a lesson file, and what it is warned of."""
    from rl_tui.cli.progress import progress
    from rl_tui.lab.course.check import check_lesson

    with progress(file) as bar:
        report = check_lesson(file, quick=quick, on_checked=lambda done, wanted, what: bar(done, wanted))
    warnings = (replace(each, file=f"{each.file}: warning") for each in report.warnings)
    return [str(fault) for fault in report.faults], [str(each) for each in warnings]
