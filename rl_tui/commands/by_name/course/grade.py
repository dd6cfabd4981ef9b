"""``rl-tui grade``: grade submissions, or sessions of a lesson."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from click.core import ParameterSource

from rl_tui.commands.line.output import complain, print_json, progress
from rl_tui.commands.line.program import FAILED
from rl_tui.commands.options.run import (
    FILE,
    LESSON,
    Real,
    Whole,
    allow_module_option,
    json_option,
    seed_option,
)

MOST: int = 10**15
MOST_SEEDS: int = 10_000
WARNING = (
    "Not a sandbox: {what} can read, write and send anything you can. Grade only what you would run "
    "yourself, or grade where there is nothing to lose."
)


@click.command("grade")
@click.argument("target", metavar="FILE.py[:NAME]|SESSION.json|FOLDER", type=FILE)
@click.argument("lesson", metavar="[LESSON]", required=False, type=LESSON)
@click.option("--scenario", metavar="ID|FILE.toml", help="the world in which submissions learn")
@click.option("--seeds", type=Whole(1, MOST_SEEDS), default=20, show_default=True, help="number of seeds")
@click.option(
    "--episodes",
    type=Whole(1, MOST),
    help="number of episodes to train an agent  [default: the scenario's]; a script sets its own",
)
@click.option(
    "--threshold",
    type=Real(high=1.0),
    default=0.95,
    show_default=True,
    help="to pass, the mean share of the best return must be at least this",
)
@click.option("--seconds", type=Whole(1, MOST), default=60, show_default=True, help="time limit of a seed")
@click.option(
    "--memory", type=Whole(256, MOST), default=2048, show_default=True, help="memory limit of a seed in MB"
)
@click.option(
    "--programs", is_flag=True, help="run the programs that the sessions contain, to judge their tasks"
)
@seed_option
@allow_module_option
@json_option
def command(
    target: str,
    lesson: str | None,
    scenario: str | None,
    seeds: int,
    episodes: int | None,
    threshold: float,
    seconds: int,
    memory: int,
    programs: bool,
    seed: int,
    as_json: bool,
) -> None:
    """Grade agents, scripts, or sessions of a lesson.

    A submission is graded by the exact return of its greedy policy, with ties shared evenly. Its share of the
    best is 1 - (best - return) / stake: 1 for the best policy, less for lower returns. The stake is the sum
    of the absolute rewards in an episode of the best policy. If all rewards are positive, the share is return
    / best. A submission passes if its mean share over the seeds reaches the threshold and no seed failed.

    With a LESSON (an ID or a FILE.toml), a session of that lesson is graded, or every session in a folder.
    The program repeats all actions from step 0, and judges the tasks by the results. A program in a session
    runs only with --programs. Without this option, the task of the program is not judged. A session proves
    the run, not who made it.

    The exit status is 0 if all have passed, else 1.
    """
    from rl_tui.commands.line.screen import refuse_where_served
    from rl_tui.programs.watched.program_process import refuse_without_posix

    refuse_where_served()
    if lesson is None or programs:
        refuse_without_posix()
    if lesson is not None:
        _check_lesson_usage(target)
        if programs:
            complain(WARNING.format(what="a program in a session"))
        _grade_sessions(Path(target), lesson, runs_programs=programs, as_json=as_json)
        return
    if programs:
        raise click.UsageError("--programs works only with a lesson", click.get_current_context())
    if scenario is None:
        raise click.UsageError(_what_is_missing(target), click.get_current_context())
    complain(WARNING.format(what="a submission"))
    from rl_tui.commands.reports.grading import grades, result_line
    from rl_tui.programs.grading.grade import GradedSubmission, Grading, GradingLimits, grade_report
    from rl_tui.programs.grading.submissions import submissions_in
    from rl_tui.runs.library import episodes_of, recipe_named

    recipe, found = recipe_named(scenario, {}, seed), submissions_in(target)
    if found.left_out:
        complain(f"left out: {', '.join(found.left_out)}")
    limits = GradingLimits(float(seconds), memory * 2**20)
    grading = Grading(recipe, seeds, episodes or episodes_of(recipe.scenario), threshold, limits)
    share_of_optimal = grading.yardstick.share(grading.yardstick.of_optimal)
    if share_of_optimal is not None and share_of_optimal < threshold:
        complain(
            f"the optimal policy for γ = {recipe.hyperparameters.gamma:g} has only "
            f"{share_of_optimal:.4f} of the best return in {recipe.scenario.id}: choose a --threshold "
            "of at most that"
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


def _what_is_missing(target: str) -> str:
    if target.endswith(".json"):
        return (
            f"{target} is a session: name its lesson after the file, such as "
            "rl-tui grade SESSION.json q-by-hand"
        )
    return (
        "To grade an agent, add its world: --scenario NAME. To grade sessions, add their lesson: "
        "rl-tui grade FOLDER LESSON"
    )


def _check_lesson_usage(target: str) -> None:
    context = click.get_current_context()
    given = [
        f"--{name}"
        for name in ("scenario", "seeds", "episodes", "threshold", "seconds", "memory", "seed")
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE
    ]
    if given:
        raise click.UsageError(f"{given[0]} works only for submissions: leave it out with a lesson", context)
    if target.endswith(".py"):
        raise click.UsageError(f"{target} is a submission: give --scenario instead of a lesson", context)


def _grade_sessions(target: Path, name: str, *, runs_programs: bool, as_json: bool) -> None:
    from rl_tui.commands.reports.lesson_grading import session_grade, session_table
    from rl_tui.live.sessions.grade import GradedSession, LessonGrading, grade_report, sessions_to_grade
    from rl_tui.live.sessions.session import SessionError

    grading = LessonGrading(name, runs_programs=runs_programs)
    is_folder, graded = target.is_dir(), list[GradedSession]()
    paths = sessions_to_grade(target)
    with progress(str(target)) as bar:
        for number, path in enumerate(paths):
            bar(number, len(paths))
            try:
                graded.append(grading.grade(path))
            except SessionError as fault:
                if not is_folder:
                    raise
                graded.append(GradedSession(path, fault=fault.fault))
    reports = [grade_report(grading.lesson, each) for each in graded]
    if as_json and is_folder:
        print_json([{"session": str(path), **report} for path, report in zip(paths, reports, strict=True)])
    elif as_json:
        print_json(reports[0])
    elif is_folder:
        click.echo(session_table(grading.lesson, graded))
    else:
        click.echo(session_grade(grading.lesson, graded[0]))
    if not all(each.passed for each in graded):
        click.get_current_context().exit(FAILED)
