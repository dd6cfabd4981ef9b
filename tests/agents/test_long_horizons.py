"""Backward induction has the same bits by arrays and kernels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from shipped import SHIPPED

from rl_tui.agents.exact import backward_induction
from rl_tui.agents.exact.backward_induction import best_values, policy_values, seconds_of
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, interpreted
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def world(scenario: str) -> TabularMDP | None:
    return begin(recipe_named(scenario, {}, 0)).world.mdp


def swept(mdp: TabularMDP, steps: int) -> list[bytes]:
    policy = np.random.default_rng(1).random(mdp.pairs)
    policy[::3] = 0.0
    values = (policy_values(mdp, policy, steps), best_values(mdp, 1.0, steps), best_values(mdp, 0.9, steps))
    return [each.tobytes() for each in values]


@pytest.fixture
def by_kernel(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The number of sweeps in each call of a kernel, which is interpreted."""
    taken: list[int] = []

    def machine_code(kernel: Callable[..., None]) -> Callable[..., None]:
        def sweep(*args: Any) -> None:
            taken.append(args[-3])
            interpreted(kernel)(*args)

        return sweep

    monkeypatch.setattr(backward_induction, "machine_code", machine_code)
    monkeypatch.setattr(backward_induction, "COMPILED_LOOPS", set())
    return taken


@pytest.mark.parametrize("scenario", SHIPPED)
def test_arrays_give_the_bits_of_machine_code(scenario: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mdp = world(scenario)
    if mdp is None:
        pytest.skip("no table")
    steps = mdp.time_limit or 200
    compiled = swept(mdp, steps)
    monkeypatch.setattr(backward_induction, "COMPILED_LOOPS", set())
    assert swept(mdp, steps) == compiled


@pytest.mark.parametrize("scenario", ["student", "frozenlake-slippery", "cliff"])
@pytest.mark.parametrize("steps", [0, 1, 2, 3, 40])
@pytest.mark.parametrize("first", [0, 1, 200])
def test_where_it_changes_over_does_not_show(
    scenario: str, steps: int, first: int, by_kernel: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    mdp = world(scenario)
    assert mdp is not None
    by_arrays = swept(mdp, steps)
    assert by_kernel == []
    monkeypatch.setattr(backward_induction, "seconds_of", lambda model: 1.0)
    monkeypatch.setattr(backward_induction, "FIRST_LOOK", first - 0.5)
    monkeypatch.setattr(backward_induction, "WORTH_COMPILING", 0.5)
    assert swept(mdp, steps) == by_arrays
    assert bool(by_kernel) == (steps > first)


def test_a_long_horizon_is_left_to_machine_code(
    by_kernel: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    mdp = world("frozenlake-slippery")
    assert mdp is not None
    monkeypatch.setattr(backward_induction, "seconds_of", lambda model: 1.0)
    monkeypatch.setattr(backward_induction, "FIRST_LOOK", 0.5)
    monkeypatch.setattr(backward_induction, "WORTH_COMPILING", 10.0)
    best_values(mdp, 1.0, 11)
    assert by_kernel == []
    best_values(mdp, 1.0, 12)
    assert by_kernel == [11]


def test_what_has_come_to_rest_needs_no_machine_code(by_kernel: list[int]) -> None:
    mdp = world("frozenlake")
    assert mdp is not None
    best_values(mdp, 1.0, 10**9)
    assert by_kernel == []


def test_larger_worlds_take_longer() -> None:
    models = []
    for name in ("student", "frozenlake-8x8-slippery", "taxi"):
        mdp = world(name)
        models.append(seconds_of(backward_induction.model_of(mdp, mdp.reward)))
    assert models == sorted(models)
    assert COMPILED_LOOPS
