"""``rl-tui figure``: recompute a figure of the book."""

from __future__ import annotations

import sys
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Final

import click

from rl_tui.commands.line.output import finish_compiling, print_json, progress
from rl_tui.commands.options.run import (
    CsvTarget,
    Whole,
    check_targets,
    is_stdout,
    json_option,
    out_option,
    seed_option,
    target_option,
)
from rl_tui.studies.book_figures.catalogue import FIGURES

MOST_RUNS: Final = 100_000


@click.command("figure")
@click.argument("number", type=click.Choice(list(FIGURES)), metavar="FIGURE")
@click.option(
    "--runs",
    type=Whole(1, MOST_RUNS),
    help="number of runs in each mean  [default: the book's, if that takes under a minute]",
)
@out_option
@target_option("--csv", "the curves, one row per point: panel, curve, x, mean, standard error")
@seed_option
@json_option
def command(
    number: str, runs: int | None, out: Path | None, csv: CsvTarget, seed: int, as_json: bool
) -> None:
    """Recompute a figure of the book.

    The figures are from Sutton & Barto, 2nd edition. 2.2: the ten-armed testbed. cliff: the rewards of
    example 6.6. 6.3: three methods on the cliff, by step size. 8.2: planning in the Dyna maze. Every number
    is learned here, and compared with the number in the book. An example:

    rl-tui figure 8.2 --out maze.svg
    """
    check_targets({"--csv": csv, "--out": out}, as_json)
    from rl_tui.common.files import file_or_stream
    from rl_tui.studies.book_figures.catalogue import measure
    from rl_tui.studies.book_figures.files import document_of, write_csv
    from rl_tui.studies.book_figures.measuring import Measuring
    from rl_tui.studies.pictures.files import picture_file

    figure = FIGURES[number]
    wanted = runs or figure.runs
    in_file = None if is_stdout(csv) else csv
    with nullcontext() if out is None else picture_file(out) as write_picture:
        with nullcontext() if in_file is None else file_or_stream(in_file) as points:
            start = time.perf_counter()
            with progress(f"figure {number}") as bar:
                measuring = Measuring(seed, bar, on_compiling=lambda: bar.say("compiling"))
                measured = measure(figure, measuring, wanted)
            seconds = time.perf_counter() - start
            if points is not None:
                write_csv(points, measured)
        if write_picture is not None:
            write_picture(measured.picture)
    if is_stdout(csv):
        write_csv(sys.stdout, measured)
    if as_json:
        print_json(document_of(figure, measured, wanted, seed, seconds))
    else:
        from rl_tui.commands.reports.picture_text import print_figure

        print_figure(figure, measured, wanted, with_picture=out is None, err=is_stdout(csv))
    finish_compiling()
