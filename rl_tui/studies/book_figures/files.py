"""A recomputed figure as JSON and CSV."""

from __future__ import annotations

from typing import Any, Final, TextIO

from rl_tui.runs.figures import finite
from rl_tui.studies.book_figures.catalogue import BOOK, BookFigure
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve, MeasuredFigure

HEADER: Final = ("panel", "curve", "x", "mean", "stderr")


def document_of(
    figure: BookFigure, measured: MeasuredFigure, runs: int, seed: int, seconds: float
) -> dict[str, Any]:
    """Return the document of `figure --json`. A missing bound is null."""
    document: dict[str, Any] = finite(
        {
            "figure": figure.id,
            "title": figure.title,
            "source": f"{BOOK}, {figure.source}",
            "runs": runs,
            "book_runs": figure.book_runs,
            "seed": seed,
            "seconds": seconds,
            "table": [_row(each) for each in measured.table],
            "curves": [_curve(each) for each in measured.curves],
            "notes": list(measured.notes),
        }
    )
    return document


def _row(each: BookComparison) -> dict[str, Any]:
    return {
        "what": each.what,
        "book": each.book,
        "where": each.place,
        "low": each.low,
        "high": each.high,
        "ours": each.ours,
        "stderr": each.stderr,
        "agrees": each.agrees,
    }


def _curve(each: MeasuredCurve) -> dict[str, Any]:
    return {
        "panel": each.panel,
        "curve": each.name,
        "x": list(each.x),
        "mean": list(each.mean),
        "stderr": list(each.stderr),
    }


def write_csv(stream: TextIO, measured: MeasuredFigure) -> None:
    """Write one row for each point of each curve."""
    import csv

    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(HEADER)
    for each in measured.curves:
        for x, mean, stderr in zip(each.x, each.mean, each.stderr, strict=True):
            writer.writerow(
                [each.panel, each.name, repr(x), repr(mean), "" if stderr is None else repr(stderr)]
            )
