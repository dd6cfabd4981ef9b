"""Exact values of large worlds, by another solver."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.agents.exact.backward_induction import best_values
from rl_tui.agents.exact.policy_evaluation import MOST_DENSE
from rl_tui.agents.exact.solve import best_expected_return, endless_states, returns, solve
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

pytestmark = pytest.mark.unit


def random_map(seed: int, characters: str, **rules: Any) -> TabularMDP:
    cells = np.random.default_rng(seed).choice(list(characters), (24, 24))
    cells[0, 0], cells[-1, -1], cells[-1, -2] = "S", "G", "."
    lines = "\n".join("".join(row) for row in cells)
    legend = {"X": {"kind": "floor", "exit": True, "reward": 0.3}}
    section = GridSection.model_validate({"map": lines, "legend": legend, "step_reward": -0.02, **rules})
    mdp = section.build(np.random.default_rng(0)).mdp
    assert mdp.states > MOST_DENSE
    return mdp


@pytest.mark.parametrize("characters", ["....#", "......#X", ".....#H"])
@pytest.mark.parametrize("noise", [0.0, 0.2])
@pytest.mark.parametrize("gamma", [0.9, 0.99])
def test_values_are_those_of_a_very_long_horizon(characters: str, noise: float, gamma: float) -> None:
    mdp = random_map(7, characters, noise=noise)
    solution = solve(mdp, gamma)
    assert solution.v == pytest.approx(best_values(mdp, gamma, 6_000), abs=1e-9)
    assert solution.iterations <= 3, "what it starts from leaves little to improve"


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 7),
    st.sampled_from(["....#", ".....#H", "......#X"]),
    st.sampled_from([0.0, 0.2]),
    st.sampled_from([0.5, 0.9, 0.99]),
    st.sampled_from([-1_000.0, -0.01, 0.0, 1.0, 1_000.0]),
)
def test_the_values_it_begins_near_decide_nothing(
    seed: int, characters: str, noise: float, gamma: float, off: float
) -> None:
    mdp = random_map(seed, characters, noise=noise)
    alone = solve(mdp, gamma)
    near = alone.v + off * np.random.default_rng(seed).random(mdp.states)
    for start in (near, alone.v, np.full(mdp.states, off)):
        found = solve(mdp, gamma, start)
        assert np.abs(found.v - alone.v).max() <= 1e-9
        assert np.abs(found.q - alone.q).max() <= 1e-9
        assert np.array_equal(found.greedy, alone.greedy)
        assert np.array_equal(found.best, alone.best)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_the_best_return_does_not_depend_on_the_policy_it_is_sought_from(seed: int, noise: float) -> None:
    mdp = random_map(seed, ".....#", noise=noise)
    alone = best_expected_return(mdp)
    found = [returns(mdp, solve(mdp, gamma)).best_expected_return for gamma in (0.5, 0.95, 1.0)]
    assert alone is not None
    assert found == pytest.approx([alone] * 3, abs=1e-9)


def test_a_greedy_policy_that_is_the_best_undiscounted_too_earns_as_much() -> None:
    mdp = random_map(3, ".....#", noise=0.1)
    far_sighted = returns(mdp, solve(mdp, 0.999))
    assert far_sighted.expected_return == pytest.approx(far_sighted.best_expected_return, abs=1e-9)
    short_sighted = returns(mdp, solve(mdp, 0.3))
    assert short_sighted.expected_return is None or short_sighted.expected_return < (
        short_sighted.best_expected_return or 0.0
    )


def test_states_without_a_way_to_an_end_are_found_in_a_large_map() -> None:
    mdp = random_map(3, ".....#")
    assert not endless_states(mdp).any()
    lines = ["S" + "." * 23, *["." * 24] * 22, "." * 24]
    closed = GridSection.model_validate({"map": "\n".join(lines)}).build(np.random.default_rng(0)).mdp
    assert closed is not None
    assert endless_states(closed).all()
