"""How often a comparison calls a tied cell worse."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import numpy.typing as npt
from interval_coverage import RESULTS

from rl_tui.studies.statistics.comparison import not_different

Cells = tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]
"""Results, cells × seeds, and which cells are truly the best."""


def equal_cells(kind: str, cells: int = 20) -> Callable[[np.random.Generator, int], Cells]:
    return lambda random, runs: (RESULTS[kind].draw(random, (cells, runs)), np.ones(cells, np.bool_))


def _alike_by_seed(random: np.random.Generator, runs: int) -> Cells:
    """Three in five runs of a seed have equal results in all cells."""
    draw = RESULTS["mostly learned"].draw
    own, common = draw(random, (20, runs)), draw(random, (1, runs))
    return np.where(random.random((20, runs)) < 0.6, common, own), np.ones(20, np.bool_)


def _noisy_and_worse(random: np.random.Generator, runs: int) -> Cells:
    noisy, steady = random.normal(-0.1, 1.0, (10, runs)), random.normal(0.0, 0.05, (10, runs))
    return np.vstack([noisy, steady]), np.arange(20) >= 10


def _five_best(random: np.random.Generator, runs: int) -> Cells:
    """Five equal ones and fifteen that get worse by a quarter of the spread each."""
    means = -0.25 * np.maximum(0, np.arange(20) - 4)
    return means[:, np.newaxis] + random.normal(0.0, 1.0, (20, runs)), means == 0


def _unlike_shapes(random: np.random.Generator, runs: int) -> Cells:
    failing, steady = RESULTS["two clusters"].draw(random, (10, runs)), random.normal(0.8, 0.1, (10, runs))
    return np.vstack([failing, steady]), np.ones(20, np.bool_)


SWEEPS: Final = {
    "20 normal": equal_cells("normal"),
    "20 mostly learned": equal_cells("mostly learned"),
    "20 of 0 or 1, evenly": equal_cells("0 or 1, evenly"),
    "220 normal": equal_cells("normal", 220),
    "20 alike by seed": _alike_by_seed,
    "10 of 20 best, others noisy": _noisy_and_worse,
    "5 of 20 best": _five_best,
    "20 of unlike shapes": _unlike_shapes,
}
"""The last sweep violates the assumption of a t-test: few runs may miss a rare failure."""


def errors(sweep: str, runs: int, trials: int, seed: int = 1) -> float:
    random = np.random.Generator(np.random.PCG64([seed, runs]))
    wrong = 0
    for _ in range(trials):
        values, is_best = SWEEPS[sweep](random, runs)
        wrong += bool(np.any(is_best & ~not_different(values).alike))
    return wrong / trials
