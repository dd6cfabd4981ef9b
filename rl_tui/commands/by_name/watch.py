"""``rl-tui watch``: watch a user's training script, or report on it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.commands.line.output import complain, print_json, progress
from rl_tui.commands.line.program import FAILED
from rl_tui.commands.options.display import big_option, display_of, display_options
from rl_tui.commands.options.run import FILE, Whole, json_option, seed_option
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted

if TYPE_CHECKING:
    from rl_tui.programs.watched.program_log import ProgramError, ProgramLog
    from rl_tui.programs.watched.program_process import ProgramRequest

MOST: Final = 10**15
WORTH_TELLING: Final = 5.0  # seconds without a step
_LONGEST_ERROR: Final = 500
_WATCHED: Final = (
    "rl-tui watches environments of Gymnasium, classes with reset() and step(action), and functions "
    "step(state, action)"
)


@click.command("watch", context_settings={"ignore_unknown_options": True})
@click.argument("script", metavar="[SCRIPT.py]", required=False, type=FILE)
@click.argument("arguments", metavar="[ARGS]...", nargs=-1, type=click.UNPROCESSED)
@click.option("--example", is_flag=True, help="watch the example script, which has a bug")
@click.option("--table", metavar="NAME", help="variable that holds the table  [default: found automatically]")
@seed_option
@click.option("--steps", type=Whole(1, MOST), help="stop the script after this number of steps")
@json_option
@big_option
@display_options
def command(
    script: str | None,
    arguments: tuple[str, ...],
    example: bool,
    table: str | None,
    seed: int,
    steps: int | None,
    as_json: bool,
    **display: Any,
) -> None:
    """Watch your own script or notebook while it learns.

    The script runs in its own process, and the keys of the screen pause and continue it. Unknown arguments,
    and all arguments after --, go to the script. With --json there is no screen: you get a report on the
    script's table and its bugs.

    This is not a sandbox: the script runs with all your rights.
    """
    from rl_tui.commands.line.screen import require_terminal
    from rl_tui.programs.watched.child.script import check_script
    from rl_tui.programs.watched.program_process import ProgramRequest, refuse_without_posix
    from rl_tui.screen.terminal.driver_choice import in_browser

    if in_browser():
        raise UserError("watch runs your own code: rl-tui serve does not allow this")
    refuse_without_posix()
    path = _path_of(script, example)
    check_script(path)
    if not as_json:
        require_terminal("--json works without one")
    request = ProgramRequest(path, arguments, seed=seed, steps=steps, table=table)
    if not as_json:
        from rl_tui.commands.line.screen import run_app

        run_app(display_of(display), request)
        return
    error = _print_report(request)
    if error is not None:
        complain(f"rl-tui: {_in_a_line(str(path), error)}")
        click.get_current_context().exit(FAILED)


def _path_of(script: str | None, example: bool) -> Path:
    from rl_tui.worlds.files.shipped import shipped_folder

    context = click.get_current_context()
    if script is not None and example:
        raise click.UsageError(f"--example has its own script: leave out {script}", context)
    if example:
        return shipped_folder().parent / "docs" / "lake.py"
    if script is None:
        raise click.UsageError("name a script, or watch the example: --example", context)
    return Path(script)


def _print_report(request: ProgramRequest) -> ProgramError | None:
    from rl_tui.programs.diagnosis.diagnosis import verdict_of
    from rl_tui.programs.grading.watch_report import error_of, watch_report
    from rl_tui.programs.watched.program_process import watched_to_the_end

    name = request.path.name
    with progress(name, has_end=request.steps is not None) as bar:
        say_what_is_missing = step_missed(name)

        def show(log: ProgramLog) -> None:
            say_what_is_missing(log)
            if request.steps is None:
                bar.say(f"{counted(log.recording.count, 'step')}, {counted(log.episodes, 'episode')}")
            else:
                bar(log.recording.count, request.steps)

        log = watched_to_the_end(request, show)
    print_json(watch_report(str(request.path), log, verdict_of(log)))
    return error_of(log)


def step_missed(name: str) -> Callable[[ProgramLog], None]:
    """Return a callback that warns once if script `name` takes no step for five seconds."""
    due, is_said = time.monotonic() + WORTH_TELLING, False

    def say(log: ProgramLog) -> None:
        nonlocal is_said
        if is_said or log.recording.count or log.ended or time.monotonic() < due:
            return
        is_said = True
        why = "; ".join(log.notes) or _WATCHED
        text = one_line(f"{name} has not taken a step yet: {why}", _LONGEST_ERROR)
        if sys.stderr.isatty():
            click.echo(err=True)  # ends the line of the progress bar
        complain(f"rl-tui: {text}")

    return say


def _in_a_line(script: str, error: ProgramError) -> str:
    from rl_tui.programs.watched.notebook import place_in_words

    place = error.file or script
    place = script if error.line is None else f"{place}, {place_in_words(place, error.line)}"
    return one_line(f"{place}: {error.type}: {error.text}", _LONGEST_ERROR)
