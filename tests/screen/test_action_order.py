"""Actions have one order on screen in all worlds."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import MakeApp
from sample_worlds import bandit_world, lake_world, student_world
from seams import notes, on_screen, press

from rl_tui.runs.library import find
from rl_tui.screen.draw.action_order import shown_order, shown_pairs, shown_place
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.worlds.drawing import Grid

UP, RIGHT, DOWN, LEFT = (-1, 0), (0, 1), (1, 0), (0, -1)


@pytest.mark.parametrize("world", [lake_world(), student_world(), bandit_world()])
def test_every_action_is_shown_once(world) -> None:
    order = shown_order(world)
    assert sorted(order) == list(range(len(world.space.action_names)))
    assert [shown_place(world, action) for action in order] == list(range(len(order)))


def test_directions_come_clockwise_from_the_top() -> None:
    world = lake_world()
    assert isinstance(world.drawing, Grid)
    assert [world.drawing.directions[action] for action in shown_order(world)] == [UP, RIGHT, DOWN, LEFT]
    pairs = world.space.pairs_of(6)
    assert [pair - pairs.start for pair in shown_pairs(world, pairs)] == [3, 2, 1, 0]
    assert shown_pairs(world, (pairs.start, pairs.start + 3)) == [pairs.start + 3, pairs.start]


@pytest.mark.parametrize(
    ("scenario", "arrows"), [("cliff", "↑→↓←"), ("windy-king", "↑→↓←↗↘↙↖"), ("taxi", "↑→↓←")]
)
def test_diagonals_follow_and_what_is_no_direction_comes_last(scenario, arrows) -> None:
    world = find(scenario).build(np.random.default_rng(0))
    directions = [world.drawing.directions[action] for action in shown_order(world)]
    known = [step for step in directions if step is not None]
    assert "".join(map(UNICODE.direction, known)) == arrows
    assert directions == known + [None] * (len(directions) - len(known))


def test_without_directions_the_order_is_the_worlds_own() -> None:
    assert shown_order(bandit_world()) == tuple(range(len(bandit_world().space.action_names)))
    assert shown_pairs(student_world(), (2, 0, 1)) == [0, 1, 2]


def test_an_unknown_action_comes_last() -> None:
    assert shown_place(lake_world(), -1) == 4


async def test_the_key_of_ties_says_in_which_order_the_first_counts_where_another_is_shown(
    make_app: MakeApp,
) -> None:
    for scenario, order in (("frozenlake", "← ↓ → ↑"), ("cliff", "")):
        async with on_screen(make_app(scenario), notifications=True) as pilot:
            await press(pilot, "a", "t")
            assert notes(pilot.app)[-1].endswith(order or "is taken")
