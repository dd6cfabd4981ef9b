"""The order of cells."""

from __future__ import annotations

from itertools import islice, pairwise, product
from math import prod

from hypothesis import given
from hypothesis import strategies as st

from rl_tui.studies.sweeps.cells.order import Axis, coarse_first


@given(st.lists(st.builds(Axis, st.integers(1, 12), st.booleans()), min_size=1, max_size=3))
def test_every_cell_comes_once(axes: list[Axis]) -> None:
    count = prod(axis.count for axis in axes)
    assert sorted(coarse_first(axes)) == list(range(count))


def test_corners_come_first_and_then_what_lies_between() -> None:
    order = [divmod(index, 5) for index in coarse_first([Axis(5, True), Axis(5, True)])]
    assert set(order[:4]) == set(product((0, 4), (0, 4)))
    assert set(order[:9]) == set(product((0, 2, 4), (0, 2, 4)))


def test_of_listed_values_none_waits_for_another() -> None:
    order = list(coarse_first([Axis(9, True), Axis(3, False)]))
    assert sorted(order[:6]) == [0, 1, 2, 24, 25, 26]


def test_gaps_are_halved_before_any_is_halved_again() -> None:
    """Except at the last level, no gap is more than twice another one."""
    for count in range(2, 70):
        order = list(coarse_first([Axis(count, True)]))
        seen = 2
        while seen < count:
            seen = min(count, 2 * seen - 1)
            gaps = [after - before for before, after in pairwise(sorted(order[:seen]))]
            assert max(gaps[:-1], default=1) <= 2 * min(gaps[:-1], default=1), (count, seen)


def test_the_first_cells_of_a_huge_grid_are_there_at_once() -> None:
    axes = [Axis(1_000_000, True), Axis(1_000_000, True)]
    assert list(islice(coarse_first(axes), 4)) == [0, 999_999, 999_999_000_000, 999_999_999_999]
