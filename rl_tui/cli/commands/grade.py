"""``rl-tui grade``: what submissions learn under many seeds, held against the optimum."""

from __future__ import annotations

import sys

import click

from rl_tui.cli.options.numbers import Real, Whole
from rl_tui.cli.options.run import allow_module_option, json_option, seed_option
from rl_tui.cli.output import complain, print_json
from rl_tui.cli.program import FAILED
from rl_tui.cli.progress import progress

MOST: int = 10**15
MOST_SEEDS: int = 10_000
WARNING = (
    "This is no sandbox: a submission can read, write and send what you can. Grade only what you would run "
    "yourself, or grade where there is nothing to lose."
)


@click.command("grade")
@click.argument("target", metavar="FILE.py[:NAME]|FOLDER")
@click.option("--scenario", metavar="ID|FILE.toml", required=True, help="the world to learn in")
@click.option("--seeds", type=Whole(1, MOST_SEEDS), default=20, show_default=True, help="how many seeds")
@click.option(
    "--episodes",
    type=Whole(1, MOST),
    help="how many episodes an agent learns for  [default: the scenario's]; a script decides itself",
)
@click.option(
    "--threshold",
    type=Real(high=1.0),
    default=0.95,
    show_default=True,
    help="the mean share of the best return that passes",
)
@click.option("--seconds", type=Whole(1, MOST), default=60, show_default=True, help="time limit of a seed")
@click.option(
    "--memory", type=Whole(256, MOST), default=2048, show_default=True, help="MB that a seed may have"
)
@seed_option
@allow_module_option
@json_option
def command(
    target: str,
    scenario: str,
    seeds: int,
    episodes: int | None,
    threshold: float,
    seconds: int,
    memory: int,
    seed: int,
    as_json: bool,
) -> None:
    """Grade an agent or a script, or every one in a folder.

    What counts is the exact return of the greedy policy of its table, ties shared evenly. Its share of the
    best is 1 - (best - return) / stake: 1 for the best policy, and the same less for each point of return
    that is lost. The stake is what an episode of the best policy earns and pays, added up without signs. So
    where there are only rewards, the share is return / best.

    A submission has passed where the mean share over the seeds is the threshold or more, and no seed failed.
    The exit status is 0 if all have passed, else 1.
    """
    from rl_tui.cli.screen import refuse_where_served

    refuse_where_served()
    complain(WARNING)
    from rl_tui.cli.reports.grading import grades, result_line
    from rl_tui.lab.grading.grade import GradedSubmission, Grading, GradingLimits, grade_report
    from rl_tui.lab.grading.submissions import submissions_in
    from rl_tui.lab.run.library import episodes_of, recipe_named

    recipe, found = recipe_named(scenario, {}, seed), submissions_in(target)
    if found.left_out:
        complain(f"left out: {', '.join(found.left_out)}")
    limits = GradingLimits(float(seconds), memory * 2**20)
    grading = Grading(recipe, seeds, episodes or episodes_of(recipe.scenario), threshold, limits)
    share_of_optimal = grading.yardstick.share(grading.yardstick.of_optimal)
    if share_of_optimal is not None and share_of_optimal < threshold:
        complain(
            f"the optimal policy for γ = {recipe.hyperparameters.gamma:g} has itself only "
            f"{share_of_optimal:.4f} of the best return in {recipe.scenario.id}: a --threshold above that is "
            "too much to ask"
        )
    with progress(f"{target} in {recipe.scenario.id}") as bar:

        def on_graded(each: GradedSubmission) -> None:
            if sys.stderr.isatty():
                bar.say(result_line(each))
            elif len(found.submissions) > 1:
                complain(result_line(each))
            finished.append(each)

        finished: list[GradedSubmission] = []
        try:
            graded = grading.grade(found.submissions, bar, on_graded)
        except KeyboardInterrupt:
            complain(f"interrupted: {len(finished):,} of {len(found.submissions):,} submissions were graded")
            if finished:
                complain(grades(grading, finished))
            raise
    if as_json:
        print_json(grade_report(grading, graded))
    else:
        click.echo(grades(grading, graded))
    if not all(each.passed for each in graded):
        click.get_current_context().exit(FAILED)
