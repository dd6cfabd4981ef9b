"""``rl-tui replay``: run a saved session again, without a screen."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rl_tui.commands.line.output import print_json, progress, write_text
from rl_tui.commands.options.display import display_of, display_options
from rl_tui.commands.options.picture import size_option
from rl_tui.commands.options.run import (
    CsvTarget,
    Whole,
    allow_module_option,
    check_targets,
    csv_option,
    is_stdout,
    json_option,
    target_option,
)

if TYPE_CHECKING:
    from rl_tui.live.sessions.replay import ReplayTarget
    from rl_tui.live.sessions.session import StoredSession
    from rl_tui.runs.run import Run


@click.command("replay")
@click.argument("session", metavar="SESSION.json", type=click.Path(path_type=Path))
@click.option(
    "--lane", type=Whole(1), help="number of the run, if there are several  [default: the run shown last]"
)
@click.option(
    "--branch", metavar="NAME", help="name of the branch, if there are several  [default: the current branch]"
)
@csv_option
@target_option("--out", "a recording of the screen from step 0 on, as .cast for asciinema")
@size_option
@display_options
@allow_module_option
@json_option
def command(
    session: Path,
    lane: int | None,
    branch: str | None,
    csv: CsvTarget,
    out: CsvTarget,
    size: tuple[int, int],
    as_json: bool,
    **display: Any,
) -> None:
    """Run a session again, to its last step.

    A session is a file that you saved (m s on screen), or that was saved automatically. The result equals the
    first one, to the last bit. --out also records the screen.
    """
    check_targets({"--csv": csv, "--out": out}, as_json)
    from rl_tui.live.sessions.replay import comes_out_otherwise, replay_figures, replay_target
    from rl_tui.live.sessions.session import OTHER_BITS, SessionError, read_session

    stored = read_session(session)
    for option, written in (("--csv", csv), ("--out", out)):
        if isinstance(written, Path) and written.exists() and session.samefile(written):
            raise click.UsageError(
                f"{option} names the session file: choose another file", click.get_current_context()
            )
    target = replay_target(stored.record(), lane, branch)
    run, seconds = _replayed(stored, target, csv)
    if comes_out_otherwise(stored, target, run):
        click.echo(str(SessionError(session, OTHER_BITS)), err=True)
    if out is not None:
        import asyncio

        from rl_tui.screen.app.screenshot import record, script_of_replay

        cast = record(stored, size, script_of_replay(target), display_of(display))
        write_text(asyncio.run(cast), str(out) if isinstance(out, Path) else "-")
    figures = replay_figures(stored, target, run, seconds)
    if as_json:
        print_json(figures)
    else:
        click.echo(_report(stored, target, run, figures), err=is_stdout(csv) or is_stdout(out))


def _replayed(stored: StoredSession, target: ReplayTarget, csv: CsvTarget) -> tuple[Run, float]:
    from rl_tui.common.errors import UserError
    from rl_tui.live.sessions.replay import replayed
    from rl_tui.live.sessions.session import SessionError
    from rl_tui.runs.training.episode_rows import EpisodeRows, csv_file

    with (
        progress(stored.title) as on_progress,
        nullcontext() if csv is None else csv_file(csv) as stream,
    ):
        rows = None if stream is None else EpisodeRows(stream, 1)
        try:
            return replayed(target, on_progress, rows)
        except UserError as fault:
            raise SessionError(stored.path, str(fault)) from fault


def _report(stored: StoredSession, target: ReplayTarget, run: Run, figures: dict[str, Any]) -> str:
    from rl_tui.commands.reports.training import one_run

    lanes = len(stored.document.lanes)
    parts = [stored.title]
    if lanes > 1:
        parts.append(f"run {target.number + 1} of {lanes}")
    if len(target.lane.branches) > 1:
        parts.append(f"{target.branch.name} of {len(target.lane.branches)}")
    parts.append(f"at step {run.step:,}")
    return "\n".join([", ".join(parts), "", one_run(run, figures)])
