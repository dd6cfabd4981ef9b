"""The mean of many runs and its interval."""

from __future__ import annotations

import math
from dataclasses import astuple
from statistics import fmean

import numpy as np
import pytest
import scipy  # its parts are imported where they are first used
from hypothesis import given
from hypothesis import strategies as st
from interval_coverage import HELD, RESULTS, coverage_of_mean

from rl_tui.studies.statistics.intervals import (
    CONFIDENCE,
    FEWEST_RUNS,
    MOST_RESAMPLED,
    RESAMPLES,
    interquartile_mean,
    interval_of,
    resamples,
    share_interval,
    student_quantile,
    student_share,
    summary_of,
)

NUMBERS = st.floats(-1e3, 1e3).map(lambda value: round(value, 3))
MANY = st.lists(NUMBERS, min_size=FEWEST_RUNS, max_size=40)


class Drawn:
    def __init__(self, means: np.ndarray) -> None:
        self.bootstrap_distribution = means
        self.confidence_interval = None


def drawn(runs: int, seed: int = 3) -> np.ndarray:
    return np.sort(RESULTS["mostly learned"].draw(np.random.Generator(np.random.PCG64(seed)), (1, runs))[0])


def reach(runs: int) -> float:
    """The confidence that corrects the narrowness of intervals of ``runs`` values."""
    quantile = scipy.stats.t.ppf(0.5 + CONFIDENCE / 2, runs - 1) * math.sqrt(runs / (runs - 1))
    return float(scipy.stats.norm.cdf(quantile) - scipy.stats.norm.cdf(-quantile))


@pytest.mark.parametrize("runs", [16, 30, MOST_RESAMPLED])  # enough that no resample equals the sample
def test_it_is_the_bca_interval_of_scipy_over_the_sameresamples(runs: int) -> None:
    values = drawn(runs)
    means = values[resamples(runs, 5)].mean(axis=0)
    theirs = scipy.stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=0,
        confidence_level=reach(runs),
        method="BCa",
        bootstrap_result=Drawn(means),
    ).confidence_interval
    assert interval_of(values, seed=5) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_it_is_near_what_scipy_draws_by_itself() -> None:
    values = drawn(30)
    theirs = scipy.stats.bootstrap(
        (values,), np.mean, n_resamples=50_000, confidence_level=reach(30), method="BCa", rng=1
    ).confidence_interval
    width = theirs.high - theirs.low
    assert interval_of(values) == pytest.approx((theirs.low, theirs.high), abs=0.03 * width)


@pytest.mark.parametrize("runs", [FEWEST_RUNS, 31])
def test_every_value_is_drawn_as_often_as_any_other_and_each_resample_has_its_mirror_image(runs: int) -> None:
    of_ranks = resamples(runs, 1)
    assert of_ranks.shape == (runs, RESAMPLES)
    assert set(np.bincount(of_ranks.ravel(), minlength=runs)) == {RESAMPLES}
    counts = sorted(tuple(np.bincount(each, minlength=runs)) for each in of_ranks.T)
    assert counts == sorted(each[::-1] for each in counts)


@pytest.mark.exhaustive("thousands of samples")
@pytest.mark.parametrize("kind", HELD)
@pytest.mark.parametrize("runs", [30, 100])
def test_it_covers_the_true_mean_in_93_to_97_percent(kind: str, runs: int) -> None:
    trials = 1_000
    covered = coverage_of_mean(kind, runs, trials).covered
    # If the truth were 93 or 97 %, this few trials would deviate further only once in a thousand times
    assert (
        scipy.stats.binom.ppf(0.001, trials, 0.93)
        <= covered * trials
        <= scipy.stats.binom.ppf(0.999, trials, 0.97)
    )


def test_results_have_the_means_that_are_said_of_them() -> None:
    for name, kind in RESULTS.items():
        values = kind.draw(np.random.Generator(np.random.PCG64(1)), (1, 400_000))
        assert np.mean(values) == pytest.approx(kind.mean, abs=0.02), name


