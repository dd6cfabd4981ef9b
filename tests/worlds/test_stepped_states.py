"""The states of environments without a table."""

from __future__ import annotations

import math

import numpy as np
import pytest
from gymnasium import spaces

from rl_tui.worlds.drawing import Body, BodyKind, CellKind, Title
from rl_tui.worlds.gym.states import BinStates, OutsideError, ProductNames, discrete_states
from rl_tui.worlds.gym.stepped_layout import product_grid


@pytest.mark.parametrize(
    ("space", "observation", "state", "states"),
    [
        (spaces.Discrete(5), 3, 3, 5),
        (spaces.Discrete(5, start=-2), -2, 0, 5),
        (spaces.Discrete(5), np.int64(4), 4, 5),
        (spaces.MultiDiscrete([2, 3]), np.array([1, 2]), 5, 6),
        (spaces.MultiDiscrete([2, 3], start=[1, 10]), np.array([1, 12]), 2, 6),
        (spaces.MultiDiscrete([[2, 3], [4, 5]]), np.array([[0, 0], [1, 0]]), 5, 120),
        (spaces.MultiBinary(4), np.array([1, 0, 1, 1], np.int8), 11, 16),
        (
            spaces.Tuple((spaces.Discrete(32), spaces.Discrete(11), spaces.Discrete(2))),
            (12, 7, True),
            279,
            704,
        ),
        (spaces.Dict(b=spaces.Discrete(2), a=spaces.MultiBinary(2)), {"a": np.array([1, 1]), "b": 0}, 3, 8),
        (spaces.Tuple((spaces.Tuple((spaces.Discrete(2),)), spaces.Discrete(3))), ((1,), 2), 5, 6),
    ],
)
def test_every_combination_of_discrete_parts_is_a_state(space, observation, state, states):
    made = discrete_states(space)
    assert made.state_of(observation) == state
    assert len(ProductNames(made.part_names)) == states


@pytest.mark.parametrize("value", [-1, 5, 1.5, math.nan, "3", None, (3,)])
def test_what_is_not_in_the_space_is_no_state(value):
    made = discrete_states(spaces.Discrete(5))
    assert made is not None
    with pytest.raises((OutsideError, TypeError, ValueError)):
        made.state_of(value)


@pytest.mark.parametrize("space", [spaces.Box(0.0, 1.0), spaces.Text(3), spaces.Sequence(spaces.Discrete(2))])
def test_other_spaces_have_no_states(space):
    assert discrete_states(spaces.Tuple((spaces.Discrete(2), space))) is None


def test_names_tell_the_parts():
    names = ProductNames([["a", "b"], ["only"], ["0", "1", "2"]])
    assert list(names) == ["a, 0", "a, 1", "a, 2", "b, 0", "b, 1", "b, 2"]
    assert (names[-1], names[1:3]) == ("b, 2", ("a, 1", "a, 2"))
    assert list(ProductNames([["any"], ["any"]])) == ["any"]
    with pytest.raises(IndexError):
        names[6]


def test_a_grid_of_one_part_is_the_squarest():
    grid = product_grid([7], 2)
    assert grid.legend == ""
    assert (grid.rows, grid.columns, grid.cell_of_state) == (3, 3, tuple(range(7)))
    assert grid.kinds == (CellKind.FLOOR,) * 7 + (CellKind.WALL,) * 2
    assert grid.directions == (None, None)


def test_a_grid_of_two_parts_has_the_first_down_and_the_second_across():
    grid = product_grid([1, 2, 3, 1], 1)
    assert grid.legend == "part 1 down, part 2 across"
    terms = ("position", "velocity", "angle", "angular velocity")
    assert product_grid([1, 2, 3, 1], 1, terms).legend == "velocity down, angle across"
    legend = product_grid([3, 2, 4, 2], 1, terms).legend
    assert legend == "position down, velocity across, blocks: angle and angular velocity"
    assert (grid.rows, grid.columns, grid.cell_of_state) == (2, 3, tuple(range(6)))


def test_a_body_on_a_hill_has_its_position_across_and_the_velocity_upwards() -> None:
    terms, names = ("position", "velocity"), (["a", "b", "c"], ["slow", "fast"])
    grid = product_grid([3, 2], 1, terms, names, Body(BodyKind.MOUNTAIN_CAR, ()))
    assert grid.legend == "velocity up, position across"
    assert (grid.rows, grid.columns, grid.cell_of_state) == (2, 3, (3, 0, 4, 1, 5, 2))
    assert grid.axes is not None
    assert grid.axes.is_upward
    assert (grid.axes.rows, grid.axes.columns) == (("fast", "slow"), ("a", "b", "c"))


@pytest.mark.parametrize("sizes", [[32, 11, 2], [3, 3, 6, 6], [2, 2, 2, 2, 2], [10, 2, 7]])
def test_further_parts_make_blocks_with_walls_between(sizes):
    grid = product_grid(sizes, 1)
    cells = np.array(grid.cell_of_state).reshape(sizes[0], sizes[1], -1)
    assert len(set(grid.cell_of_state)) == math.prod(sizes)
    assert np.all(np.diff(cells, axis=0) == grid.columns)
    assert np.all(np.diff(cells, axis=1) == 1)
    assert sum(kind is CellKind.FLOOR for kind in grid.kinds) == math.prod(sizes)
    assert len(grid.kinds) == grid.rows * grid.columns


def test_bins_have_middles_those_outside_as_wide_as_their_neighbours() -> None:
    states = BinStates([[], [0.0], [-1.0, 0.0, 2.0]], [["any"], ["a", "b"], ["a", "b", "c", "d"]])
    once, twice, often = states.middles
    assert np.isnan([*once, *twice]).all()
    assert often == (-1.5, -0.5, 1.0, 3.0)


def test_rows_columns_and_blocks_are_labelled() -> None:
    names, terms = (list("abcdef"), ["only"], ["0", "1", "2"], ["no", "yes"]), ("sum", "one", "dealer", "ace")
    axes = product_grid([6, 1, 3, 2], 1, terms, names).axes
    assert axes is not None
    assert axes.rows == tuple("abcdef")
    assert axes.columns == ("0", "1", "2", "", "0", "1", "2")
    assert axes.titles == (Title(-1, 0, 3, "ace: no"), Title(-1, 4, 3, "ace: yes"))
    assert axes.names == ("sum", "dealer")


def test_what_has_no_names_or_fills_rows_only_has_no_labels() -> None:
    assert product_grid([6, 1, 3, 2], 1).axes is None
    assert product_grid([2], 1, names=(["a", "b"],)).axes is None
