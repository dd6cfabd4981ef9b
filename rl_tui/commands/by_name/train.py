"""``rl-tui train``: the runs of the screen, without a screen."""

from __future__ import annotations

from contextlib import nullcontext
from typing import TYPE_CHECKING, Any, Final, TextIO

import click

from rl_tui.commands.line.output import complain, finish_compiling, print_json, progress, with_compiling
from rl_tui.commands.options.agent import agent_option, warn_of_agent
from rl_tui.commands.options.run import (
    ChangeValue,
    CsvTarget,
    SectionedCommand,
    Whole,
    allow_module_option,
    check_targets,
    csv_option,
    curve_option,
    is_stdout,
    json_option,
    run_options,
    scenario_argument,
    seed_option,
    warn_of_no_effect,
)
from rl_tui.common.words import counted

if TYPE_CHECKING:
    from rl_tui.programs.own_agents.loading import AgentName
    from rl_tui.runs.recipe import JournalEntry, Recipe
    from rl_tui.runs.run import Run
    from rl_tui.runs.training.seeded_runs import Goal

MOST: Final = 10**15
MOST_RUNS: Final = 100_000


@click.command("train", cls=SectionedCommand)
@scenario_argument
@click.option(
    "--episodes", type=Whole(1, MOST), help="number of episodes to train  [default: the scenario's]"
)
@click.option("--steps", type=Whole(1, MOST), help="number of steps to train, instead of episodes")
@click.option("--runs", type=Whole(1, MOST_RUNS), help="number of runs, with consecutive seeds")
@csv_option
@curve_option
@click.option(
    "--change",
    "changes",
    type=ChangeValue(),
    multiple=True,
    help="after STEP steps, change a setting such as epsilon=0, algorithm=NAME, or the world, such as "
    "world.cell[1,2]=#. take=ACTION takes one action for the agent. sweep=evaluation and "
    "sweep=improvement are for policy iteration. Repeat it for more changes",
)
@agent_option
@allow_module_option
@run_options
@seed_option
@json_option
def command(
    scenario: str,
    episodes: int | None,
    steps: int | None,
    runs: int | None,
    csv: CsvTarget,
    curve: CsvTarget,
    changes: tuple[JournalEntry, ...],
    agent: AgentName | None,
    overrides: dict[str, object],
    seed: int,
    as_json: bool,
) -> None:
    """Train an agent, and print what it has learned.

    The run is the same as on screen. The report compares it with the exact values. An example:

    rl-tui train student --runs 50 --curve student.csv
    """
    if episodes is not None and steps is not None:
        raise click.UsageError("give --episodes or --steps, not both", click.get_current_context())
    check_targets({"--csv": csv, "--curve": curve}, as_json)
    from rl_tui.runs.changes import ALGORITHM, TAKE, name_and_value

    changed = {name_and_value(entry.change)[0] for entry in changes}
    if runs is not None and TAKE in changed:
        raise click.UsageError(
            "take=ACTION works for a single run only: leave out --runs",
            click.get_current_context(),
        )
    if changes and agent is not None:
        raise click.UsageError(
            "give --change or --agent, not both: to change your agent, edit its code",
            click.get_current_context(),
        )
    from rl_tui.common.files import file_or_stream
    from rl_tui.runs.library import episodes_of, recipe_named
    from rl_tui.runs.training.seeded_runs import Goal

    recipe = recipe_named(scenario, overrides, seed)
    goal = Goal(steps=steps) if steps is not None else Goal(episodes=episodes or episodes_of(recipe.scenario))
    if agent is not None:
        _train_agent(agent, recipe, overrides, goal, runs, csv, curve, as_json)
        return
    if not changed & {ALGORITHM, "policy"}:
        warn_of_no_effect(recipe, overrides)  # a later algorithm may use what the first one ignores
    _warn_beyond_budget(recipe, goal)
    with nullcontext() if curve is None else file_or_stream(curve) as points:
        if runs is None:
            run, figures = _train_once(recipe, goal, csv, points, changes)
        else:
            figures = _train_many(recipe, runs, goal, csv, points, changes)
    if as_json:
        print_json(figures)
    else:
        from rl_tui.commands.reports.training import one_run, several_runs

        report = one_run(run, figures) if runs is None else several_runs(recipe, figures)
        click.echo(report, err=is_stdout(csv) or is_stdout(curve))
    finish_compiling()