def test_above_the_resamples_a_formula_goes_on_where_they_stop() -> None:
    values = drawn(MOST_RESAMPLED)
    low, high = interval_of(values) or (0.0, 0.0)
    more = interval_of(np.append(values, values[MOST_RESAMPLED // 2]))
    assert more == pytest.approx((low, high), abs=0.04 * (high - low))


def test_of_many_normal_values_it_is_that_of_student() -> None:
    values = scipy.stats.norm.ppf((np.arange(1_001) + 0.5) / 1_001)
    half = scipy.stats.t.ppf(0.975, 1_000) * values.std(ddof=1) / math.sqrt(1_001)
    assert interval_of(values) == pytest.approx((-half, half), abs=1e-9)


def test_skewness_pushes_both_ends_towards_the_long_tail() -> None:
    for runs in (MOST_RESAMPLED, MOST_RESAMPLED + 1):
        values = -np.log((np.arange(runs) + 0.5) / runs)
        low, high = interval_of(values) or (0.0, 0.0)
        assert high - values.mean() > 1.1 * (values.mean() - low)


@given(t=st.floats(), freedom=st.integers(1, 2_000))
def test_student_t_is_that_of_scipy(t: float, freedom: int) -> None:
    if math.isnan(t):
        return
    assert student_share(t, freedom) == pytest.approx(scipy.special.stdtr(freedom, t), abs=1e-13)


@given(share=st.floats(0.5, 0.9999), freedom=st.integers(1, 2_000))
def test_its_quantile_is_that_of_scipy(share: float, freedom: int) -> None:
    theirs = scipy.special.stdtrit(freedom, share)
    assert student_quantile(share, freedom) == pytest.approx(theirs, rel=1e-9, abs=1e-12)


@given(successes=st.integers(0, 60), more=st.integers(0, 60))
def test_a_share_has_the_interval_that_scipy_gives_it(successes: int, more: int) -> None:
    count = max(successes + more, 1)
    theirs = scipy.stats.binomtest(successes, count).proportion_ci(CONFIDENCE, method="wilson")
    assert share_interval(successes, count) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


@pytest.mark.parametrize(("successes", "count"), [(0, 0), (3, 2), (-1, 4)])
def test_what_is_no_share_has_no_interval(successes: int, count: int) -> None:
    with pytest.raises(ValueError, match="is not a valid share"):
        share_interval(successes, count)


@given(least=NUMBERS, width=st.floats(0.5, 100), above=st.integers(1, 29))
def test_two_values_have_the_interval_of_their_share(least: float, width: float, above: int) -> None:
    most = least + width
    low, high = share_interval(above, 30)
    told = interval_of([most] * above + [least] * (30 - above))
    assert told == pytest.approx((least + low * width, least + high * width), rel=1e-9, abs=1e-9)
    assert least <= told[0] < told[1] <= most


def test_what_differs_by_rounding_alone_is_one_value() -> None:
    nearly = [0.7 + step * 1e-16 for step in range(20)]
    assert interval_of(nearly) == pytest.approx((0.7, 0.7), abs=1e-12)
    low, high = share_interval(20, 30)
    assert interval_of([*nearly, *[0.0] * 10]) == pytest.approx((0.7 * low, 0.7 * high), abs=1e-12)


@given(value=NUMBERS, runs=st.integers(FEWEST_RUNS, 400))
def test_equal_values_have_no_spread(value: float, runs: int) -> None:
    told = summary_of([value] * runs)
    assert (told.low, told.high, told.median, told.iqm) == (value,) * 4
    assert told.mean == pytest.approx(value)


def test_below_ten_runs_nothing_is_claimed() -> None:
    few, enough = summary_of(range(9)), summary_of(range(10))
    assert (few.mean, few.median, few.low, few.high, few.count) == (4.0, 4.0, None, None, 9)
    assert enough.low is not None
    assert summary_of([]) is None
    assert interval_of(range(9)) is None


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused(bad: float) -> None:
    with pytest.raises(ValueError, match="needs finite values"):
        summary_of([1.0, bad])


@given(values=MANY, randomly=st.randoms())
def test_the_order_of_runs_makes_no_difference_to_a_bit(values: list[float], randomly: object) -> None:
    mixed = list(values)
    randomly.shuffle(mixed)  # type: ignore[attr-defined]
    assert summary_of(mixed) == summary_of(values)


@pytest.mark.exhaustive("draws many resamples")
@given(values=MANY)
def test_asked_again_after_others_it_gives_the_same_bits(values: list[float]) -> None:
    before = summary_of(values)
    for runs in range(FEWEST_RUNS, FEWEST_RUNS + 20):  # more than the limit
        summary_of(drawn(runs))
    assert summary_of(values) == before


@given(values=MANY, shift=NUMBERS, scale=st.sampled_from([0.01, 0.5, 3.0, 1e4, -1.0, -2.5]))
def test_another_unit_or_zero_or_sign_changes_nothing_else(
    values: list[float], shift: float, scale: float
) -> None:
    told = summary_of(values)
    moved = summary_of([shift + scale * value for value in values])
    assert told is not None
    assert moved is not None
    wanted = [shift + scale * float(each) for each in astuple(told)[:5]]
    if scale < 0:
        wanted[3:] = wanted[4], wanted[3]
    near = 1e-8 * (abs(shift) + abs(scale) * (1 + max(map(abs, values))))
    assert astuple(moved)[:5] == pytest.approx(wanted, abs=near)


@given(values=MANY)
def test_the_interval_lies_among_the_values_around_their_mean(values: list[float]) -> None:
    low, high = interval_of(values) or (math.nan, math.nan)
    near = 1e-9 * (1 + max(map(abs, values)))
    assert min(values) - near <= low <= fmean(values) + near
    assert fmean(values) - near <= high <= max(values) + near


def test_a_wide_spread_of_tiny_and_huge_numbers_is_no_trouble() -> None:
    for unit in (5e-324, 1e-300, 1e-160, 1e160):
        low, high = interval_of([unit * each for each in range(30)]) or (math.nan, math.nan)
        assert unit * 10 <= low < high <= unit * 19


@given(st.lists(NUMBERS, min_size=4, max_size=40).filter(lambda values: len(values) % 4 == 0))
def test_of_a_multiple_of_four_the_interquartile_mean_is_the_trimmed_mean(values: list[float]) -> None:
    assert interquartile_mean(values) == pytest.approx(scipy.stats.trim_mean(values, 0.25), abs=1e-9)


@given(st.lists(NUMBERS, min_size=1, max_size=15))
def test_the_interquartile_mean_is_that_of_each_value_four_times(values: list[float]) -> None:
    assert interquartile_mean(values) == pytest.approx(scipy.stats.trim_mean(values * 4, 0.25), abs=1e-9)


def test_the_interquartile_mean_counts_what_a_quartile_cuts_by_its_part() -> None:
    assert interquartile_mean([9, 0, 1, 2, 3]) == pytest.approx((0.75 * 1 + 2 + 0.75 * 3) / 2.5)
    assert interquartile_mean([4, 6]) == 5
    with pytest.raises(ValueError, match="needs at least one value"):
        interquartile_mean([])


def test_of_nearly_binary_results_the_ends_do_not_depend_on_the_resamples() -> None:
    results = [0.0] * 5 + [0.5] + [1.0] * 24
    for seed in range(10):
        assert interval_of(results, seed) == pytest.approx(interval_of(results))
