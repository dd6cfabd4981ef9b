"""The report of a recomputed figure, for people: a table, and the curves where no file takes them."""

from __future__ import annotations

from collections.abc import Iterator

import click

from rl_tui.cli.output import alike, columns, number
from rl_tui.cli.reports.picture_text import print_picture
from rl_tui.common.words import counted
from rl_tui.lab.book_figures.catalogue import BOOK, BookFigure
from rl_tui.lab.book_figures.figure import BookComparison, MeasuredFigure


def print_figure(
    figure: BookFigure, measured: MeasuredFigure, runs: int, *, with_picture: bool, err: bool
) -> None:
    """Print what came of ``figure`` over so many ``runs``, on stderr if ``err``."""
    click.echo(f"{figure.title}\n{BOOK}, {figure.source}\n{_runs(figure, runs)}\n", err=err)
    click.echo(columns([("", "book", "where", "ours", "agrees"), *_rows(measured)]), err=err)
    for note in measured.notes:
        click.echo(f"\n{note}", err=err)
    if with_picture:
        click.echo(err=err)
        print_picture(measured.picture, err=err)


def _runs(figure: BookFigure, runs: int) -> str:
    if figure.book_runs is None:
        return f"means of {counted(runs, 'run')}; the book does not say of how many its are"
    book = "as in the book" if runs == figure.book_runs else f"the book's are of {figure.book_runs:,}"
    return f"means of {counted(runs, 'run')}, {book}"


def _rows(measured: MeasuredFigure) -> Iterator[tuple[str, ...]]:
    for each in measured.table:
        yield each.what, each.book, each.place, _ours(each), "yes" if each.agrees else "no"


def _ours(each: BookComparison) -> str:
    if each.ours is None or each.stderr is None:
        return number(each.ours, ".4g")
    mean, error = alike([each.ours, each.stderr])
    return f"{mean} ± {error}"
