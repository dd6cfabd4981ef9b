"""The book's figures for control, as ``train --runs --json`` gives them.

Seeds are fixed. The tolerance of a mean is four of our standard errors plus the reading error of the printed
figure.
"""

from __future__ import annotations

import functools
from typing import Any

import pytest
from recipes import recipe

from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal

# Every day test_every_algorithm.py holds the algorithms to their boxes, bit for bit
pytestmark = [pytest.mark.slow, pytest.mark.exhaustive("compiles the loops of five algorithms")]


@functools.cache
def document(scenario: str, runs: int, episodes: int, **overrides: Any) -> dict[str, Any]:
    return many_runs(recipe(scenario, **overrides), runs, Goal(episodes=episodes))


def holds(figure: dict[str, float], expected: float, readable: float = 0.0) -> bool:
    return abs(figure["mean"] - expected) <= 4 * figure["stderr"] + readable


def went_left(made: dict[str, Any], first: int, last: int) -> float:
    """Return the share of episodes ``first`` + 1 .. ``last`` of max-bias with two steps: they went left."""
    curve = made["curve"]
    shares = [
        length - 1.0
        for episode, length in zip(curve["episode"], curve["length_mean"], strict=True)
        if first < episode <= last
    ]
    return sum(shares) / len(shares)


# Example 6.6: cliff walking with α = 0.5, ε = 0.1 and γ = 1, 500 episodes


def test_sarsa_earns_more_on_a_longer_way() -> None:
    made = document("cliff", 200, 500, algorithm="sarsa")
    assert holds(made["summary"]["return_last_100"], -27, readable=1)
    found = [row["expected_return"] for row in made["runs"]]
    assert found.count(-17.0) > 0.7 * len(found)
    assert min(each for each in found if each is not None) >= -25.0
    # some of its greedy paths go back and forth for ever, and have no return
    assert 0 < found.count(None) < 0.25 * len(found)


def test_expected_sarsa_is_careful_without_trembling() -> None:
    # section 6.6: on the cliff Expected SARSA does well at α = 1, where SARSA cannot
    summary = document("cliff", 100, 500, algorithm="expected-sarsa", alpha=1.0)["summary"]
    sarsa = document("cliff", 200, 500, algorithm="sarsa")["summary"]
    assert summary["return_last_100"]["mean"] > sarsa["return_last_100"]["mean"] + 4
    assert (summary["expected_return"]["min"], summary["expected_return"]["max"]) == (-15.0, -15.0)


# Example 6.5: the windy gridworld with α = 0.5 and ε = 0.1


def test_sarsa_finds_nearly_the_best_way_through_the_wind() -> None:
    made = document("windy", 100, 500, algorithm="sarsa")
    found = [row["expected_return"] for row in made["runs"] if row["expected_return"] is not None]
    assert max(found) == -15.0
    assert sorted(found)[len(found) // 2] >= -16.0
    assert len(found) > 0.6 * len(made["runs"])


def test_kings_moves_halve_the_way_through_the_wind() -> None:
    made = document("windy-king", 100, 500, algorithm="sarsa")
    found = [row["expected_return"] for row in made["runs"] if row["expected_return"] is not None]
    assert max(found) == -7.0
    assert sorted(found)[len(found) // 2] >= -8.0


# Figure 8.2: the Dyna maze with γ = 0.95, α = 0.1 and ε = 0.1


def test_dyna_finds_the_way_of_14_steps() -> None:
    summary = document("maze", 30, 50, algorithm="dyna-q", planning_steps=50, epsilon=0.1)["summary"]
    assert summary["value_at_start"]["max"] == pytest.approx(0.95**13)
    assert summary["value_at_start"]["mean"] > 0.95**15
    assert summary["expected_return"]["min"] == pytest.approx(1.0)


# Figure 6.5: maximization bias with α = 0.1, ε = 0.1 and γ = 1, 300 episodes


def test_double_q_learning_goes_left_far_less_often() -> None:
    single = document("max-bias", 1000, 300, algorithm="q-learning")
    double = document("max-bias", 1000, 300, algorithm="double-q-learning")
    assert went_left(single, 0, 2) == pytest.approx(0.5, abs=0.1)  # before anything is learned
    assert went_left(single, 0, 100) > 0.6
    assert went_left(double, 0, 100) < 0.3
    # ε = 0.1 alone makes 5 %: the excess comes from the agents' estimates
    assert 0.05 < went_left(double, 280, 300) < 0.09
    assert went_left(double, 280, 300) < went_left(single, 280, 300) < 0.15
