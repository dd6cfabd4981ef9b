"""Shipped worlds have the values of the literature."""

from __future__ import annotations

import numpy as np
import pytest
from shipped import SHIPPED

from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.agents.exact.solve import greedy_return, solve
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.files.shipped import shipped_folder
from rl_tui.worlds.world import World


def built(name: str, seed: int = 0) -> World:
    return find(name).build(np.random.default_rng(seed))


def gamma_of(name: str) -> float:
    return recipe_for(find(name)).hyperparameters.gamma


def solved(world: World, gamma: float) -> Solution:
    assert world.mdp is not None
    return solve(world.mdp, gamma)


def values_of(world: World, gamma: float) -> dict[str, float]:
    v = solved(world, gamma).v
    return {
        name: v[state] for state, name in enumerate(world.space.state_names) if world.space.pairs_of(state)
    }


def best_of(name: str) -> tuple[float, float | None]:
    world = built(name)
    solution = solved(world, gamma_of(name))
    assert world.mdp is not None
    return solution.value_at_start, greedy_return(world.mdp, solution)


@pytest.mark.parametrize("name", SHIPPED)
def test_is_sound_in_itself_and_with_its_environment(name: str) -> None:
    scenario = read_scenario(shipped_folder() / f"{name}.toml")
    assert scenario.title
    assert scenario.summary
    for heading in ("**What it teaches", "**Try this**", "**Source.**"):
        assert heading in scenario.notes


def test_no_two_stand_in_the_same_place_of_the_catalogue() -> None:
    orders = [read_scenario(path, ask_environment=False).order for path in shipped_folder().glob("*.toml")]
    assert len(set(orders)) == len(orders)


@pytest.mark.parametrize(("name", "steps"), [("cliff", 13), ("windy", 15), ("windy-king", 7)])
def test_shortest_ways_where_each_step_costs_one(name: str, steps: int) -> None:
    assert best_of(name) == pytest.approx((-steps, -steps))


def test_the_dyna_maze_has_47_cells_and_a_way_of_14_steps() -> None:
    world = built("maze")
    assert sum(bool(world.space.pairs_of(state)) for state in range(world.space.states)) == 46
    assert world.space.states == 47
    assert best_of("maze") == pytest.approx((0.95**13, 1.0))


def test_the_mean_ride_of_the_taxi_is_worth_793() -> None:
    assert best_of("taxi")[1] == pytest.approx(7.93)


def test_the_walk_ends_on_the_right_from_each_state_with_so_many_sixths() -> None:
    values = values_of(built("random-walk"), 1.0)
    assert values == pytest.approx({"A": 1 / 6, "B": 2 / 6, "C": 3 / 6, "D": 4 / 6, "E": 5 / 6})


def test_nothing_is_gained_on_the_left_of_max_bias() -> None:
    world = built("max-bias")
    assert values_of(world, 1.0) == pytest.approx({"A": 0.0, "B": -0.1})
    assert sorted(set(world.mdp.reward_std.tolist())) == [0.0, 1.0]
    assert len(world.space.pairs_of(world.space.state_names.index("B"))) == 10


def on_the_map(name: str, gamma: float) -> list[list[float | None]]:
    """Return V* of the cells, row by row; None for walls and for cells without actions."""
    world = built(name)
    grid = world.drawing
    values = values_of(world, gamma)
    rows: list[list[float | None]] = [[None] * grid.columns for _ in range(grid.rows)]
    for state, cell in enumerate(grid.cell_of_state):
        row, column = divmod(cell, grid.columns)
        if row < grid.rows:
            rows[row][column] = values.get(world.space.state_names[state])
    return rows


def test_the_textbook_world_has_the_textbook_values() -> None:
    # Russell & Norvig, the 4×3 world with a reward of −0.04 a step, γ = 1
    printed = [[0.812, 0.868, 0.918, None], [0.762, None, 0.660, None], [0.705, 0.655, 0.611, 0.388]]
    found = on_the_map("book", 1.0)
    for row, expected in zip(found, printed, strict=True):
        assert [each is None for each in row] == [each is None for each in expected]
        assert [each for each in row if each is not None] == pytest.approx(
            [each for each in expected if each is not None], abs=0.0006
        )


def test_the_goal_of_karpathys_world_carries_on_from_the_start() -> None:
    values = on_the_map("karpathy", 0.9)
    start, goal = values[0][0], values[5][5]
    assert start == pytest.approx(0.9**16 / (1 - 0.9**17))  # 16 steps to the goal, one to leave it
    assert goal == pytest.approx(1 + 0.9 * start)
    assert sum(each is None for row in values for each in row) == 12  # walls


@pytest.mark.parametrize(("gamma", "crosses"), [(0.67, False), (0.69, True)])
def test_without_noise_the_discount_decides_about_the_bridge(gamma: float, crosses: bool) -> None:
    section = find("bridge").section.model_copy(update={"noise": 0.0})
    best = solved(section.build(np.random.default_rng(0)), gamma).value_at_start
    assert best == pytest.approx(10 * gamma**7 if crosses else gamma)


@pytest.mark.parametrize(
    ("gamma", "noise", "step_reward", "expected"),
    [
        (0.3, 0.0, 0.0, (1.0, 5)),
        (0.9, 0.0, 0.0, (10.0, 8)),
        (0.4, 0.2, 0.0, (1.0, None)),
        (0.9, 0.2, 0.0, (10.0, None)),
    ],
)
def test_discount_and_noise_choose_the_exit(
    gamma: float, noise: float, step_reward: float, expected: tuple[float, int | None]
) -> None:
    section = find("discount").section.model_copy(update={"noise": noise, "step_reward": step_reward})
    world = section.build(np.random.default_rng(0))
    solution = solved(world, gamma)
    reward, steps = expected
    assert world.mdp is not None
    assert greedy_return(world.mdp, solution) == pytest.approx(reward, rel=0.1)
    if steps is not None:
        assert solution.value_at_start == pytest.approx(reward * gamma ** (steps - 1))


def test_another_seed_is_another_lake_with_a_way() -> None:
    lakes = [built("frozenlake-random", seed) for seed in range(5)]
    assert len({lake.drawing.kinds for lake in lakes}) == 5
    assert lakes[0].drawing.kinds == built("frozenlake-random").drawing.kinds
    for lake in lakes:
        assert solved(lake, 0.99).value_at_start > 0.0


@pytest.mark.parametrize("name", SHIPPED)
def test_its_defaults_begin_to_train(name: str) -> None:
    run = Run(recipe_for(find(name)), evaluate=False)
    run.advance(steps=20)
    assert run.step == 20
