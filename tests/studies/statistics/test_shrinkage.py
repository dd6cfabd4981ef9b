"""The best cell, trained again on fresh seeds."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy  # its parts are imported where they are first used
from hypothesis import given
from hypothesis import strategies as st
from interval_coverage import HELD, RESULTS, coverage_of_difference

from rl_tui.studies.statistics.intervals import summary_of
from rl_tui.studies.statistics.shrinkage import shrinkage_of

MANY = st.lists(st.integers(-50, 50).map(float), min_size=10, max_size=30)


def test_it_is_the_first_mean_less_that_of_the_fresh_seeds() -> None:
    first, again = [float(each) for each in range(10)], [each - 1.5 for each in range(12)]
    found = shrinkage_of(first, again)
    assert (found.first, found.again) == (summary_of(first), summary_of(again))
    assert found.shrunk == pytest.approx(4.5 - 4.0)
    assert found.low is not None
    assert found.high is not None
    assert found.low < 0 < found.shrunk < found.high


def test_a_cost_that_is_higher_again_has_shrunk_too() -> None:
    first, again = np.arange(10.0), np.arange(10.0) - 1
    found, costs = shrinkage_of(first, again), shrinkage_of(-first, -again, larger_is_better=False)
    assert found.shrunk == pytest.approx(1.0)
    assert (costs.shrunk, costs.low, costs.high) == pytest.approx((found.shrunk, found.low, found.high))


def test_two_shares_have_the_interval_of_newcombe() -> None:
    # His paper's example (a): 56 of 70 against 48 of 80, by method 10 from 0.0524 to 0.3339
    found = shrinkage_of([1.0] * 56 + [0.0] * 14, [1.0] * 48 + [0.0] * 32)
    assert (found.low, found.high) == pytest.approx((0.0524, 0.3339), abs=5e-5)


@given(first=MANY, again=MANY, shift=st.integers(-9, 9), scale=st.sampled_from([0.5, 4.0]))
def test_another_unit_scales_it_and_another_zero_does_not_matter(
    first: list[float], again: list[float], shift: float, scale: float
) -> None:
    found = shrinkage_of(first, again)
    moved = shrinkage_of([shift + scale * each for each in first], [shift + scale * each for each in again])
    assert found.low is not None
    assert found.high is not None
    assert found.low <= found.shrunk <= found.high
    wanted = [scale * each for each in (found.shrunk, found.low, found.high)]
    assert [moved.shrunk, moved.low, moved.high] == pytest.approx(wanted, abs=1e-7)


@pytest.mark.exhaustive("counts how often over many samples", but=["normal"])
@pytest.mark.parametrize("kind", HELD)
def test_its_interval_covers_the_true_difference(kind: str) -> None:
    trials = 500
    covered = coverage_of_difference(kind, 30, trials).covered
    assert (
        scipy.stats.binom.ppf(0.001, trials, 0.93)
        <= covered * trials
        <= scipy.stats.binom.ppf(0.999, trials, 0.97)
    )


def test_the_luckiest_of_equal_cells_shrinks_to_what_it_is() -> None:
    random = np.random.Generator(np.random.PCG64(1))
    draw, mean = RESULTS["mostly learned"].draw, RESULTS["mostly learned"].mean
    shrunk, again = [], []
    for _ in range(100):
        cells = draw(random, (20, 30))
        found = shrinkage_of(cells[np.argmax(cells.mean(axis=1))], draw(random, (1, 30))[0])
        shrunk.append(found.shrunk)
        again.append(found.again.mean)
    assert np.mean(shrunk) > 0.07
    assert np.mean(again) == pytest.approx(mean, abs=0.02)


def test_without_runs_enough_nothing_is_claimed() -> None:
    found = shrinkage_of([1.0, 2.0], np.arange(10.0))
    assert (found.shrunk, found.low, found.high) == (-3.0, None, None)
    assert shrinkage_of([], [1.0]) is None
    assert shrinkage_of([1.0], []) is None
    with pytest.raises(ValueError, match="finite values"):
        shrinkage_of([1.0], [math.nan])
