"""Cells tied with the best."""

from __future__ import annotations

import numpy as np
import pytest
import scipy  # its parts are imported where they are first used
from comparison_errors import SWEEPS, errors
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from interval_coverage import RESULTS

from rl_tui.studies.statistics.comparison import ERROR, METHOD, not_different
from rl_tui.studies.statistics.intervals import FEWEST_RUNS

NOTHING = np.nan
MATRICES = arrays(
    np.float64,
    st.tuples(st.integers(1, 8), st.integers(FEWEST_RUNS, 20)),
    elements=st.integers(-3, 3).map(float),
)


def five_best(seed: int = 1, runs: int = 30) -> np.ndarray:
    return SWEEPS["5 of 20 best"](np.random.Generator(np.random.PCG64(seed)), runs)[0]


def plainly(values: np.ndarray) -> set[int]:
    best = max(range(len(values)), key=lambda cell: np.nanmean(values[cell]))
    tests = []
    for cell in set(range(len(values))) - {best}:
        both = ~np.isnan(values[cell]) & ~np.isnan(values[best])
        test = scipy.stats.ttest_rel(values[best][both], values[cell][both], alternative="greater")
        tests.append((test.pvalue, cell))
    worse: set[int] = set()
    for chance, cell in sorted(tests):
        pairs = (len(values) - len(worse)) * (len(values) - 1)
        if chance > ERROR / pairs:
            break
        worse.add(cell)
    return set(range(len(values))) - worse


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("missing", [0.0, 0.2])
def test_it_is_as_paired_tests_one_after_the_other(seed: int, missing: float) -> None:
    values = five_best(seed, runs=40)
    values[np.random.Generator(np.random.PCG64(seed)).random(values.shape) < missing] = NOTHING
    found = not_different(values)
    assert set(np.flatnonzero(found.alike)) == plainly(values)
    assert 1 < found.alike.sum() < 20
    assert found.compared.all()
    assert found.method == METHOD


@pytest.mark.parametrize("sweep", ["20 normal", "20 mostly learned", "20 of 0 or 1, evenly"])
def test_equal_cells_are_called_different_in_five_percent_at_most(sweep: str) -> None:
    trials = 600
    # If the truth were 5 %, a larger share would occur once in a thousand times. Without the correction for
    # the choice of the best it is a third
    assert errors(sweep, 30, trials) * trials <= scipy.stats.binom.ppf(0.999, trials, ERROR)


@pytest.mark.parametrize("sweep", ["20 alike by seed", "10 of 20 best, others noisy", "5 of 20 best"])
def test_so_are_those_of_the_best_among_worse_ones(sweep: str) -> None:
    trials = 400
    assert errors(sweep, 30, trials) * trials <= scipy.stats.binom.ppf(0.999, trials, ERROR)


def test_what_is_far_worse_is_told_from_the_best_among_ten_thousand() -> None:
    random = np.random.Generator(np.random.PCG64(1))
    values = random.normal(0.0, 1.0, (10_000, 30))
    values[:7] += 4.0
    found = not_different(values)
    assert found.best in range(7)
    assert list(np.flatnonzero(found.alike)) == list(range(7))


def test_seeds_in_common_make_small_differences_plain() -> None:
    random = np.random.Generator(np.random.PCG64(1))
    of_seeds = random.normal(0.0, 10.0, 30)
    values = np.array([of_seeds + shift + random.normal(0.0, 0.1, 30) for shift in (0.0, 0.5)])
    assert list(not_different(values).alike) == [False, True]
    values[0] = random.permutation(values[0])
    assert list(not_different(values).alike) == [True, True]


def test_of_costs_the_smallest_is_the_best() -> None:
    values = five_best()
    up, down = not_different(values), not_different(-values, larger_is_better=False)
    assert up.best == down.best
    assert list(up.alike) == list(down.alike)


def test_cells_without_a_spread_are_alike_only_if_they_are_equal() -> None:
    found = not_different(np.array([[1.0] * 10, [1.0 - 1e-12] * 10, [0.999] * 10, [1.0 - 1e-7] * 10]))
    assert found.best == 0
    assert list(found.alike) == [True, True, False, False]


def test_a_cell_that_ran_away_hides_no_difference_between_others() -> None:
    values = np.array([[1.0] * 10, [0.5] * 10, [-1e12] * 10])
    assert list(not_different(values).alike) == [True, False, False]


def test_cells_with_few_seeds_in_common_are_not_compared() -> None:
    values = np.full((5, 20), NOTHING)
    values[0, :10], values[1, 10:], values[2, 1:11] = 1.0, 0.5, 0.5
    values[3, 0], values[4] = 9.0, np.arange(20) - 50.0  # a single run cannot be a best cell
    found = not_different(values)
    assert found.best == 0
    assert list(found.compared) == [True, False, False, False, True]
    assert list(found.alike) == [True, False, False, False, False]


def test_few_runs_have_a_best_cell_and_no_comparison() -> None:
    values = np.array([[1.0, 2.0], [3.0, NOTHING], [NOTHING, NOTHING]])
    found = not_different(values)
    assert found.best == 0
    assert list(found.alike) == list(found.compared) == [True, False, False]


@pytest.mark.parametrize("shape", [(0, 30), (3, 0), (3, 30)])
def test_without_values_there_is_no_best_cell(shape: tuple[int, int]) -> None:
    found = not_different(np.full(shape, NOTHING))
    assert found.best is None
    assert not found.alike.any()
    assert found.alike.shape == found.compared.shape == shape[:1]


@pytest.mark.parametrize("values", [np.ones(3), np.array([[1.0, np.inf]])])
def test_what_is_no_matrix_of_results_is_refused(values: np.ndarray) -> None:
    with pytest.raises(ValueError, match="matrix of finite numbers"):
        not_different(values)


@given(values=MATRICES, randomly=st.randoms(use_true_random=False))
def test_the_order_of_cells_and_of_seeds_does_not_matter(values: np.ndarray, randomly: object) -> None:
    random = np.random.Generator(np.random.PCG64(randomly.getrandbits(32)))  # type: ignore[attr-defined]
    cells, seeds = random.permutation(len(values)), random.permutation(values.shape[1])
    before, after = not_different(values), not_different(values[cells][:, seeds])
    assert before.best is not None
    assert after.best is not None
    means = values.mean(axis=1)
    assert means[cells[after.best]] == pytest.approx(means[before.best])
    if np.sum(np.isclose(means, means.max())) == 1:  # of equal ones the first counts as the best
        assert list(after.alike) == list(before.alike[cells])


@given(values=MATRICES, shift=st.integers(-9, 9), scale=st.sampled_from([0.5, 2.0, 64.0]))
def test_another_unit_or_zero_changes_nothing(values: np.ndarray, shift: int, scale: float) -> None:
    before, after = not_different(values), not_different(shift + scale * values)
    assert before.best == after.best
    assert list(before.alike) == list(after.alike)


def test_the_best_is_alike_and_a_copy_of_it_too() -> None:
    values = RESULTS["two clusters"].draw(np.random.Generator(np.random.PCG64(2)), (20, 30))
    found = not_different(values)
    assert found.best is not None
    again = not_different(np.vstack([values, values[found.best]]))
    assert again.best == found.best
    assert again.alike[[found.best, 20]].all()
