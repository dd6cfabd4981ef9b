"""``rl-tui check``: validate scenario and lesson files."""

from __future__ import annotations

from dataclasses import replace

import click

from rl_tui.commands.line.output import print_json
from rl_tui.commands.options.run import FILE, allow_module_option, json_option, seed_option


@click.command("check")
@click.argument("files", metavar="FILE.toml ...", nargs=-1, required=True, type=FILE)
@click.option("--quick", is_flag=True, help="skip checks of lessons that need many seeds")
@click.option("--deep", is_flag=True, help="exact facts about one scenario, given by file or id")
@seed_option
@allow_module_option
@json_option
@click.pass_context
def command(
    context: click.Context, files: tuple[str, ...], quick: bool, deep: bool, seed: int, as_json: bool
) -> None:
    """Report every error in scenario files and lesson files.

    Each error is one line on stderr, with its place in the file. Lists count from 0. Each number of a lesson
    is recomputed, and each task must accept its right examples and reject its wrong ones. Files without
    errors are listed on stdout, even if they have warnings on stderr.

    With --deep you get exact facts about one scenario: the returns of the random and the optimal policy, the
    shortest path, how long nothing is learned, the γ at which optimal actions change, and unreachable states.
    Short training runs show algorithms whose greedy policy may never end. --seed matters if the world is
    random. --json prints all facts as one document.
    """
    from rl_tui.lessons.check import is_lesson_file

    if deep:
        if len(files) != 1:
            raise click.UsageError("--deep takes one scenario", context)
        if is_lesson_file(files[0]):
            raise click.UsageError(f"{files[0]} is a lesson: leave out --deep", context)
        if _deep(files[0], seed, as_json=as_json):
            context.exit(1)
        return
    if as_json:
        raise click.UsageError("--json needs --deep", context)
    from rl_tui.common.findings import printable

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


def _deep(name: str, seed: int, *, as_json: bool) -> bool:
    # Returns True if the file has errors
    from rl_tui.agents.catalogue import BY_ID
    from rl_tui.commands.line.output import progress
    from rl_tui.commands.reports.flip_points import check_document, check_report
    from rl_tui.common.errors import ScenarioError
    from rl_tui.common.findings import printable
    from rl_tui.runs.library import episodes_of, find, recipe_for
    from rl_tui.runs.recipe import begin
    from rl_tui.studies.world_check.deep_check import Question, reports, without_table
    from rl_tui.studies.world_check.report import WorldReport

    try:
        recipe = recipe_for(find(name), seed=seed)
        world = begin(recipe).world
    except ScenarioError as error:
        if not as_json:
            raise
        print_json(check_document([printable(str(fault)) for fault in error.faults], None, WorldReport()))
        return True
    if world.mdp is None:
        report = without_table()
    else:
        asked = Question(world.mdp, recipe.algorithm, recipe.hyperparameters, episodes_of(recipe.scenario))
        with progress(name) as bar:
            for report in reports(asked):
                if report.trying:
                    bar(list(BY_ID).index(report.trying), len(BY_ID))
    if as_json:
        print_json(check_document([], world, report))
    else:
        click.echo(check_report(recipe, world, report))
        for warning in report.warnings:
            click.echo(f"{printable(name)}: warning: {warning}", err=True)
    return False


def _scenario(file: str) -> tuple[list[str], list[str]]:
    from rl_tui.runs.library import checked
    from rl_tui.runs.training.endless import endless_warning

    scenario, faults = checked(file)
    warning = endless_warning(scenario) if scenario is not None and not faults else ""
    return [str(fault) for fault in faults], [f"{file}: warning: {warning}"] if warning else []


def _lesson(file: str, *, quick: bool) -> tuple[list[str], list[str]]:
    from rl_tui.commands.line.output import progress
    from rl_tui.lessons.check import check_lesson

    with progress(file) as bar:
        report = check_lesson(file, quick=quick, on_checked=lambda done, wanted, what: bar(done, wanted))
    warnings = (replace(each, file=f"{each.file}: warning") for each in report.warnings)
    return [str(fault) for fault in report.faults], [str(each) for each in warnings]
