"""Accuracy and time of the statistics of many runs, for ``measure.py``."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np
from comparison_errors import SWEEPS, errors
from interval_coverage import HELD, RESULTS, coverage_of_difference, coverage_of_mean

from rl_tui.studies.statistics.comparison import not_different
from rl_tui.studies.statistics.intervals import summary_of

Rows = Iterator[tuple[str, str, str]]


def coverage(trials: int) -> Rows:
    for kind in RESULTS:
        for runs in (10, 20, 30, 50, 100):
            of_mean = coverage_of_mean(kind, runs, trials)
            beside = f"{of_mean.covered:.2%}: {of_mean.below:.2%} below, {of_mean.above:.2%} above"
            yield f"{kind}, {runs} runs", beside, "93 to 97 %" if kind in HELD and runs >= 30 else ""
        of_difference = coverage_of_difference(kind, 30, trials)
        yield f"{kind}, two cells of 30 runs", f"{of_difference.covered:.2%}", ""
    values = RESULTS["mostly learned"].draw(np.random.default_rng(1), (500, 30))
    start = time.perf_counter()
    for each in values:
        summary_of(each)
    taken = (time.perf_counter() - start) / len(values)
    yield "summary of a cell of 30 runs", f"{taken * 1e3:.2f} ms", "at most 1 ms"


def comparison(trials: int) -> Rows:
    for sweep in SWEEPS:
        for runs in (10, 30, 100):
            yield f"{sweep}, {runs} runs", f"{errors(sweep, runs, trials):.2%}", "at most 5 %"
    values = RESULTS["normal"].draw(np.random.default_rng(1), (10_000, 30))
    not_different(values[:2])  # imports what it needs
    start = time.perf_counter()
    not_different(values)
    yield "comparison of 10,000 cells", f"{(time.perf_counter() - start) * 1e3:.0f} ms", ""
