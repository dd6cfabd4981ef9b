"""The plan of a sweep, and its errors."""

from __future__ import annotations

import tracemalloc
from collections import Counter
from dataclasses import replace
from itertools import islice

import pytest
from plans import cell_of, plan_of

from rl_tui.common.errors import UserError
from rl_tui.runs.library import find
from rl_tui.studies.sweeps.cell import Cell, SkippedCell
from rl_tui.studies.sweeps.cells.content import scenario_with
from rl_tui.studies.sweeps.cells.variation import read_variation
from rl_tui.studies.sweeps.plan import Shard, SweepPlan, read_plan, written_plan


def test_cells_are_all_combinations_the_last_setting_fastest() -> None:
    plan = plan_of("maze", "alpha=0.1,0.5", "algorithm=q-learning,sarsa,dyna-q")
    assert plan.count == 6
    assert [tuple(plan.settings(index).values()) for index in range(6)] == [
        (alpha, algorithm) for alpha in (0.1, 0.5) for algorithm in ("q-learning", "sarsa", "dyna-q")
    ]


def test_a_cell_is_a_recipe() -> None:
    plan = plan_of("maze", "alpha=0.5", "algorithm=sarsa", overrides={"epsilon": 0.3}, first_seed=7)
    cell = plan.cell(0)
    assert isinstance(cell, Cell)
    assert (cell.recipe.algorithm, cell.recipe.hyperparameters.alpha) == ("sarsa", 0.5)
    assert (cell.recipe.hyperparameters.epsilon, cell.recipe.seed, cell.goal.episodes) == (0.3, 7, 20)
    assert cell.text == "alpha=0.5 algorithm=sarsa"


def test_each_scenario_has_its_own_defaults() -> None:
    plan = plan_of("maze", "scenario=cliff,maze", episodes=None, overrides={"epsilon": 0.3})
    cells = [cell for cell in map(plan.cell, range(2)) if isinstance(cell, Cell)]
    assert [cell.recipe.scenario.id for cell in cells] == ["cliff", "maze"]
    assert [cell.goal.episodes for cell in cells] == [
        find(name).defaults["episodes"] for name in ("cliff", "maze")
    ]
    assert [cell.recipe.hyperparameters.epsilon for cell in cells] == [0.3, 0.3]


def test_what_cannot_work_together_is_skipped_with_a_reason() -> None:
    plan = plan_of("bandit", "scenario=bandit,maze", "policy=softmax,gradient")
    plan.check()
    skipped = [cell for cell in map(plan.cell, range(4)) if isinstance(cell, SkippedCell)]
    assert [cell.settings for cell in skipped] == [{"scenario": "maze", "policy": "gradient"}]
    assert "for bandits" in skipped[0].reason


def test_a_policy_that_needs_a_step_size_has_one_unless_another_was_asked_for() -> None:
    assert isinstance(plan_of("bandit", "policy=gradient").cell(0), Cell)
    plan = plan_of("bandit", "policy=gradient,ucb", "alpha=sample-average,0.1")
    plan.check()
    assert [isinstance(cell, SkippedCell) for cell in map(plan.cell, range(4))] == [True, False, False, False]


@pytest.mark.parametrize(
    ("scenario", "vary", "expected"),
    [
        ("maze", ["policy=ucb,gradient"], "policy=gradient"),
        (
            "gym:Blackjack-v1",
            ["algorithm=value-iteration,sarsa", "world.table=false"],
            "algorithm=value-iteration",
        ),
        ("bandit", ["policy=gradient", "alpha=sample-average"], "policy=gradient"),
        ("maze", ["world.noise=0:2:3"], "world.noise=2"),
        ("maze", ["world.nosie=0.1,0.2"], "world.nosie=0.1"),
        ("maze", ["scenario=maze,mazze"], "scenario=mazze"),
        ("maze", ["alpha=0.1:1:4", "alpha=0.5"], "twice"),
        ("maze", ["alpha=0.1:1"], "--random"),
        ("maze", ["alpha=0.1:1:9999", "epsilon=0:1:9999"], "99,980,001"),
    ],
)
def test_what_can_work_nowhere_is_refused_by_name(scenario: str, vary: list[str], expected: str) -> None:
    with pytest.raises(UserError) as fault:
        plan_of(scenario, *vary).check()
    assert expected in str(fault.value)
    assert "\n" not in str(fault.value)


