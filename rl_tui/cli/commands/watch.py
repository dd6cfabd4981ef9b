"""``rl-tui watch``: somebody's own training script, on the screen of the playground or as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.cli.options.display import display_of, display_options
from rl_tui.cli.options.numbers import Whole
from rl_tui.cli.options.run import json_option, seed_option
from rl_tui.cli.output import complain, print_json
from rl_tui.cli.program import FAILED
from rl_tui.cli.progress import progress
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted

if TYPE_CHECKING:
    from rl_tui.lab.programs.program_log import ProgramError, ProgramLog
    from rl_tui.lab.programs.program_process import ProgramRequest

MOST: Final = 10**15
_LONGEST_ERROR: Final = 500


@click.command("watch", context_settings={"ignore_unknown_options": True})
@click.argument("script", metavar="SCRIPT.py")
@click.argument("arguments", metavar="[ARGS]...", nargs=-1, type=click.UNPROCESSED)
@click.option("--table", metavar="NAME", help="which variable is the table  [default: it is looked for]")
@seed_option
@click.option("--steps", type=Whole(1, MOST), help="end the script after so many steps")
@json_option
@display_options
def command(
    script: str,
    arguments: tuple[str, ...],
    table: str | None,
    seed: int,
    steps: int | None,
    as_json: bool,
    **display: Any,
) -> None:
    """Watch your own Gymnasium script learn, unchanged.

    It runs in a process of its own, and stops and goes on with the screen. Arguments that are none of these
    options go to the script, and so does all that follows --. With --json there is no screen: it prints what
    the script does to its table, and what is wrong with it.

    It is not a sandbox: the script can do all that you can.
    """
    from rl_tui.cli.screen import require_terminal
    from rl_tui.lab.programs.child.source import check_script
    from rl_tui.lab.programs.program_process import ProgramRequest
    from rl_tui.terminal.driver_choice import in_browser

    if in_browser():
        raise UserError("watch runs what stands in a file, and so does nothing where the program is served")
    if not as_json:
        require_terminal("--json does without")
    check_script(Path(script))
    request = ProgramRequest(Path(script), arguments, seed=seed, steps=steps, table=table)
    if not as_json:
        from rl_tui.cli.screen import run_app

        run_app(display_of(display), request)
        return
    error = _print_report(request)
    if error is not None:
        complain(f"rl-tui: {_in_a_line(script, error)}")
        click.get_current_context().exit(FAILED)


def _print_report(request: ProgramRequest) -> ProgramError | None:
    """Watch the script to its end, print the document, and return what was raised."""
    from rl_tui.lab.detective.detective import verdict_of
    from rl_tui.lab.grading.watch_report import error_of, watch_report
    from rl_tui.lab.programs.to_the_end import watched_to_the_end

    with progress(request.path.name, has_end=request.steps is not None) as bar:

        def show(log: ProgramLog) -> None:
            if request.steps is None:
                bar.say(f"{counted(log.recording.count, 'step')}, {counted(log.episodes, 'episode')}")
            else:
                bar(log.recording.count, request.steps)

        log = watched_to_the_end(request, show)
    print_json(watch_report(str(request.path), log, verdict_of(log)))
    return error_of(log)


def _in_a_line(script: str, error: ProgramError) -> str:
    place = script if error.line is None else f"{error.file or script}, line {error.line}"
    return one_line(f"{place}: {error.type}: {error.text}", _LONGEST_ERROR)
