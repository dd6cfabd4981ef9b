from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.timeline.run_names import difference, run_names

BASE = recipe_for(find("frozenlake-slippery"), {}, 0)


def changed_recipe(base: Recipe = BASE, algorithm: str | None = None, **values: Any) -> Recipe:
    hyperparameters = base.hyperparameters
    for name, value in values.items():
        hyperparameters = hyperparameters.changed(name, value)
    return replace(base, algorithm=algorithm or base.algorithm, hyperparameters=hyperparameters)


PLAIN = changed_recipe(alpha=0.1, epsilon=0.1, gamma=0.99, epsilon_decay=0.0, alpha_decay=0.0)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"alpha": 0.5}, "α 0.5"),
        ({"algorithm": "sarsa"}, "SARSA"),
        ({"ties": "first"}, "ties first"),
        ({"epsilon": 0.3, "gamma": 0.9}, "γ 0.9, ε 0.3"),
        ({"policy": "softmax"}, "softmax"),
        ({"policy": "softmax", "temperature": 2.0}, "softmax, τ 2"),
        ({"algorithm": "sarsa-lambda", "lambda": 0.5}, "SARSA(λ), λ 0.5"),
        ({"initial_q": -2.5}, "Q₀ −2.5"),
        ({"alpha": "sample-average"}, "α 1/N"),
        ({"step_size_schedule": "sample-average"}, "α 1/N"),
        ({"epsilon_decay": 0.01}, "ε decay 0.01"),
        ({"algorithm": "dyna-q", "planning_steps": 50}, "Dyna-Q, planning 50"),
    ],
)
def test_a_lane_is_named_by_what_is_different(changes: dict[str, Any], name: str) -> None:
    assert difference(PLAIN, changed_recipe(PLAIN, **changes)) == name


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"temperature": 3.0},  # counts for softmax only
        {"lambda": 0.2},
        {"epsilon_schedule": "linear"},  # with a decay of 0 all schedules are the same
        {"alpha_min": 0.05},
    ],
)
def test_what_does_not_count_is_no_difference(changes: dict[str, Any]) -> None:
    assert difference(PLAIN, changed_recipe(PLAIN, **changes)) == ""


def test_the_first_lane_is_named_by_what_it_has_in_contrast() -> None:
    assert run_names([PLAIN, changed_recipe(PLAIN, alpha=0.5)]) == ["α 0.1", "α 0.5"]
    assert run_names([PLAIN, changed_recipe(PLAIN, algorithm="sarsa")]) == ["Q-learning", "SARSA"]
    assert run_names([PLAIN, changed_recipe(PLAIN, epsilon_decay=0.5)]) == ["ε decay 0", "ε decay 0.5"]


def test_among_many_lanes_the_first_tells_all_that_any_other_has_otherwise() -> None:
    lanes = [
        PLAIN,
        changed_recipe(PLAIN, alpha=0.5),
        changed_recipe(PLAIN, algorithm="sarsa", alpha=0.5),
        changed_recipe(PLAIN, gamma=0.9),
    ]
    assert run_names(lanes) == ["Q-learning, α 0.1, γ 0.99", "α 0.5", "SARSA, α 0.5", "γ 0.9"]


def test_what_the_first_lane_has_no_use_for_is_not_in_its_name() -> None:
    traced = changed_recipe(PLAIN, algorithm="sarsa-lambda", **{"lambda": 0.5})
    assert run_names([PLAIN, traced]) == ["Q-learning", "SARSA(λ), λ 0.5"]
    softmax = changed_recipe(PLAIN, policy="softmax", temperature=2.0)
    assert run_names([PLAIN, softmax]) == ["ε-greedy", "softmax, τ 2"]


def test_no_two_names_are_equal() -> None:
    assert run_names([PLAIN]) == ["Q-learning"]
    assert run_names([PLAIN, PLAIN, PLAIN]) == ["Q-learning", "Q-learning (2)", "Q-learning (3)"]
    half = changed_recipe(PLAIN, alpha=0.5)
    assert run_names([PLAIN, half, half]) == ["α 0.1", "α 0.5", "α 0.5 (2)"]
    close = [changed_recipe(PLAIN, alpha=0.1234567), changed_recipe(PLAIN, alpha=0.1234568)]
    assert run_names(close) == ["α 0.1234567", "α 0.1234568"]
    assert run_names([]) == []


def test_planners_have_no_step_size_to_differ_in() -> None:
    planner = changed_recipe(PLAIN, algorithm="value-iteration", alpha=0.7)
    assert run_names([PLAIN, planner]) == ["Q-learning", "Value iteration"]
    assert run_names([planner, PLAIN]) == ["Value iteration", "Q-learning, α 0.1"]


def test_another_seed_is_a_difference() -> None:
    assert run_names([PLAIN, replace(PLAIN, seed=3)]) == ["seed 0", "seed 3"]
