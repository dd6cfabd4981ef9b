"""Backward induction that begins interpreted and goes on as machine code: the same bits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from rl_tui.agents.exact import backward_induction
from rl_tui.agents.exact.backward_induction import best_values, policy_values
from rl_tui.agents.kernels.machine_code import interpreted
from rl_tui.lab.run.library import recipe_named
from rl_tui.lab.run.recipe import begin
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def world(scenario: str) -> TabularMDP:
    mdp = begin(recipe_named(scenario, {}, 0)).world.mdp
    assert mdp is not None
    return mdp


def swept(mdp: TabularMDP, steps: int) -> list[np.ndarray[Any, Any]]:
    uniform = 1.0 / np.diff(mdp.first_pair)[mdp.pair_state]
    return [policy_values(mdp, uniform, steps), best_values(mdp, 1.0, steps), best_values(mdp, 0.9, steps)]


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many sweeps machine code was asked for, each time; here interpreted does them."""
    taken: list[int] = []

    def machine_code(kernel: Callable[..., None]) -> Callable[..., None]:
        def sweep(*args: Any) -> None:
            taken.append(args[-3])
            interpreted(kernel)(*args)

        return sweep

    monkeypatch.setattr(backward_induction, "machine_code", machine_code)
    monkeypatch.setattr(backward_induction, "fastest", interpreted)
    return taken


@pytest.mark.parametrize("scenario", ["student", "frozenlake-slippery", "cliff"])
@pytest.mark.parametrize("steps", [0, 1, 2, 3, 40])
@pytest.mark.parametrize("first", [0, 1, 200])
def test_where_it_changes_over_does_not_show(
    scenario: str, steps: int, first: int, taken: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    mdp = world(scenario)
    whole = swept(mdp, steps)
    assert taken == []
    monkeypatch.setattr(backward_induction, "FIRST_VISITS", first)
    monkeypatch.setattr(backward_induction, "WORTH_COMPILING", 0)
    for ours, theirs in zip(swept(mdp, steps), whole, strict=True):
        assert ours.tobytes() == theirs.tobytes()


def test_a_long_horizon_is_left_to_machine_code(taken: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    mdp = world("frozenlake-slippery")
    monkeypatch.setattr(backward_induction, "FIRST_VISITS", 1)
    monkeypatch.setattr(backward_induction, "WORTH_COMPILING", 10 * len(mdp.next_state))
    best_values(mdp, 1.0, 11)
    assert taken == []
    best_values(mdp, 1.0, 12)
    assert taken == [11]


def test_what_has_come_to_rest_needs_no_machine_code(
    taken: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    mdp = world("frozenlake")
    monkeypatch.setattr(backward_induction, "FIRST_VISITS", 20 * len(mdp.next_state))
    best_values(mdp, 1.0, 10**9)
    assert taken == []


def test_what_is_in_the_cache_is_worth_less_of_a_wait(
    taken: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    mdp = world("frozenlake-slippery")
    monkeypatch.setattr(backward_induction, "FIRST_VISITS", 1)
    monkeypatch.setattr(backward_induction, "WORTH_READING", 10 * len(mdp.next_state))
    for noted in (False, True):
        monkeypatch.setattr(backward_induction, "was_compiled", lambda _, noted=noted: noted)
        best_values(mdp, 1.0, 12)
    assert taken == [11]