def test_a_fault_of_the_settings_in_common_is_refused() -> None:
    with pytest.raises(UserError, match="epsilon is 7"):
        plan_of("maze", "alpha=0.1,0.2", overrides={"epsilon": 7.0}).check()


def test_points_at_random_depend_on_their_seed_and_number_alone() -> None:
    vary = ("alpha=0.001:1:log", "epsilon=0:0.5", "algorithm=q-learning,sarsa", "n=1:8")
    plan = plan_of("maze", *vary, random=200)
    plan.check()
    points = [plan.settings(index) for index in range(200)]
    assert plan_of("maze", *vary, random=500).settings(123) == points[123]
    assert plan_of("maze", *vary, random=200, random_seed=1).settings(123) != points[123]
    assert list(plan.order()) == list(range(200))
    assert all(0.001 <= float(point["alpha"]) <= 1 for point in points)
    # half of the draws of a logarithmic range lie below its geometric mean
    assert 70 < sum(float(point["alpha"]) < 0.0316 for point in points) < 130
    assert min(Counter(point["algorithm"] for point in points).values()) > 70
    assert set(Counter(point["n"] for point in points)) == set(range(1, 9))


@pytest.mark.parametrize("parts", [1, 2, 3, 7, 30])
def test_shards_are_the_whole_and_share_no_cell(parts: int) -> None:
    plan = plan_of("maze", "alpha=0.1:1:7", "epsilon=0:1:3")
    shards = [list(plan.order(Shard(number, parts))) for number in range(1, parts + 1)]
    assert sorted(index for shard in shards for index in shard) == list(range(21))
    assert [len(shard) for shard in shards] == [plan.size_of(Shard(n, parts)) for n in range(1, parts + 1)]


@pytest.mark.exhaustive("plans a million cells")
def test_a_million_cells_take_neither_memory_nor_time() -> None:
    plan = SweepPlan(
        find("maze"), (read_variation("alpha=0.001:1:log:1000"), read_variation("epsilon=0:1:1000"))
    )
    plan.cell(0)  # built once
    tracemalloc.start()
    try:
        plan.check()
        assert plan.count == 1_000_000
        first = [plan.cell(index) for index in islice(plan.order(), 200)]
        before = tracemalloc.get_traced_memory()[0]
        del first
        seen = sum(1 for _ in zip(plan.order(), range(50_000), strict=False))
        for index in range(0, plan.count, 2_000):
            cell = plan.cell(index)
            assert isinstance(cell, Cell)
            assert cell.key
        assert seen == 50_000
        current, peak = tracemalloc.get_traced_memory()
        assert current < before + 200_000
        assert peak < before + 3_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("scenario", ["maze", "gym:Blackjack-v1"])
def test_a_plan_is_read_back_as_it_was_written(scenario: str) -> None:
    plan = plan_of(
        scenario, "alpha=0.1:0.9:3", "algorithm=sarsa", overrides={"epsilon": 0.3}, random=4, random_seed=2
    )
    found = read_plan(written_plan(plan))
    assert written_plan(found) == written_plan(plan)
    assert [found.settings(index) for index in range(4)] == [plan.settings(index) for index in range(4)]
    one, other = found.cell(2), plan.cell(2)
    assert isinstance(one, Cell)
    assert isinstance(other, Cell)
    assert one.key == other.key


def test_a_plan_of_a_world_that_was_edited_has_that_world() -> None:
    plan = plan_of("maze", "alpha=0.5")
    edited = replace(plan, scenario=scenario_with(plan.scenario, {"world.cell[0,0]": "#"}))
    one, other = read_plan(written_plan(edited)).cell(0), edited.cell(0)
    assert isinstance(one, Cell)
    assert isinstance(other, Cell)
    assert one.key == other.key != cell_of("maze", "alpha=0.5").key


@pytest.mark.parametrize("text", ["", "[]", "{}", "no"])
def test_what_is_no_plan(text: str) -> None:
    with pytest.raises(UserError, match="not a sweep plan"):
        read_plan(text)
