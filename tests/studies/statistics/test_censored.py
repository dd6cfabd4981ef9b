"""Arrivals, seen and unseen."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy  # its parts are imported where they are first used
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.studies.statistics.censored import arrivals_of, still_under_way
from rl_tui.studies.statistics.intervals import interval_of, share_interval

NEVER = math.nan


@st.composite
def watched_runs(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    runs = draw(st.lists(st.tuples(st.integers(0, 12), st.integers(1, 12)), min_size=1, max_size=30))
    times = np.array([time if time <= budget else NEVER for time, budget in runs])
    return times, np.array([budget for _, budget in runs], np.float64)


@given(watched_runs())
def test_the_share_under_way_is_what_scipy_estimates(runs: tuple[np.ndarray, np.ndarray]) -> None:
    times, watched = runs
    arrived = ~np.isnan(times)
    theirs = scipy.stats.ecdf(scipy.stats.CensoredData(uncensored=times[arrived], right=watched[~arrived])).sf
    moments, still = still_under_way(times, watched)
    assert moments[0] == 0
    assert np.all(np.diff(moments) > 0)
    assert still == pytest.approx(theirs.evaluate(moments), abs=1e-12)


def with_one_budget(times: list[float], budget: float) -> tuple[np.ndarray, np.ndarray]:
    return np.array(times), np.full(len(times), budget)


def test_with_one_budget_it_is_as_one_would_count() -> None:
    times = [3.0, 5.0, 5.0, 8.0, 9.0, 10.0, *[NEVER] * 4]
    found = arrivals_of(*with_one_budget(times, 20.0))
    assert (found.count, found.share, found.median, found.horizon) == (10, 0.6, 9.0, 20.0)
    assert (found.share_low, found.share_high) == share_interval(6, 10)
    at_most = [min(time, 20.0) if time == time else 20.0 for time in times]
    assert found.restricted_mean == pytest.approx(np.mean(at_most))
    assert (found.low, found.high) == interval_of(at_most)


def test_a_median_that_was_not_seen_is_none_and_not_the_budget() -> None:
    found = arrivals_of(*with_one_budget([1.0, 2.0, NEVER, NEVER, NEVER], 10.0))
    assert found.median is None
    assert found.restricted_mean == pytest.approx((1 + 2 + 3 * 10) / 5)
    nobody = arrivals_of(*with_one_budget([NEVER] * 12, 10.0))
    assert (nobody.share, nobody.median, nobody.restricted_mean) == (0.0, None, 10.0)
    assert nobody.share_low == 0
    assert nobody.share_high == pytest.approx(0.2425, abs=1e-4)


@given(st.lists(st.integers(0, 50), min_size=1, max_size=40))
def test_if_all_arrive_it_is_their_median_and_mean(times: list[int]) -> None:
    found = arrivals_of(*with_one_budget([float(time) for time in times], 60.0))
    assert found.share == 1
    assert found.median == sorted(times)[(len(times) - 1) // 2]
    assert found.restricted_mean == pytest.approx(np.mean(times))


@given(st.lists(st.integers(1, 50) | st.just(NEVER), min_size=1, max_size=40), st.sampled_from([0.5, 3.0]))
def test_another_unit_of_time_changes_nothing_else(times: list[float], scale: float) -> None:
    found = arrivals_of(*with_one_budget(times, 60.0))
    other = arrivals_of(*with_one_budget([time * scale for time in times], 60.0 * scale))
    assert other.share == found.share
    assert (other.median is None) == (found.median is None)
    if found.median is not None:
        assert other.median == pytest.approx(found.median * scale)
    assert found.restricted_mean is not None
    assert other.restricted_mean == pytest.approx(found.restricted_mean * scale)


def test_a_run_that_was_watched_for_less_counts_as_long_as_it_was_seen() -> None:
    # At 4 one of four arrives. The third was watched until 6, so at 8 one of two does
    found = arrivals_of(np.array([4.0, 8.0, NEVER, NEVER]), np.array([10.0, 10.0, 6.0, 10.0]))
    assert found.median == 8.0
    assert found.restricted_mean == pytest.approx(4 * 1 + 4 * 3 / 4 + 2 * 3 / 8)
    assert found.low is None


def test_what_comes_after_the_last_one_seen_is_not_made_up() -> None:
    found = arrivals_of(np.array([4.0, 10.0, NEVER]), np.array([12.0, 12.0, 11.0]))
    assert found.horizon == 12.0
    assert found.restricted_mean is None


def test_below_ten_runs_nothing_is_claimed() -> None:
    found = arrivals_of(*with_one_budget([1.0] * 4 + [2.0] * 5, 10.0))
    assert (found.share_low, found.share_high, found.low, found.high) == (None,) * 4
    assert arrivals_of(*with_one_budget([], 1.0)) is None


@pytest.mark.parametrize(
    ("times", "watched"),
    [([1.0], [1.0, 2.0]), ([1.0], [math.inf]), ([3.0], [2.0]), ([-1.0], [2.0]), ([NEVER], [-1.0])],
)
def test_what_cannot_be_is_refused(times: list[float], watched: list[float]) -> None:
    with pytest.raises(ValueError, match=r"each (run needs a time|time must be)"):
        arrivals_of(np.array(times), np.array(watched))
