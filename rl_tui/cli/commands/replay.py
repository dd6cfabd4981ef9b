"""``rl-tui replay``: a session without a screen."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.cli.options.numbers import Whole
from rl_tui.cli.options.run import allow_module_option, json_option
from rl_tui.cli.output import print_json
from rl_tui.cli.progress import progress

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run
    from rl_tui.lab.sessions.replay import ReplayTarget
    from rl_tui.lab.sessions.session import StoredSession

STDOUT: Final = "-"


@click.command("replay")
@click.argument("session", metavar="SESSION.json", type=click.Path(path_type=Path))
@click.option("--lane", type=Whole(1), help="of several runs side by side  [default: the one shown last]")
@click.option("--branch", metavar="NAME", help="of several branches  [default: the one it stands on]")
@click.option(
    "--csv",
    type=click.Path(dir_okay=False, allow_dash=True),
    help="write a row an episode: run, episode, return, length; - is stdout, the report then goes to stderr",
)
@allow_module_option
@json_option
def command(session: Path, lane: int | None, branch: str | None, csv: str | None, as_json: bool) -> None:
    """Run a session again, to where it was left.

    Sessions are the files that w saves on screen, and that are kept by themselves. Prints what was learned
    by then, the same to the last bit.
    """
    if csv == STDOUT and as_json:
        raise click.UsageError("--csv - and --json both want stdout", click.get_current_context())
    from rl_tui.lab.sessions.replay import comes_out_otherwise, replay_figures, replay_target
    from rl_tui.lab.sessions.session import OTHER_BITS, SessionError, read_session

    stored = read_session(session)
    if csv is not None and csv != STDOUT and Path(csv).exists() and session.samefile(csv):
        raise click.UsageError("--csv would write over the session", click.get_current_context())
    target = replay_target(stored.record(), lane, branch)
    run, seconds = _replayed(stored, target, csv)
    if comes_out_otherwise(stored, target, run):
        click.echo(str(SessionError(session, OTHER_BITS)), err=True)
    figures = replay_figures(stored, target, run, seconds)
    if as_json:
        print_json(figures)
    else:
        click.echo(_report(stored, target, run, figures), err=csv == STDOUT)


def _replayed(stored: StoredSession, target: ReplayTarget, csv: str | None) -> tuple[Run, float]:
    from rl_tui.common.errors import UserError
    from rl_tui.lab.experiments.episode_rows import EpisodeRows, csv_file
    from rl_tui.lab.sessions.replay import replayed
    from rl_tui.lab.sessions.session import SessionError

    file = sys.stdout if csv == STDOUT else Path(csv) if csv else None
    with (
        progress(stored.title) as on_progress,
        nullcontext() if file is None else csv_file(file) as stream,
    ):
        rows = None if stream is None else EpisodeRows(stream, 1)
        try:
            return replayed(target, on_progress, rows)
        except UserError as fault:
            raise SessionError(stored.path, str(fault)) from fault


def _report(stored: StoredSession, target: ReplayTarget, run: Run, figures: dict[str, Any]) -> str:
    from rl_tui.cli.commands.train_report import one_run

    lanes = len(stored.document.lanes)
    parts = [stored.title]
    if lanes > 1:
        parts.append(f"lane {target.number + 1} of {lanes}")
    if len(target.lane.branches) > 1:
        parts.append(f"{target.branch.name} of {len(target.lane.branches)}")
    parts.append(f"at step {run.step:,}")
    return "\n".join([", ".join(parts), "", one_run(run, figures)])
