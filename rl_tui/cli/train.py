"""``rl-tui train``: the same run as on screen, without a screen."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.cli.number import Whole
from rl_tui.cli.output import print_json
from rl_tui.cli.progress import progress
from rl_tui.cli.run_options import json_option, run_options, scenario_argument, seed_option

if TYPE_CHECKING:
    from rl_tui.lab.recipe import Recipe
    from rl_tui.lab.run import Run
    from rl_tui.lab.training import Goal

MOST: Final = 10**15
MOST_RUNS: Final = 100_000


@click.command("train")
@scenario_argument
@click.option("--episodes", type=Whole(1, MOST), help="train so many episodes  [default: the scenario's]")
@click.option("--steps", type=Whole(1, MOST), help="train so many steps instead")
@click.option(
    "--runs", type=Whole(1, MOST_RUNS), help="train so often, with the seed and those that follow it"
)
@click.option(
    "--csv",
    type=click.Path(path_type=Path, dir_okay=False),
    help="write a row an episode: run, episode, return, length",
)
@run_options
@seed_option
@json_option
def command(
    scenario: str,
    episodes: int | None,
    steps: int | None,
    runs: int | None,
    csv: Path | None,
    overrides: dict[str, object],
    seed: int,
    as_json: bool,
) -> None:
    """Train an agent, and print what it has learned.

    It is the same run as on screen, held against the exact answer.
    """
    if episodes is not None and steps is not None:
        raise click.UsageError("--episodes and --steps exclude each other", click.get_current_context())
    from rl_tui.lab.library import episodes_of, find, recipe_for
    from rl_tui.lab.training import Goal

    chosen = find(scenario)
    recipe = recipe_for(chosen, overrides, seed)
    goal = Goal(steps=steps) if steps is not None else Goal(episodes=episodes or episodes_of(chosen))
    if runs is not None:
        _train_many(recipe, runs, goal, csv, as_json)
    else:
        _train_once(recipe, goal, csv, as_json)


def _train_once(recipe: Recipe, goal: Goal, csv: Path | None, as_json: bool) -> None:
    from rl_tui.lab.figures import training_figures

    run, seconds = _trained(recipe, goal, csv)
    figures = training_figures(run, seconds)
    if as_json:
        print_json(figures)
    else:
        from rl_tui.cli.train_report import one_run

        click.echo(one_run(run, figures))


def _trained(recipe: Recipe, goal: Goal, csv: Path | None) -> tuple[Run, float]:
    from rl_tui.lab.episode_rows import EpisodeRows, csv_file
    from rl_tui.lab.run import Run
    from rl_tui.lab.training import train

    with progress(recipe.scenario.id) as on_progress:
        if csv is None:
            run = Run(recipe, evaluate=False)
            return run, train(run, goal, on_progress)
        with csv_file(csv) as stream:
            run = Run(recipe, evaluate=False, on_episodes=EpisodeRows(stream, 1))
            return run, train(run, goal, on_progress)


def _train_many(recipe: Recipe, runs: int, goal: Goal, csv: Path | None, as_json: bool) -> None:
    from rl_tui.lab.many_runs import many_runs

    with progress(f"{recipe.scenario.id}, {runs:,} runs") as on_progress:
        figures: dict[str, Any] = many_runs(recipe, runs, goal, csv, on_progress)
    if as_json:
        print_json(figures)
    else:
        from rl_tui.cli.train_report import several_runs

        click.echo(several_runs(recipe, figures))