def _train_agent(
    name: AgentName,
    recipe: Recipe,
    given: dict[str, object],
    goal: Goal,
    runs: int | None,
    csv: CsvTarget,
    curve: CsvTarget,
    as_json: bool,
) -> None:
    from rl_tui.commands.line.screen import refuse_where_served
    from rl_tui.commands.reports.training import agent_run, several_runs, update_in_words
    from rl_tui.common.files import file_or_stream
    from rl_tui.programs.grading.agent_training import (
        AgentRuns,
        place_of_agent,
        train_agent,
        train_agent_often,
    )
    from rl_tui.runs.training.episode_rows import EpisodeRows, csv_file, write_curve

    refuse_where_served()
    warn_of_agent(given)
    seeded, title = AgentRuns(name, place_of_agent(name), recipe, given), recipe.scenario.title
    with nullcontext() if curve is None else file_or_stream(curve) as points, progress(name.path.name) as bar:
        if runs is None:
            with nullcontext() if csv is None else csv_file(csv) as stream:
                rows = None if stream is None else EpisodeRows(stream, 1)
                run, figures, mean = train_agent(seeded, goal, rows, bar)
        else:
            figures = train_agent_often(seeded, runs, goal, csv, bar)
            mean = figures["curve"]
        if points is not None:
            write_curve(points, mean)
    for note in [] if runs is not None else run.log.notes:
        complain(note)
    if as_json:
        print_json(figures)
        return
    report = (
        several_runs(recipe, figures)
        if runs is not None
        else agent_run(run.world, run.mdp, title, figures, update_in_words(run.verdict))
    )
    click.echo(report, err=is_stdout(csv) or is_stdout(curve))


def _warn_beyond_budget(recipe: Recipe, goal: Goal) -> None:
    from rl_tui.worlds.sections.bandit_section import BanditSection

    section = recipe.scenario.section
    pulls = goal.episodes if goal.steps is None else goal.steps
    if isinstance(section, BanditSection) and pulls is not None and pulls > section.budget:
        pulls_in_budget = counted(section.budget, "pull")
        click.echo(f"the budget of this bandit is {pulls_in_budget}; on screen the run ends there", err=True)


def _train_once(
    recipe: Recipe,
    goal: Goal,
    csv: CsvTarget,
    points: TextIO | None,
    changes: tuple[JournalEntry, ...],
) -> tuple[Run, dict[str, Any]]:
    from rl_tui.runs.changes import as_json, journal_of, written_change
    from rl_tui.runs.figures import training_figures
    from rl_tui.runs.recipe import begin
    from rl_tui.runs.run import Run, each_of
    from rl_tui.runs.training.episode_rows import EpisodeRows, csv_file, write_curve
    from rl_tui.runs.training.seeded_runs import RunCurve, curve_of_run, train

    beginning = begin(recipe)
    names = beginning.world.space.action_names
    journal = journal_of(changes, names)
    with (
        progress(recipe.scenario.id) as on_progress,
        nullcontext() if csv is None else csv_file(csv) as stream,
    ):
        rows = None if stream is None else EpisodeRows(stream, 1)
        curve = None if points is None or goal.episodes is None else RunCurve(goal.episodes)
        run = Run(recipe, beginning, evaluate=False, on_episodes=each_of(rows, curve))
        seconds = train(run, goal, with_compiling(on_progress), journal)
        if points is not None:
            write_curve(points, curve_of_run(run, curve, with_compiling(on_progress)))
    for left_out in journal[len(run.journal) :]:
        change = written_change(left_out, names)
        click.echo(f"--change {change} has no effect: the run ends after {run.step:,} steps", err=True)
    figures = training_figures(run, seconds)
    if changes:
        figures["journal"] = as_json(run.journal, names)
    return run, figures


def _train_many(
    recipe: Recipe,
    runs: int,
    goal: Goal,
    csv: CsvTarget,
    points: TextIO | None,
    changes: tuple[JournalEntry, ...],
) -> dict[str, Any]:
    from rl_tui.runs.changes import as_json, journal_of
    from rl_tui.runs.training.episode_rows import write_curve
    from rl_tui.runs.training.many_runs import many_runs

    journal = journal_of(changes, ())
    with progress(f"{recipe.scenario.id}, {counted(runs, 'run')}") as on_progress:
        document = many_runs(
            recipe,
            runs,
            goal,
            csv,
            on_progress,
            on_compiling=lambda: on_progress.say("compiling"),
            journal=journal,
        )
    if changes:
        document["journal"] = as_json(journal, ())
    if points is not None:
        write_curve(points, document["curve"])
    return document
