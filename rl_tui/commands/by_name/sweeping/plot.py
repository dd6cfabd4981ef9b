"""``rl-tui plot``: pictures of result files."""

from __future__ import annotations

from pathlib import Path

import click

from rl_tui.commands.options.run import FILE, out_option


@click.command("plot")
@click.argument("results", metavar="RESULTS...", nargs=-1, required=True, type=FILE)
@out_option
@click.option("--measure", metavar="NAME", help="metric to draw, by its name in the results")
@click.option("--x", metavar="NAME", help="setting on the horizontal axis, for a sweep")
@click.option("--y", metavar="NAME", help="setting on the vertical axis of a settings map")
def command(
    results: tuple[str, ...], out: Path | None, measure: str | None, x: str | None, y: str | None
) -> None:
    """Draw results as a picture.

    RESULTS is the JSON of train --runs or of sweep, the store of a sweep, or the CSV of train --curve. Curves
    have a band: the 95 % interval of the mean. Several files of curves share one chart. A sweep over one
    number becomes a chart, with a line for each value of the other settings. A sweep over two numbers becomes
    a settings map. Without --out the picture appears in the terminal. An example:

    rl-tui train cliff --runs 50 --json > cliff.json && rl-tui plot cliff.json --out cliff.svg
    """
    from rl_tui.studies.pictures.files import picture_file
    from rl_tui.studies.pictures.reading import read_results
    from rl_tui.studies.pictures.results import picture_of

    tables = [read_results(Path(each), measure) for each in results]
    picture = picture_of(tables, measure, x, y)
    if out is None:
        from rl_tui.commands.reports.picture_text import print_picture

        print_picture(picture)
        return
    with picture_file(out) as write:
        write(picture)
