"""The gain from individual settings for each scenario."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rl_tui.studies.statistics.sensitivity import sensitivity_of

ZERO, ONE = np.zeros(2), np.ones(2)
SCORES = arrays(
    np.float64,
    st.tuples(st.integers(1, 5), st.integers(1, 6), st.integers(1, 4)),
    elements=st.integers(-8, 8).map(float),
)


def test_it_is_the_best_for_each_less_the_best_for_all() -> None:
    # Scenarios 0 and 1 need opposite settings. The middle one is the compromise
    scores = np.array([[0.9, 0.7, 0.1], [0.2, 0.6, 1.0]])
    found = sensitivity_of(scores[:, :, np.newaxis], ZERO, ONE)
    assert list(found.best) == [0, 2]
    assert found.common == 1
    assert found.tuned == pytest.approx(0.95)
    assert found.in_common == pytest.approx(0.65)
    assert found.value == pytest.approx(0.30)
    assert list(found.lost) == pytest.approx([0.2, 0.4])
    assert found.held_out is None


def test_scenarios_count_alike_whatever_their_scale() -> None:
    scores = np.array([[-13.0, -50.0], [0.1, 0.5]])[:, :, np.newaxis]
    found = sensitivity_of(scores, np.array([-113.0, 0.0]), np.array([-13.0, 1.0]))
    assert found.common == 1  # .565 on average, against .55
    assert found.value == pytest.approx((1 + 0.5) / 2 - (0.63 + 0.5) / 2)


def test_for_costs_the_best_is_below_the_random_policy() -> None:
    costs = np.array([[10.0, 90.0], [60.0, 50.0]])[:, :, np.newaxis]
    found = sensitivity_of(costs, np.full(2, 110.0), np.full(2, 10.0))
    assert (list(found.best), found.common) == ([0, 1], 0)
    assert found.value == pytest.approx(0.05)


@given(values=SCORES)
def test_it_is_never_below_zero_and_zero_for_one_scenario(values: np.ndarray) -> None:
    zero, one = np.zeros(len(values)), np.ones(len(values))
    found = sensitivity_of(values, zero, one)
    assert found.value >= -1e-12
    assert found.value == pytest.approx(found.tuned - found.in_common)
    alone = sensitivity_of(values[:1], zero[:1], one[:1])
    assert alone.value == 0


@given(values=SCORES, randomly=st.randoms(use_true_random=False))
def test_scenarios_and_settings_may_stand_in_any_order(values: np.ndarray, randomly: object) -> None:
    random = np.random.Generator(np.random.PCG64(randomly.getrandbits(32)))  # type: ignore[attr-defined]
    zero, one = np.zeros(len(values)), np.ones(len(values))
    mixed = values[random.permutation(len(values))][:, random.permutation(values.shape[1])]
    found, other = sensitivity_of(values, zero, one), sensitivity_of(mixed, zero, one)
    assert other.value == pytest.approx(found.value, abs=1e-12)


def test_where_settings_make_no_difference_only_the_held_out_value_is_zero_on_average() -> None:
    random = np.random.Generator(np.random.PCG64(1))
    found = [sensitivity_of(random.normal(0, 1, (5, 20, 30)), np.zeros(5), np.ones(5)) for _ in range(200)]
    plain = np.array([each.value for each in found if each])
    held_out = np.array([each.held_out for each in found if each], np.float64)
    error = held_out.std(ddof=1) / len(held_out) ** 0.5
    assert abs(held_out.mean()) < 4 * error
    assert plain.mean() > 10 * error


def test_where_they_do_the_held_out_value_finds_it() -> None:
    random = np.random.Generator(np.random.PCG64(1))
    means = np.array([[1.0, 0.7, 0.2], [0.2, 0.7, 1.0]])[:, :, np.newaxis]
    found = sensitivity_of(means + random.normal(0, 0.1, (2, 3, 40)), ZERO, ONE)
    assert found.held_out == pytest.approx(0.3, abs=0.05)


def test_what_did_not_run_everywhere_is_left_out_and_a_missing_run_is_not() -> None:
    scores = np.array([[[9.0, 9.0], [0.5, np.nan], [0.1, 0.1]], [[np.nan, np.nan], [0.5, 0.7], [0.9, 0.7]]])
    found = sensitivity_of(scores, ZERO, ONE)
    assert (list(found.best), found.common) == ([1, 2], 1)
    assert found.value == pytest.approx((0.5 + 0.8) / 2 - (0.5 + 0.6) / 2)
    assert sensitivity_of(np.full((2, 3, 1), np.nan), ZERO, ONE) is None
    assert sensitivity_of(np.ones((0, 3, 1)), ZERO[:0], ONE[:0]) is None


def test_what_has_no_scale_is_refused() -> None:
    with pytest.raises(ValueError, match="no scale"):
        sensitivity_of(np.ones((2, 3, 1)), ZERO, np.array([1.0, 0.0]))
    with pytest.raises(ValueError, match="for each scenario"):
        sensitivity_of(np.ones((3, 2, 1)), ZERO, ONE)
